// SPDX-License-Identifier: BSD-3-Clause
#include "arrays.h"
#include "core/fail.h"

#include <pcl_semantic/core/no_return.h>
#include <pcl_semantic/filters/cloud_crf.h>
#include <pcl_semantic/filters/crf_config.h>
#include <pcl_semantic/superpixels/clique_config.h>
#include <pcl_semantic/things/object_extraction.h>
#include <pcl_semantic/things/plane_summary.h>

#include <pcl/common/io.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <utility>

namespace pcl_semantic::python {

namespace {

// Groups points by number; 0 = none.
std::vector<pcl::PointIndices>
cliquesOf(const Array<std::int64_t>& numbers, py::ssize_t points)
{
  requireShape(numbers, "cliques", points);
  std::map<std::int64_t, pcl::PointIndices> cliques;
  for (py::ssize_t i = 0; i < points; ++i)
    if (numbers.at(i) < 0)
      badParameter("cliques hold ", numbers.at(i), " at point ", i,
                   ", expected 0 or more, 0 = none; if -1 means none, add 1");
    else if (numbers.at(i) != 0)
      cliques[numbers.at(i)].indices.push_back(pcl::index_t(i));
  std::vector<pcl::PointIndices> result;
  for (auto& [number, members] : cliques)
    result.push_back(std::move(members));
  return result;
}

void
warnOfNoReturns(std::size_t count)
{
  if (count > 0)
    warn(std::to_string(count) +
         " points at exactly 0 0 0 count as no return and are ignored");
}

CliqueGenerator::Ptr
generatorOf(const std::string& kind)
{
  if (!namesCloudCliques(kind) || namesCliques(kind, "slic"))
    badParameter("cliques: '", kind,
                 "', expected planes[:EDGE], supervoxel[:DISTANCE] or cubes[:EDGE]");
  return makeCliqueGenerator(kind);
}

// Calls write(i, label) for each point. \return the largest label, at least 1
template <typename Write>
int
readLabels(const py::object& given, std::size_t points, int classes, Write&& write)
{
  const auto labels = integersOf<std::int64_t>(given, "labels");
  requireShape(labels, "labels", py::ssize_t(points));
  int largest = 1;
  for (std::size_t i = 0; i < points; ++i) {
    const Label label = labelOf(labels.data()[i], "labels", i);
    write(i, label);
    largest = std::max(largest, int(label));
  }
  if (largest == 255 && classes == 0)
    warn("labels hold 255, which counts as a class; if it means none, give 0");
  return largest;
}

void
setLabels(const py::object& given, pcl::PointCloud<pcl::PointXYZRGBL>& cloud)
{
  readLabels(given, cloud.size(), 0,
             [&](std::size_t i, Label label) { cloud[i].label = label; });
}

// Without points: the CRF of fields that were filled here.
class FieldsCRF : public CloudCRF {};

// KeyboardInterrupt and other signals of Python.
void
checkSignals()
{
  const py::gil_scoped_acquire gil;
  if (PyErr_CheckSignals() != 0)
    throw py::error_already_set();
}

std::vector<Label>
thinLabelsOf(const py::object& numbers)
{
  const auto labels = integersOf<std::int64_t>(numbers, "thin labels");
  requireShape(labels, "thin labels", kAny);
  std::vector<Label> thin;
  for (py::ssize_t i = 0; i < labels.size(); ++i) {
    if (labels.data()[i] < 1 || labels.data()[i] > 255)
      badParameter("thin labels hold ", labels.data()[i], ", expected 1 to 255");
    thin.push_back(Label(labels.data()[i]));
  }
  return thin;
}

// Refuses arguments without effect, and requires missing ones.
void
requireFitting(CRFConfig& config, const py::kwargs& given, bool has_probabilities,
               bool has_cliques, bool has_thin)
{
  const ConfigParameters parameters = parametersOf(config);
  const std::string model = parameters.front().text(); // "crf"
  const std::string with = "with crf='" + model + "'";
  const bool needs_cliques = config.model == CRFModelType::pn_potts ||
                             config.model == CRFModelType::hierarchical;
  if (needs_cliques && !has_cliques)
    badParameter("crf='", model, "' needs cliques: N numbers, or 'planes'");
  if (has_cliques && !needs_cliques)
    badParameter("cliques has no effect ", with);
  if (has_thin && config.model == CRFModelType::unary)
    badParameter("thin has no effect ", with);
  refuseUnreadOfCRF(given, model, has_cliques ? "given" : "none");
  if (!has_thin)
    refuseUnread(given, {"crf_keep_thin"}, "without thin=");
  if (has_probabilities)
    refuseUnread(given, {"label_confidence"}, "beside probabilities");
}

py::tuple
refine(const py::object& points, const py::object& probabilities,
       const py::object& given_labels, const py::object& given_colours,
       const py::object& cliques, int classes, const py::object& given_thin,
       const py::kwargs& parameters)
{
  const bool has_probabilities = !probabilities.is_none();
  if (has_probabilities && classes != 0)
    badParameter(
        "classes has no effect beside probabilities, which have a column each");
  if (classes < 0 || classes > 255)
    badParameter("classes is ", classes,
                 ", expected 1 to 255, or 0 = the largest label");
  const std::vector<Label> thin = thinLabelsOf(given_thin);
  const bool has_colours = !given_colours.is_none();
  if (has_probabilities != given_labels.is_none())
    badParameter("expected probabilities or labels, one of them");
  CloudFields fields =
      cloudFieldsOf(points, maybeIntegersOf<std::uint8_t>(given_colours, "colours"));
  const std::size_t count = fields.labels.size();
  checkSignals();
  CRFConfig config;
  setParameters(parametersOf(config), parameters);
  config.validate();
  requireFitting(config, parameters, has_probabilities, !cliques.is_none(),
                 !thin.empty());
  FieldsCRF crf;
  crf.setModel(config.model);
  crf.setParameters(config.parameters);
  crf.setThinLabels(thin);
  crf.setUseColour(has_colours);
  crf.setNumberOfThreads(config.threads);
  crf.setInterruptionCheck(&checkSignals);
  if (has_probabilities) {
    LabelDistributions distributions =
        distributionsOf(probabilities, py::ssize_t(count));
    if (distributions.classes() == 0) // without points
      return py::make_tuple(py::array_t<std::uint8_t>(0),
                            arrayOf(std::move(distributions)));
    crf.giveLabelDistributions(std::move(distributions));
  }
  else {
    const int largest =
        readLabels(given_labels, count, classes,
                   [&](std::size_t i, Label label) { fields.labels[i] = label; });
    crf.setLabelConfidence(config.label_confidence, classes > 0 ? classes : largest);
  }
  if (py::isinstance<py::str>(cliques))
    crf.setCliqueGenerator(generatorOf(cliques.cast<std::string>()));
  else if (!cliques.is_none())
    crf.setCliques(
        cliquesOf(integersOf<std::int64_t>(cliques, "cliques"), py::ssize_t(count)));
  warnOfNoReturns(countNoReturns(count, [&](std::size_t i) {
    return fields.positions.col(Eigen::Index(i)).isZero(0.0f);
  }));
  crf.setOrigin(fields.origin);
  checkSignals();
  pcl::Indices all(count);
  std::iota(all.begin(), all.end(), 0);
  released([&] { crf.run(fields, all); });
  py::array_t<std::uint8_t> refined((py::ssize_t(count)));
  std::transform(fields.labels.begin(), fields.labels.end(), refined.mutable_data(),
                 [](std::uint32_t label) { return std::uint8_t(label); });
  return py::make_tuple(refined, arrayOf(crf.takeLabelDistributions()));
}

// Numbers the groups from 1; 0 = in none.
py::array_t<std::int32_t>
numbersOf(const std::vector<pcl::PointIndices>& groups, std::size_t points)
{
  py::array_t<std::int32_t> numbers((py::ssize_t(points)));
  std::fill_n(numbers.mutable_data(), points, 0);
  for (std::size_t g = 0; g < groups.size(); ++g)
    for (const pcl::index_t i : groups[g].indices)
      numbers.mutable_data()[i] = std::int32_t(g + 1);
  return numbers;
}

py::array_t<std::int32_t>
cliques(const py::object& points, const std::string& kind,
        const py::object& given_colours)
{
  const auto colours = maybeIntegersOf<std::uint8_t>(given_colours, "colours");
  const auto [labelled, origin] = localCloudOf(points, colours);
  pcl::PointCloud<pcl::PointXYZRGB> cloud;
  pcl::copyPointCloud(*labelled, cloud);
  const CliqueGenerator::Ptr generator = generatorOf(kind);
  if (generator->usesColour() && !colours)
    badParameter("'", kind, "' needs colours");
  warnOfNoReturns(countNoReturns(*labelled));
  generator->setOrigin(origin);
  const auto found = released([&] { return generator->generate(cloud); });
  return numbersOf(found, cloud.size());
}

py::array_t<std::int32_t>
objects(const py::object& points, const py::object& given_labels, double gap,
        int min_points)
{
  if (min_points < 1)
    badParameter("min_points is ", min_points, ", expected 1 or more");
  ObjectExtraction<pcl::PointXYZRGBL> extraction;
  extraction.setGap(gap);
  extraction.setMinClusterSize(std::size_t(min_points));
  const auto [cloud, origin] = localCloudOf(points, std::nullopt);
  setLabels(given_labels, *cloud);
  warnOfNoReturns(countNoReturns(*cloud));
  std::vector<pcl::PointIndices> found;
  if (!cloud->empty()) {
    extraction.setInputCloud(cloud);
    released([&] { extraction.extract(found); });
  }
  return numbersOf(found, cloud->size());
}

py::list
listOf(const PlaneRing& ring)
{
  py::list corners;
  for (const Eigen::Vector3d& corner : ring)
    corners.append(py::make_tuple(corner.x(), corner.y(), corner.z()));
  return corners;
}

py::dict
dictOf(const PlaneSummary& plane)
{
  py::list polygons;
  for (const PlanePolygon& polygon : plane.polygons) {
    py::list holes;
    for (const PlaneRing& hole : polygon.holes)
      holes.append(listOf(hole));
    py::dict each;
    each["outer"] = listOf(polygon.outer);
    each["holes"] = holes;
    polygons.append(each);
  }
  py::dict result;
  result["id"] = plane.id;
  result["label"] = int(plane.label);
  result["points"] = plane.points;
  result["normal"] =
      py::make_tuple(plane.normal.x(), plane.normal.y(), plane.normal.z());
  result["offset"] = plane.offset;
  result["area"] = plane.area;
  result["polygons"] = polygons;
  return result;
}

py::tuple
planes(const py::object& points, const py::object& given_labels, double radius,
       double distance, double min_area)
{
  PlaneParameters parameters;
  parameters.radius = radius;
  parameters.distance = distance;
  parameters.min_area = min_area;
  const auto [cloud, origin] = localCloudOf(points, std::nullopt);
  for (pcl::PointXYZRGBL& point : *cloud)
    point.label = 0;
  if (!given_labels.is_none())
    setLabels(given_labels, *cloud);
  warnOfNoReturns(countNoReturns(*cloud));
  const CloudPlanes found = released([&, &given = cloud, &from = origin] {
    return findPlanes(given, 0.0, from, parameters);
  });
  py::list list;
  for (const PlaneSummary& plane : found.planes)
    list.append(dictOf(plane));
  return py::make_tuple(py::array_t<std::uint32_t>(py::ssize_t(found.numbers.size()),
                                                   found.numbers.data()),
                        list);
}

} // namespace

void
bindClouds(py::module_& module)
{
  module.def(
      "refine", &refine, py::arg("points"), py::kw_only(),
      py::arg("probabilities") = py::none(), py::arg("labels") = py::none(),
      py::arg("colours") = py::none(), py::arg("cliques") = py::none(),
      py::arg("classes") = 0, py::arg("thin") = py::tuple(),
      "Makes the labels of a cloud consistent, as pcl_semantic_crf does.\n\n"
      "points: N x 3 [m]. probabilities: N x L, column k is class k + 1; a row sums\n"
      "to 1 (within 0.1), or to 0 = unlabelled. Or\n"
      "labels: N, 0 = unlabelled, of which classes there are (0: the largest); an\n"
      "instance in the upper 16 bits is taken off.\n"
      "colours: N x 3, red green blue. cliques: N numbers, 0 = none, or the\n"
      "word of a generator ('planes'). thin: labels that neighbours do\n"
      "not outvote. Other keywords are parameters of pcl_semantic_crf:\n"
      " crf='hierarchical', smoothness_weight=3.\n"
      "Returns labels (N) and probabilities (N x L).");
  module.def(
      "cliques", &cliques, py::arg("points"), py::arg("kind") = "planes", py::kw_only(),
      py::arg("colours") = py::none(),
      "Groups points that are likely to have one label: 'planes[:EDGE]',\n"
      "'supervoxel[:DISTANCE]', 'cubes[:EDGE]', or several, separated by commas,\n"
      "the first with priority. Returns N numbers, 0 = in none.");
  module.def(
      "planes", &planes, py::arg("points"), py::kw_only(),
      py::arg("labels") = py::none(), py::arg("radius") = 0.0,
      py::arg("distance") = 0.0, py::arg("min_area") = 0.0,
      "Finds the planes of a cloud, as pcl_semantic_things does.\n\n"
      "points: N x 3 [m]. labels: N, for the class of a plane. radius of the\n"
      "surroundings of a point, distance of a point from its plane [m], min_area\n"
      "[m^2]; 0 = automatic. Returns N numbers, 0 = none, and a list of dicts as\n"
      "in planes.json: id, label, points, normal, offset, area, polygons.");
  module.def(
      "objects", &objects, py::arg("points"), py::arg("labels"), py::kw_only(),
      py::arg("gap") = ObjectExtractionBase::default_gap, py::arg("min_points") = 20,
      "Numbers the objects: groups of points of one label, in which each point\n"
      "is at most a gap from another one.\n\n"
      "points: N x 3 [m]. labels: N, 0 = no object; set those of classes without\n"
      "objects to 0. gap [m]. min_points: smaller groups are no objects.\n"
      "Returns N numbers, 0 = in none.");
}

} // namespace pcl_semantic::python
