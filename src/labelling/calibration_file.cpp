// SPDX-License-Identifier: BSD-3-Clause
#include "calibration_term.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/files/yaml_config.h>
#include <pcl_semantic/labelling/label_calibration.h>

#include <limits>
#include <sstream>

namespace pcl_semantic {

namespace {

Label
labelOf(const YamlMap& map, const std::string& key, const std::string& name,
        const LabelSet& label_set)
{
  const Label label = label_set.find(name);
  if (label == kUnlabelled)
    PCL_THROW_EXCEPTION(BadInputException, map.where(key)
                                               << ": class '" << name
                                               << "' is not in the label set");
  return label;
}

void
readClass(const YamlMap& entry, Label label, LabelCalibration& calibration)
{
  double bias = 0.0;
  entry.get("bias", bias);
  calibration.bias[label - 1] = static_cast<float>(bias);
  calibration.fitted[label - 1u] = true;
  for (ClassCurves& curves : calibration.curves) {
    const char* const name = nameOf(curves.feature);
    std::vector<double> values;
    if (!entry.get(name, values))
      continue;
    if (values.size() != curves.knots.size())
      PCL_THROW_EXCEPTION(BadInputException, entry.where(name)
                                                 << ": " << name << " has "
                                                 << values.size() << " values for "
                                                 << curves.knots.size() << " knots");
    for (std::size_t i = 0; i < values.size(); ++i)
      curves.values(label - 1, Eigen::Index(i)) = static_cast<float>(values[i]);
  }
  entry.refuseUnknownKeys();
}

// Curves of zero at the knots of each feature.
std::vector<ClassCurves>
readKnots(const YamlMap& knots, int classes)
{
  std::vector<ClassCurves> curves;
  for (std::size_t f = 0; f < feature_count; ++f) {
    std::vector<double> values;
    if (!knots.get(feature_names[f], values))
      continue;
    curves.push_back({Feature(f),
                      {values.begin(), values.end()},
                      Eigen::MatrixXf::Zero(classes, Eigen::Index(values.size()))});
    if (!areKnots(curves.back().knots))
      PCL_THROW_EXCEPTION(BadInputException, knots.where(feature_names[f])
                                                 << ": expected two or more rising "
                                                    "knots");
  }
  knots.refuseUnknownKeys();
  return curves;
}

std::string
listOf(const float* values, std::size_t count, std::ptrdiff_t stride)
{
  std::ostringstream text;
  text.precision(std::numeric_limits<float>::max_digits10);
  for (std::size_t i = 0; i < count; ++i)
    text << (i ? ", " : "[") << values[std::ptrdiff_t(i) * stride];
  text << "]";
  return text.str();
}

} // namespace

LabelCalibration
readCalibration(const std::string& path, const LabelSet& label_set,
                const std::string& of)
{
  const YamlMap file = YamlMap::load(path);
  LabelCalibration calibration = LabelCalibration::identity(label_set.size());
  calibration.fitted.assign(calibration.fitted.size(), false);
  if (file.get("of", calibration.of) && calibration.of != of)
    PCL_THROW_EXCEPTION(BadInputException, file.where("of") << ": is a calibration of '"
                                                            << calibration.of
                                                            << "', expected of " << of);
  calibration.sharpness = static_cast<float>(file.require<double>("sharpness"));
  if (!(calibration.sharpness >= 0.0f))
    PCL_THROW_EXCEPTION(BadInputException, file.where("sharpness")
                                               << ": sharpness is "
                                               << calibration.sharpness
                                               << ", expected 0 or more");
  for (const std::string& name : file.require<std::vector<std::string>>("ground"))
    calibration.ground.push_back(labelOf(file, "ground", name, label_set));
  calibration.curves = readKnots(file.requireMap("knots"), label_set.size());
  const YamlMap classes = file.requireMap("classes");
  for (const std::string& name : classes.keys())
    readClass(classes.requireMap(name), labelOf(classes, name, name, label_set),
              calibration);
  file.refuseUnknownKeys();
  try {
    calibration.validate();
  }
  catch (const InvalidParameterException& error) {
    PCL_THROW_EXCEPTION(BadInputException, path << ": " << error.what());
  }
  return calibration;
}

std::string
printCalibration(const LabelCalibration& calibration, const LabelSet& label_set)
{
  std::ostringstream text;
  text.precision(std::numeric_limits<float>::max_digits10);
  if (!calibration.of.empty())
    text << "of: " << calibration.of << "\n";
  text << "sharpness: " << calibration.sharpness << "\nground: [";
  for (std::size_t i = 0; i < calibration.ground.size(); ++i)
    text << (i ? ", " : "") << label_set[calibration.ground[i]].name;
  text << "]\nknots:" << (calibration.curves.empty() ? " {}\n" : "\n");
  for (const ClassCurves& curves : calibration.curves)
    text << "  " << nameOf(curves.feature) << ": "
         << listOf(curves.knots.data(), curves.knots.size(), 1) << "\n";
  text << "classes:\n";
  for (int l = 0; l < calibration.classes(); ++l) {
    if (!calibration.fitted[std::size_t(l)])
      continue;
    text << "  " << label_set[Label(l + 1)].name
         << ":\n    bias: " << calibration.bias[l] << "\n";
    for (const ClassCurves& curves : calibration.curves)
      text << "    " << nameOf(curves.feature) << ": "
           << listOf(curves.values.data() + l, curves.knots.size(),
                     calibration.classes())
           << "\n";
  }
  return text.str();
}

} // namespace pcl_semantic
