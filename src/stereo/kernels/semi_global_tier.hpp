/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

// Included once a tier: PCL_SEMANTIC_TARGET is its instruction set, _LANES the bytes of
// a vector, _BITS the top bits of its bytes.

#define PCL_SEMANTIC_INLINE inline PCL_SEMANTIC_TARGET __attribute__((always_inline))
#define PCL_SEMANTIC_LAMBDA PCL_SEMANTIC_TARGET __attribute__((always_inline))

constexpr int lanes = PCL_SEMANTIC_LANES;
typedef std::uint8_t Bytes __attribute__((vector_size(lanes)));
typedef std::uint16_t Shorts __attribute__((vector_size(lanes)));

// Vectors anywhere in memory.
struct Unaligned {
  typedef Bytes B __attribute__((aligned(1), may_alias));
  typedef Shorts S __attribute__((aligned(2), may_alias));
};

PCL_SEMANTIC_INLINE Bytes
load(const std::uint8_t* from)
{
  return *reinterpret_cast<const Unaligned::B*>(from);
}

PCL_SEMANTIC_INLINE Shorts
load(const std::uint16_t* from)
{
  return *reinterpret_cast<const Unaligned::S*>(from);
}

PCL_SEMANTIC_INLINE void
store(const Bytes& values, std::uint8_t* to)
{
  *reinterpret_cast<Unaligned::B*>(to) = values;
}

PCL_SEMANTIC_INLINE void
store(const Shorts& values, std::uint16_t* to)
{
  *reinterpret_cast<Unaligned::S*>(to) = values;
}

template <typename Vector>
PCL_SEMANTIC_INLINE Vector
smaller(const Vector& a, const Vector& b)
{
  return a < b ? a : b;
}

PCL_SEMANTIC_INLINE std::uint16_t
leastOf(const EightWords& words)
{
#ifdef PCL_SEMANTIC_LEAST
  return PCL_SEMANTIC_LEAST(words);
#else
  std::uint16_t least = words[0];
  for (int k = 1; k < 8; ++k)
    least = words[k] < least ? words[k] : least;
  return least;
#endif
}

// The smallest of all lanes.
PCL_SEMANTIC_INLINE std::uint8_t
least(const Bytes& values)
{
  typedef std::uint8_t Half __attribute__((vector_size(16)));
  Half part[lanes / 16];
  __builtin_memcpy(part, &values, sizeof(values));
  for (int i = 1; i < lanes / 16; ++i)
    part[0] = part[0] < part[i] ? part[0] : part[i];
  const Half high = (Half)((EightWords)part[0] >> 8);
  const EightWords words = (EightWords)(part[0] < high ? part[0] : high) & 255;
  return std::uint8_t(leastOf(words));
}

// Set bits of each byte.
PCL_SEMANTIC_INLINE Bytes
countBits(const Bytes& bits)
{
#ifdef PCL_SEMANTIC_LOOK_UP
  const Bytes table = load(bit_counts);
  return PCL_SEMANTIC_LOOK_UP(table, bits & 15) +
         PCL_SEMANTIC_LOOK_UP(table, (Bytes)((Shorts)bits >> 4) & 15);
#else
  const Bytes pairs = bits - ((Bytes)((Shorts)bits >> 1) & 0x55);
  const Bytes fours = (pairs & 0x33) + ((Bytes)((Shorts)pairs >> 2) & 0x33);
  return (fours + ((Bytes)((Shorts)fours >> 4) & 15)) & 15;
#endif
}

PCL_SEMANTIC_TARGET void
compareRow(const CensusRow& row, std::uint8_t* costs)
{
  for (int u = 0; u < row.width; ++u, costs += row.disparities) {
    const std::size_t first = std::size_t(row.width - 1 - u);
    for (int d = 0; d < row.disparities; d += lanes) {
      Bytes cost{};
      for (int b = 0; b < census_bytes; ++b)
        cost += countBits(load(row.right[b] + first + std::size_t(d)) ^ row.left[b][u]);
      store(cost, costs + d);
    }
  }
}

// Rounded to whole quarters, or sixteenths of sixteen.
PCL_SEMANTIC_INLINE Bytes
quarter(const Bytes& values)
{
  return (Bytes)((Shorts)(values + 2) >> 2) & 63;
}

