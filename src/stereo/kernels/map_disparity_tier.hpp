/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

// Included once a tier, after distances_tier.hpp.

struct Best {
  int energy, disparity;
};

/** \brief Eight disparities from first on, in the order of the other image's pixels. */
struct Eight {
  int first;
  Shorts energies; ///< of the prior
};

PCL_SEMANTIC_INLINE int
disparityOf(int direction, int first, int m)
{
  return direction < 0 ? first + 7 - m : first + m;
}

/** \brief Takes the least of the energies, of disparities from 0 to \a limit - 1. */
PCL_SEMANTIC_INLINE void
takeLeast(Shorts energies, int first, int direction, int limit, Best& best)
{
  if (first < 0 || first + 8 > limit)
    for (int m = 0; m < 8; ++m) {
      const int d = disparityOf(direction, first, m);
      if (d < 0 || d >= limit)
        energies[m] = no_energy;
    }
#ifdef PCL_SEMANTIC_LEAST
  const Shorts least = PCL_SEMANTIC_LEAST(energies);
  const int energy = least[0], m = least[1];
#else
  int energy = energies[0], m = 0;
  for (int i = 1; i < 8; ++i)
    if (energies[i] < energy) {
      energy = energies[i];
      m = i;
    }
#endif
  if (energy < best.energy)
    best = {energy, disparityOf(direction, first, m)};
}

PCL_SEMANTIC_INLINE void
tryEight(const Bytes* mine, const MatchRow& row, int direction, int u, int limit,
         const Eight& eight, Best& best)
{
  const int at = direction < 0 ? u - eight.first - 7 : u + eight.first;
  takeLeast(eightDistances(mine, row.other + at * descriptor_bytes) + eight.energies,
            eight.first, direction, limit, best);
}

/** \brief Disparity with its fraction, from the distances there and at its neighbours:
 * two lines of equal and opposite slope, which distances (L1) follow. */
PCL_SEMANTIC_INLINE std::int16_t
refine(const MatchRow& row, const Bytes* mine, int direction, int u, int d)
{
  const std::uint8_t* const at = row.other + (u + direction * d) * descriptor_bytes;
  const Ints less = halfDistances(mine, at - direction * descriptor_bytes);
  const Ints here = halfDistances(mine, at);
  const Ints more = halfDistances(mine, at + direction * descriptor_bytes);
  const int e0 = less[0] + less[2], e1 = here[0] + here[2], e2 = more[0] + more[2];
  const int rise = (e0 > e2 ? e0 : e2) - e1;
  int fraction = 0;
  if (rise > 0) {
    const int twice = disparity_steps * (e0 - e2); // over 2 rise: the fraction
    fraction = (twice + (twice < 0 ? -rise : rise)) / (2 * rise);
    const int half = disparity_steps / 2;
    fraction = fraction < -half ? -half : fraction > half ? half : fraction;
  }
  const int disparity = d * disparity_steps + fraction;
  return std::int16_t(disparity < 0 ? 0 : disparity);
}

PCL_SEMANTIC_INLINE void
mapDisparityBody(const MatchRow& row, int direction, std::int16_t* disparity)
{
  const int blocks = row.disparities / 8;
  const std::uint8_t* bytes = row.seen;
  Eight seen[largest_disparities / 8];
  for (int begin = 0; begin < row.width; begin += row.cell_size, bytes += blocks) {
    int count = 0;
    for (int block = 0; block < blocks; ++block) {
      if (bytes[block] == 0)
        continue;
      seen[count].first = 8 * block;
      for (int m = 0; m < 8; ++m)
        seen[count].energies[m] =
            bytes[block] >> disparityOf(direction, 0, m) & 1 ? row.floor : no_energy;
      ++count;
    }
    const int end =
        begin + row.cell_size < row.width ? begin + row.cell_size : row.width;
    for (int u = begin; u < end; ++u) {
      Bytes mine[descriptor_parts];
      __builtin_memcpy(mine, row.own + u * descriptor_bytes, sizeof mine);
      const int reach = direction < 0 ? u + 1 : row.width - u;
      const int limit = reach < row.disparities ? reach : row.disparities;
      Best best = {no_energy, -1};
      const int expected = row.plane[u];
      Eight near = {expected / disparity_steps - 3, {}};
      if (expected >= 0 && near.first < limit) {
        __builtin_memcpy(&near.energies, row.prior + expected % disparity_steps * 8,
                         sizeof near.energies);
        tryEight(mine, row, direction, u, limit, near, best);
      }
      for (int i = 0; i < count && seen[i].first < limit; ++i)
        tryEight(mine, row, direction, u, limit, seen[i], best);
      disparity[u] = best.disparity < 0
                         ? no_disparity
                         : refine(row, mine, direction, u, best.disparity);
    }
  }
}

PCL_SEMANTIC_TARGET void
mapDisparityRow(const MatchRow& row, std::int16_t* disparity)
{
  if (row.direction < 0)
    mapDisparityBody(row, -1, disparity);
  else
    mapDisparityBody(row, 1, disparity);
}
