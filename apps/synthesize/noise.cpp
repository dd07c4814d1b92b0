// SPDX-License-Identifier: BSD-3-Clause
#include "noise.h"

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

/** \brief floor(), which needs a function call in the baseline instruction set. */
int
integerPart(double x)
{
  const int i = static_cast<int>(x);
  return i - (x < i ? 1 : 0);
}

/** \brief Number in [-1, 1] of a lattice point with scattered coordinates. */
double
lattice(std::uint32_t h)
{
  h ^= h >> 15;
  h *= 0x2C1B3C6Du;
  h ^= h >> 12;
  h *= 0x297A2D39u;
  return static_cast<std::int32_t>(h ^ h >> 15) * (1.0 / 2147483648.0);
}

} // namespace

double
valueNoise(const Eigen::Vector3d& p, std::uint32_t seed)
{
  // Called about 10^9 times per sequence, so each coordinate is scattered only once.
  constexpr std::uint32_t kX = 0x9E3779B1u, kY = 0x85EBCA77u, kZ = 0xC2B2AE3Du;
  const int x = integerPart(p.x()), y = integerPart(p.y()), z = integerPart(p.z());
  const double fx = smoothStep(p.x() - x);
  const double fy = smoothStep(p.y() - y);
  const double fz = smoothStep(p.z() - z);
  const std::uint32_t base = x * kX + y * kY + z * kZ + seed * 0x27D4EB2Fu;
  const auto row = [fx](std::uint32_t h) {
    const double a = lattice(h);
    return a + fx * (lattice(h + kX) - a);
  };
  const double a = row(base);
  const double low = a + fy * (row(base + kY) - a);
  const double c = row(base + kZ);
  return low + fz * (c + fy * (row(base + kY + kZ) - c) - low);
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
  const double wavelength = std::ldexp(1.0, octave);   // next power of two
  const double fade = 2.0 * wanted / wavelength - 1.0; // 0: keep finest, 1: drop it
  return 0.45 * (1.0 - fade) * valueNoise(p * (2.0 / wavelength), seed + octave - 1) +
         0.5 * valueNoise(p / wavelength, seed + octave) +
         0.3 * valueNoise(p * (0.5 / wavelength), seed + octave + 1);
}

std::pair<double, double>
sinCos(double angle)
{
  const double square = angle * angle;
  double sine = angle, sine_term = angle;
  double cosine = 1.0, cosine_term = 1.0;
  for (int k = 1; k <= 16; ++k) {
    cosine_term *= -square / ((2 * k - 1) * (2 * k));
    sine_term *= -square / ((2 * k) * (2 * k + 1));
    cosine += cosine_term;
    sine += sine_term;
  }
  return {sine, cosine};
}

} // namespace pcl_semantic::synthetic
