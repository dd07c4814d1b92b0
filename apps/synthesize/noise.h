// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include <cstdint>
#include <utility>

namespace pcl_semantic::synthetic {

/** \brief Hashes four numbers to 32 well distributed bits; the same on every
 * machine. */
std::uint32_t hash(std::uint32_t a, std::uint32_t b = 0, std::uint32_t c = 0,
                   std::uint32_t d = 0);

/** \brief hash() as a number in [0, 1). */
inline double
uniform(std::uint32_t a, std::uint32_t b = 0, std::uint32_t c = 0, std::uint32_t d = 0)
{
  return hash(a, b, c, d) * (1.0 / 4294967296.0);
}

/** \brief Smooth noise of unit wavelength in [-1, 1], interpolated between hashes of
 * the integer lattice. */
double valueNoise(const Eigen::Vector3d& p, std::uint32_t seed);

/** \brief Sum of two octaves of valueNoise(); \a wavelength of the coarser one [m]. */
double fractalNoise(const Eigen::Vector3d& p, double wavelength, std::uint32_t seed);

/** \brief Noise with a finest wavelength of about three pixels at any distance.
 *
 * Real surfaces have structure at every scale, which stereo matching needs. A fixed
 * wavelength would be flat nearby and alias far away.
 * \param[in] footprint width of a pixel on the surface [m] */
double detailNoise(const Eigen::Vector3d& p, double footprint, std::uint32_t seed);

/** \brief Sine and cosine of an angle in [-4, 4] by power series, because results of
 * the C library differ in the last bit between machines. */
std::pair<double, double> sinCos(double angle);

/** \brief A named sequence of random numbers, so that a new object of one kind does not
 * move the others. */
class Random {
public:
  Random(std::uint32_t seed, std::uint32_t name) : key_(hash(seed, name, 0x5eed)) {}

  std::uint32_t
  bits()
  {
    return hash(key_, ++count_);
  }

  double
  uniform(double low, double high)
  {
    return low + (high - low) * (bits() * (1.0 / 4294967296.0));
  }

  bool
  chance(double probability)
  {
    return uniform(0.0, 1.0) < probability;
  }

private:
  std::uint32_t key_;
  std::uint32_t count_ = 0;
};

} // namespace pcl_semantic::synthetic