PCL_SEMANTIC_TARGET void
slideRows(const std::uint8_t* added, const std::uint8_t* removed, std::size_t count,
          std::uint8_t* sums, std::uint8_t* quarters)
{
  for (std::size_t i = 0; i < count; i += lanes) {
    Bytes sum = load(sums + i) + load(added + i);
    if (removed)
      sum -= load(removed + i);
    store(sum, sums + i);
    store(quarter(sum), quarters + i);
  }
}

PCL_SEMANTIC_TARGET void
sumBlocks(const std::uint8_t* quarters, int width, int disparities, std::uint8_t* costs)
{
  for (int u = 0; u < width; ++u, costs += disparities) {
    const std::uint8_t* columns[5];
    for (int k = 0; k < 5; ++k) {
      const int at = u + k - 2;
      columns[k] = quarters + (at < 0 ? 0 : at < width ? at : width - 1) * disparities;
    }
    for (int d = 0; d < disparities; d += lanes) {
      Bytes sum = load(columns[0] + d);
      for (int k = 1; k < 5; ++k)
        sum += load(columns[k] + d);
      store(quarter(sum), costs + d);
    }
  }
}

// One step of a path: replaces the path costs of the pixel before, and the smallest of
// them, by those of the next. Calls use(d, costs) for each vector.
template <typename Use>
PCL_SEMANTIC_INLINE void
step(const std::uint8_t* costs, int disparities, std::uint8_t small_step,
     std::uint8_t large_step, std::uint8_t* slot, std::uint8_t& smallest, Use&& use)
{
  const std::uint8_t before = smallest;
  const std::uint8_t jump = std::uint8_t(before + large_step);
  Bytes minimum = Bytes{} + std::uint8_t(255);
  Bytes below = load(slot - 1);
  for (int d = 0; d < disparities; d += lanes) {
    const Bytes same = load(slot + d);
    const Bytes stepped = smaller(below, load(slot + d + 1)) + small_step;
    below = load(slot + d + lanes - 1); // before this vector is replaced
    const Bytes best = smaller(smaller(same, stepped), Bytes{} + jump);
    const Bytes path = best - before + load(costs + d);
    store(path, slot + d);
    minimum = smaller(minimum, path);
    use(d, path);
  }
  smallest = least(minimum);
}

// A path that begins: its costs are those of the first pixel.
PCL_SEMANTIC_INLINE std::uint8_t
beginPath(std::uint8_t* slot, int disparities)
{
  for (int d = 0; d < disparities; d += lanes)
    store(Bytes{}, slot + d);
  return 0;
}

PCL_SEMANTIC_TARGET void
forwardRow(const PathRow& row)
{
  const int D = row.disparities;
  const std::uint8_t* costs = row.costs;
  std::uint8_t* slot = row.down;
  std::uint8_t smallest_along = beginPath(row.along, D);
  for (int u = 0; u < row.width; ++u, costs += D, slot += D + slot_padding) {
    std::uint16_t* const even = row.sums + std::size_t(u) * std::size_t(D);
    std::uint16_t* const odd = even + D / 2;
    step(costs, D, row.small_step, row.large_step_along[u], row.along, smallest_along,
         [&](int d, const Bytes& path) PCL_SEMANTIC_LAMBDA {
           store((Shorts)path & 255, even + d / 2);
           store((Shorts)path >> 8, odd + d / 2);
         });
    step(costs, D, row.small_step, row.large_step_down[u], slot, row.smallest_down[u],
         [&](int d, const Bytes& path) PCL_SEMANTIC_LAMBDA {
           store(load(even + d / 2) + ((Shorts)path & 255), even + d / 2);
           store(load(odd + d / 2) + ((Shorts)path >> 8), odd + d / 2);
         });
  }
}

PCL_SEMANTIC_INLINE std::uint16_t
least(const Shorts& values)
{
  EightWords part[lanes / 16];
  __builtin_memcpy(part, &values, sizeof(values));
  for (int i = 1; i < lanes / 16; ++i)
    part[0] = part[0] < part[i] ? part[0] : part[i];
  return leastOf(part[0]);
}

