// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/evaluation/geometry_report.h>

#include <nlohmann/json.hpp>

#include <cmath>
#include <cstdio>

namespace pcl_semantic {

namespace {

// A number with so many decimals; "-" if there is none.
std::string
rounded(double value, int decimals)
{
  if (!std::isfinite(value))
    return "-";
  char text[32];
  std::snprintf(text, sizeof(text), "%.*f", decimals, value);
  return text;
}

std::string
shortest(double value)
{
  char text[32];
  std::snprintf(text, sizeof(text), "%g", value);
  return text;
}

std::string
bandName(const GeometryParameters& parameters, std::size_t band)
{
  return shortest(parameters.bands[band]) + "-" + shortest(parameters.bands[band + 1]) +
         " m";
}

double
share(std::uint64_t part, std::uint64_t whole)
{
  return double(part) / double(whole); // 0 / 0 is NaN
}

} // namespace

std::string
geometryTable(const GeometrySamples& samples, const GeometryParameters& parameters)
{
  const GeometryScores scores = scoreGeometry(samples);
  std::string text = "voxels " + std::to_string(scores.voxels) + ", judged " +
                     std::to_string(scores.judged) +
                     "\n\nfrom a voxel to the nearest return\n  mean      " +
                     rounded(scores.mean, 3) + " m\n  median    " +
                     rounded(scores.median, 3) + " m\n  90 %      " +
                     rounded(scores.percentile_90, 3) + " m\n";
  for (std::size_t i = 0; i < scores.shares.size(); ++i)
    text += "  to " + rounded(GeometryScores::limits[i], 1) + " m  " +
            rounded(100.0 * scores.shares[i], 1) + " %\n";
  text += "\nreturns in a voxel / next to one / within " + shortest(parameters.within) +
          " m of one\n";
  for (std::size_t i = 0; i < samples.surface.size(); ++i) {
    const SurfaceCounts& band = samples.surface[i];
    text += "  " + bandName(parameters, i) + ": " +
            rounded(100.0 * share(band.at, band.points), 1) + " / " +
            rounded(100.0 * share(band.adjacent, band.points), 1) + " / " +
            rounded(100.0 * share(band.within, band.points), 1) + " % of " +
            std::to_string(band.points) + "\n";
  }
  return text;
}

std::string
geometryMarkdownHeader(const GeometryParameters& parameters)
{
  std::string titles = "| | mean cm | median cm | 90 % cm |",
              rule = "|---|---:|---:|---:|";
  for (const double limit : GeometryScores::limits) {
    titles += " to " + rounded(100.0 * limit, 0) + " cm % |";
    rule += "---:|";
  }
  for (std::size_t i = 0; i + 1 < parameters.bands.size(); ++i) {
    titles += " mapped " + bandName(parameters, i) + " % |";
    rule += "---:|";
  }
  return titles + "\n" + rule + "\n";
}

std::string
geometryMarkdownRow(const GeometrySamples& samples,
                    const GeometryParameters& parameters, const std::string& name)
{
  const GeometryScores scores = scoreGeometry(samples);
  std::string text = "| " + name + " |";
  for (const double distance : {scores.mean, scores.median, scores.percentile_90})
    text += " " + rounded(100.0 * distance, 1) + " |";
  for (const double part : scores.shares)
    text += " " + rounded(100.0 * part, 1) + " |";
  for (std::size_t i = 0; i + 1 < parameters.bands.size(); ++i) {
    const SurfaceCounts band =
        i < samples.surface.size() ? samples.surface[i] : SurfaceCounts();
    text += " " + rounded(100.0 * share(band.at, band.points), 1) + " / " +
            rounded(100.0 * share(band.adjacent, band.points), 1) + " / " +
            rounded(100.0 * share(band.within, band.points), 1) + " |";
  }
  return text + "\n";
}

std::string
geometryJson(const GeometrySamples& samples, const GeometryParameters& parameters)
{
  const GeometryScores scores = scoreGeometry(samples);
  nlohmann::ordered_json json; // NaN becomes null
  json["voxels"] = scores.voxels;
  json["judged"] = scores.judged;
  json["distance"] = {
      {"mean", scores.mean}, {"median", scores.median}, {"90 %", scores.percentile_90}};
  for (std::size_t i = 0; i < scores.shares.size(); ++i)
    json["within"][rounded(GeometryScores::limits[i], 1)] = scores.shares[i];
  json["surface"] = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < samples.surface.size(); ++i) {
    const SurfaceCounts& band = samples.surface[i];
    json["surface"].push_back({{"from", parameters.bands[i]},
                               {"to", parameters.bands[i + 1]},
                               {"points", band.points},
                               {"in_voxel", share(band.at, band.points)},
                               {"next_to_voxel", share(band.adjacent, band.points)},
                               {"within", share(band.within, band.points)}});
  }
  return json.dump(2) + "\n";
}

} // namespace pcl_semantic
