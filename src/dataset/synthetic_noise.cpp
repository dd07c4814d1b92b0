/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include "synthetic_noise.h"

#include <algorithm>
#include <cmath>

namespace pcl_semantic::synthetic {

std::uint32_t
hash(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d)
{
  std::uint64_t h = (std::uint64_t(a) << 32 | b) * 0x9E3779B97F4A7C15ull;
  h ^= h >> 29;
  h += (std::uint64_t(c) << 32 | d) * 0xD6E8FEB86659FD93ull;
  h ^= h >> 32;
  h *= 0xBF58476D1CE4E5B9ull;
  h ^= h >> 31;
  return static_cast<std::uint32_t>(h * 0x94D049BB133111EBull >> 32);
}

namespace {

double
smoothStep(double x)
{
  return x * x * (3.0 - 2.0 * x);
}

double
lattice(int x, int y, int z, std::uint32_t seed)
{
  return hash(x, y, z, seed) * (2.0 / 4294967295.0) - 1.0;
}

double
latticeRow(int x, int y, int z, double fx, std::uint32_t seed)
{
  const double a = lattice(x, y, z, seed);
  return a + fx * (lattice(x + 1, y, z, seed) - a);
}

} // namespace

double
valueNoise(const Eigen::Vector3d& p, std::uint32_t seed)
{
  const int x = static_cast<int>(std::floor(p.x()));
  const int y = static_cast<int>(std::floor(p.y()));
  const int z = static_cast<int>(std::floor(p.z()));
  const double fx = smoothStep(p.x() - x);
  const double fy = smoothStep(p.y() - y);
  const double fz = smoothStep(p.z() - z);
  const double a = latticeRow(x, y, z, fx, seed);
  const double b = latticeRow(x, y + 1, z, fx, seed);
  const double c = latticeRow(x, y, z + 1, fx, seed);
  const double d = latticeRow(x, y + 1, z + 1, fx, seed);
  const double low = a + fy * (b - a);
  return low + fz * (c + fy * (d - c) - low);
}

double
fractalNoise(const Eigen::Vector3d& p, double wavelength, std::uint32_t seed)
{
  return 0.65 * valueNoise(p / wavelength, seed) +
         0.35 * valueNoise(p / (0.43 * wavelength), seed + 1);
}

double
detailNoise(const Eigen::Vector3d& p, double footprint, std::uint32_t seed)
{
  const double wanted = std::max(3.0 * footprint, 0.01);
  int octave = 0;
  std::frexp(wanted, &octave);
  const double wavelength = std::ldexp(1.0, octave);   // the power of two above wanted
  const double fade = 2.0 * wanted / wavelength - 1.0; // 0: fine is resolved, 1: gone
  return 0.45 * (1.0 - fade) * valueNoise(p * (2.0 / wavelength), seed + octave - 1) +
         0.5 * valueNoise(p / wavelength, seed + octave) +
         0.3 * valueNoise(p * (0.5 / wavelength), seed + octave + 1);
}

void
sinCos(double angle, double& sine, double& cosine)
{
  const double square = angle * angle;
  double sine_term = angle;
  double cosine_term = 1.0;
  sine = angle;
  cosine = 1.0;
  for (int k = 1; k <= 16; ++k) {
    cosine_term *= -square / ((2 * k - 1) * (2 * k));
    sine_term *= -square / ((2 * k) * (2 * k + 1));
    cosine += cosine_term;
    sine += sine_term;
  }
}

} // namespace pcl_semantic::synthetic