// The place of the first of some sums that is a value; \a size if none is.
PCL_SEMANTIC_INLINE int
firstOf(const std::uint16_t* sums, int size, std::uint16_t value)
{
  for (int i = 0; i < size; i += lanes / 2) {
    const auto bits = PCL_SEMANTIC_BITS((Bytes)(load(sums + i) == value));
    if (bits != 0)
      return i + __builtin_ctzll(bits) / 2;
  }
  return size;
}

// How many of some sums are at most a value.
PCL_SEMANTIC_INLINE int
countUpTo(const std::uint16_t* sums, int size, std::uint16_t value)
{
  int found = 0;
  for (int i = 0; i < size; i += lanes / 2)
    found += __builtin_popcountll(PCL_SEMANTIC_BITS((Bytes)(load(sums + i) <= value)));
  return found / 2;
}

// Brings the sums of a pixel to the pixels of the right image.
PCL_SEMANTIC_INLINE void
chooseForRight(const std::uint16_t* sums, int size, int first_disparity,
               std::uint16_t* right_sum, std::uint16_t* right_disparity)
{
  Shorts disparity{};
  for (int k = 0; k < lanes / 2; ++k)
    disparity[k] = std::uint16_t(first_disparity + 2 * k);
  for (int i = 0; i < size; i += lanes / 2) {
    const Shorts ours = load(sums + i), theirs = load(right_sum + i);
    store(smaller(ours, theirs), right_sum + i);
    store(ours < theirs ? disparity : load(right_disparity + i), right_disparity + i);
    disparity += std::uint16_t(lanes);
  }
}

// The best disparity of a pixel from its sums, the smallest of which is known.
PCL_SEMANTIC_INLINE void
choose(const std::uint16_t* sums, int D, std::uint16_t smallest, int u,
       const RowMatches& matches)
{
  const std::uint16_t *const even = sums, *const odd = sums + D / 2;
  const int e = 2 * firstOf(even, D / 2, smallest);
  const int o = 2 * firstOf(odd, D / 2, smallest) + 1;
  const int d = e < o ? e : o;
  const auto sumAt = [&](int at) {
    return at < 0 || at >= D ? no_sum : sums[at % 2 * (D / 2) + at / 2];
  };
  std::uint16_t* const around = matches.around + 3 * u;
  for (int k = 0; k < 3; ++k)
    around[k] = sumAt(d + k - 1);
  const auto limit = std::uint16_t(float(smallest) * matches.uniqueness);
  const int own = (around[0] <= limit) + 1 + (around[2] <= limit);
  matches.has_rival[u] =
      countUpTo(even, D / 2, limit) + countUpTo(odd, D / 2, limit) > own;
  matches.disparity[u] = std::uint8_t(d);
}

PCL_SEMANTIC_TARGET void
backwardRow(const PathRow& row, const RowMatches& matches)
{
  const int D = row.disparities;
  std::uint8_t smallest_along = beginPath(row.along, D);
  for (int u = row.width - 1; u >= 0; --u) {
    const std::size_t first = std::size_t(u) * std::size_t(D);
    std::uint16_t* const even = row.sums + first;
    std::uint16_t* const odd = even + D / 2;
    Shorts smallest = Shorts{} + no_sum;
    step(row.costs + first, D, row.small_step, row.large_step_along[u + 1], row.along,
         smallest_along, [&](int d, const Bytes& path) PCL_SEMANTIC_LAMBDA {
           const Shorts a = load(even + d / 2) + ((Shorts)path & 255);
           const Shorts b = load(odd + d / 2) + ((Shorts)path >> 8);
           store(a, even + d / 2);
           store(b, odd + d / 2);
           smallest = smaller(smallest, smaller(a, b));
         });
    choose(even, D, least(smallest), u, matches);
    // Disparity d leads to place + d.
    const int place = row.width - 1 - u;
    chooseForRight(even, D / 2, 0, matches.right_sum[place % 2] + place / 2,
                   matches.right_disparity[place % 2] + place / 2);
    chooseForRight(odd, D / 2, 1, matches.right_sum[1 - place % 2] + (place + 1) / 2,
                   matches.right_disparity[1 - place % 2] + (place + 1) / 2);
  }
}
