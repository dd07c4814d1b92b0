// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/clouds/labelled_cloud.h>

#include "known_fields.h"
#include "table_parts.h"

#include "core/fail.h"
#include "core/probability_sums.h"

#include <pcl_semantic/core/local_origin.h>
#include <pcl_semantic/core/no_return.h>
#include <pcl_semantic/core/position_steps.h>
#include <pcl_semantic/core/voxel_index.h>

#include <pcl/common/point_tests.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace pcl_semantic {

namespace {

using Cloud = pcl::PointCloud<pcl::PointXYZRGBL>;

constexpr double kLargest = std::numeric_limits<float>::max();
constexpr const char* kCliqueField = "clique";

// A field of a table with its file name, for messages.
struct NamedColumn : PcdColumn {
  NamedColumn(const std::string& path_, const PcdTable& table, int index)
      : PcdColumn(table, index), path(path_)
  {}

  [[noreturn]] void
  refuse(std::size_t point, double value, const std::string& expected) const
  {
    badInput(path, ": field '", field().name, "' of point ", point, " is ", value,
             ", expected ", expected);
  }

  // A value that must be an integer from 0 to `largest`.
  std::uint32_t
  wholeNumber(std::size_t point, std::uint32_t largest, const char* or_else = "") const
  {
    const double value = (*this)(point);
    if (!(value >= 0.0 && value <= largest) || value != std::floor(value))
      refuse(point, value,
             "a whole number from 0 to " + std::to_string(largest) + or_else);
    return static_cast<std::uint32_t>(value);
  }

  const std::string& path;
};

NamedColumn
singleColumn(const std::string& path, const PcdTable& table, int field)
{
  const NamedColumn column(path, table, field);
  if (column.field().count != 1)
    badInput(path, ": field '", column.field().name, "' has COUNT ",
             column.field().count, ", expected 1");
  return column;
}

// The finite points of each non-zero number in the field `clique`, in the order of the
// numbers; none without that field.
std::vector<pcl::PointIndices>
cliquesOfColumn(const std::string& path, const PcdTable& table, const Cloud& cloud)
{
  const int field = table.find(kCliqueField);
  if (field < 0)
    return {};
  const NamedColumn column = singleColumn(path, table, field);
  std::vector<std::pair<std::uint32_t, pcl::index_t>> members; // clique, point
  for (std::size_t i = 0; i < table.points(); ++i) {
    const std::uint32_t number = column.wholeNumber(
        i, std::numeric_limits<std::uint32_t>::max() - 1); // excludes
                                                           // -1
    if (number != 0 && pcl::isXYZFinite(cloud[i]))
      members.emplace_back(number, static_cast<pcl::index_t>(i));
  }
  std::sort(members.begin(), members.end());
  std::vector<pcl::PointIndices> cliques;
  for (std::size_t m = 0; m < members.size(); ++m) {
    if (m == 0 || members[m].first != members[m - 1].first)
      cliques.emplace_back();
    cliques.back().indices.push_back(members[m].second);
  }
  return cliques;
}

class Reader {
public:
  Reader(PcdTable read, const std::string& name, const LabelMapping* mapping)
      : path_(name), mapping_(mapping)
  {
    result_.table = std::move(read);
    addKnownFields(name, result_.table);
    if (table_.points() > std::size_t(std::numeric_limits<pcl::index_t>::max()))
      badInput(path_, ": has ", table_.points(), " points, more than PCL can index");
  }

  LabelledCloud
  read()
  {
    cloud_.resize(table_.points());
    cloud_.width = table_.width;
    cloud_.height = table_.height;
    readViewpoint();
    readPositions();
    readColours();
    readProbabilities();
    readLabels();
    result_.cliques = cliquesOfColumn(path_, table_, cloud_);
    return std::move(result_);
  }

private:
  void
  readViewpoint()
  {
    for (const double value : table_.viewpoint)
      if (std::abs(value) > kLargest)
        badInput(path_, ": VIEWPOINT is beyond single precision: ", value);
    const Eigen::Matrix<float, 7, 1> v =
        Eigen::Map<const Eigen::Matrix<double, 7, 1>>(table_.viewpoint.data())
            .cast<float>();
    cloud_.sensor_origin_ << v[0], v[1], v[2], 0.0f;
    cloud_.sensor_orientation_ = Eigen::Quaternionf(v[3], v[4], v[5], v[6]);
  }

  void
  readPositions()
  {
    cloud_.is_dense = true;
    bool has_doubles = false;
    const char* const names[] = {"x", "y", "z"};
    for (int axis = 0; axis < 3; ++axis) {
      const int field = table_.find(names[axis]);
      if (field < 0 && table_.points() == 0 && table_.fields.empty())
        continue; // PCL's filters return such an empty cloud
      if (field < 0)
        badInput(path_, ": has no field '", names[axis], "'");
      const NamedColumn column = singleColumn(path_, table_, field);
      for (std::size_t i = 0; i < cloud_.size(); ++i) {
        const double value = column(i);
        if (std::isfinite(value) && std::abs(value) > kLargest)
          column.refuse(i, value, "a number of single precision");
        cloud_[i].data[axis] = static_cast<float>(value);
        cloud_.is_dense = cloud_.is_dense && std::isfinite(value);
      }
      has_doubles = has_doubles || sizeOfField(column.field()) == 8;
    }
    if (has_doubles)
      takeOriginOff();
    if (!result_.is_single)
      return;
    const std::string doubt = doubtOfSteps(cloud_, path_, result_.origin);
    if (!doubt.empty())
      result_.table.doubts.push_back(doubt);
  }

  void
  takeOriginOff()
  {
    const PcdColumn x(table_, table_.find("x")), y(table_, table_.find("y")),
        z(table_, table_.find("z"));
    Eigen::Matrix3Xd positions(3, Eigen::Index(cloud_.size()));
    for (std::size_t i = 0; i < cloud_.size(); ++i)
      positions.col(Eigen::Index(i)) << x(i), y(i), z(i);
    result_.origin = localOrigin(positions);
    result_.is_single = areSingle(positions);
    if (result_.origin.isZero(0.0))
      return;
    const Eigen::Matrix3Xf relative = relativeTo(result_.origin, positions);
    for (std::size_t i = 0; i < cloud_.size(); ++i)
      cloud_[i].getVector3fMap() = relative.col(Eigen::Index(i));
  }

  void
  readColours()
  {
    const int rgb = table_.find("rgb"), rgba = table_.find("rgba");
    if (rgb >= 0 && rgba >= 0)
      badInput(path_, ": has both 'rgb' and 'rgba', expected one");
    if (rgb < 0 && rgba < 0)
      return;
    const NamedColumn column = singleColumn(path_, table_, std::max(rgb, rgba));
    if (sizeOfField(column.field()) != 4)
      badInput(path_, ": field '", column.field().name, "' has ",
               sizeOfField(column.field()), " bytes, expected 4");
    for (std::size_t i = 0; i < cloud_.size(); ++i)
      cloud_[i].rgba = column.bits(i);
    result_.has_colour = true;
  }

  void
  readProbabilities()
  {
    const int field = table_.find("probability");
    if (field < 0)
      return;
    const NamedColumn column(path_, table_, field);
    const int classes = int(column.field().count);
    if (classes > 255)
      badInput(path_, ": field 'probability' has COUNT ", classes,
               ", expected 1 to 255 classes");
    LabelDistributions::Matrix values(classes, Eigen::Index(table_.points()));
    for (std::size_t i = 0; i < table_.points(); ++i) {
      double sum = 0.0;
      for (int k = 0; k < classes; ++k) {
        const double value = column(i, k);
        if (!(value >= 0.0 && value <= kLargest))
          column.refuse(i, value, "0 to 1");
        values(k, Eigen::Index(i)) = static_cast<float>(value);
        sum += value;
      }
      if (!isSumOfProbabilities(sum))
        badInput(path_, ": field 'probability' of point ", i, " sums to ", sum,
                 ", expected 1");
    }
    result_.distributions = LabelDistributions(classes, 0);
    if (table_.points() > 0)
      result_.distributions = LabelDistributions(std::move(values));
    result_.has_labels = true;
  }

  void
  readLabels()
  {
    const int field = table_.find("label"), classes = result_.distributions.classes();
    if (field < 0) {
      for (std::size_t i = 0; i < cloud_.size(); ++i)
        cloud_[i].label =
            classes > 0 ? result_.distributions.mapLabel(Eigen::Index(i)) : kUnlabelled;
      return;
    }
    const NamedColumn column = singleColumn(path_, table_, field);
    const auto largest = std::uint32_t(classes > 0 ? classes : 255);
    if (!table_.label_source.empty() && !mapping_ && !areLabels(column, largest))
      return dropLabels(largest);
    for (std::size_t i = 0; i < cloud_.size(); ++i)
      cloud_[i].label =
          mapping_ ? mapped(column, i)
                   : column.wholeNumber(i, largest,
                                        ", or a label mapping for other numberings");
    result_.has_labels = true;
  }

  bool
  areLabels(const PcdColumn& column, std::uint32_t largest) const
  {
    for (std::size_t i = 0; i < table_.points(); ++i)
      if (!(column(i) >= 0.0 && column(i) <= largest))
        return false;
    return true;
  }

  // A field with an alternative name may have another meaning.
  void
  dropLabels(std::uint32_t largest)
  {
    addDoubt(result_.table, path_ + ": field '" + table_.label_source +
                                "' is not read as labels: not all are 0 to " +
                                std::to_string(largest) +
                                "; a label mapping can convert them");
    result_.table.label_source.clear();
    result_.table.removeColumns("label");
    readLabels(); // from the probabilities, if there are some
  }

  // Other programs write -1 for unlabelled; other negative numbers are reported.
  std::uint32_t
  mapped(const NamedColumn& column, std::size_t i) const
  {
    const double value = column(i);
    if (!(std::abs(value) <= double(1u << 31)) || value != std::floor(value))
      column.refuse(i, value, "a whole number");
    return value == -1.0 ? kUnlabelled
                         : (*mapping_)(std::uint32_t(std::int64_t(value)));
  }

  const std::string& path_;
  const LabelMapping* mapping_;
  LabelledCloud result_;
  const PcdTable& table_ = result_.table;
  Cloud& cloud_ = *result_.cloud;
};

// For a cloud that was not read from a file.
PcdTable
newTable(const LabelledCloud& labelled, const std::string& name)
{
  if (!labelled.origin.allFinite())
    badParameter(name, ": the origin of its cloud is not finite");
  PcdTable table = tableOfPoints(*labelled.cloud, labelled.origin);
  if (!labelled.has_colour)
    table.removeColumns("rgba");
  return table;
}

} // namespace

void
setCliqueColumn(const std::string& path, const std::vector<pcl::PointIndices>& cliques,
                PcdTable& table)
{
  std::vector<std::uint32_t> numbers(table.points(), 0);
  for (std::uint32_t c = 0; c < cliques.size(); ++c)
    for (const pcl::index_t index : cliques[c].indices) {
      if (index < 0 || static_cast<std::size_t>(index) >= table.points())
        badParameter(path, ": clique ", c, " has point ", index, " of ",
                     table.points());
      std::uint32_t& entry = numbers[static_cast<std::size_t>(index)];
      if (entry != 0)
        badParameter(path, ": point ", index, " is in cliques ", entry - 1, " and ", c,
                     ", expected one");
      entry = c + 1;
    }
  table.setColumn(kCliqueField, numbers);
}

CloudPositions::CloudPositions(const LabelledCloud& labelled) : cloud_(*labelled.cloud)
{
  if (!labelled.origin.isZero(0.0))
    for (const char* const name : {"x", "y", "z"})
      columns_.emplace_back(labelled.table, labelled.table.find(name));
}

Eigen::Matrix3Xf
remaindersOf(const LabelledCloud& labelled)
{
  const auto isFar = [](const pcl::PointXYZRGBL& point) {
    return isFarOff(point.getVector3fMap());
  };
  if (labelled.origin.isZero(0.0) ||
      std::none_of(labelled.cloud->begin(), labelled.cloud->end(), isFar))
    return {};
  const CloudPositions position(labelled);
  const auto count = Eigen::Index(labelled.cloud->size());
  Eigen::Matrix3Xd positions(3, count);
  Eigen::Matrix3Xf relative(3, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    positions.col(i) = position(std::size_t(i));
    relative.col(i) = (*labelled.cloud)[std::size_t(i)].getVector3fMap();
  }
  return remaindersOf(labelled.origin, positions, relative);
}

void
addOrigin(LabelledCloud& labelled)
{
  if (labelled.origin.isZero(0.0))
    return;
  for (pcl::PointXYZRGBL& point : *labelled.cloud)
    if (!isAtZero(point)) // see relativeTo()
      point.getVector3fMap() =
          (point.getVector3fMap().cast<double>() + labelled.origin).cast<float>();
  labelled.origin.setZero();
}

Eigen::Isometry3d
viewpointOf(const PcdTable& table, const std::string& name)
{
  const auto& [x, y, z, qw, qx, qy, qz] = table.viewpoint;
  const Eigen::Quaterniond rotation(qw, qx, qy, qz);
  if (!(rotation.norm() > 1e-6) || !std::isfinite(rotation.norm()))
    badInput(name, ": VIEWPOINT has the quaternion ", qw, " ", qx, " ", qy, " ", qz,
             ", expected w x y z of length 1");
  return Eigen::Translation3d(x, y, z) * rotation.normalized();
}

LabelledCloud
labelledCloudOf(PcdTable table, const std::string& name, const LabelMapping* mapping)
{
  return Reader(std::move(table), name, mapping).read();
}

PcdTable
tableOf(const LabelledCloud& labelled, const std::string& name)
{
  const Cloud& cloud = *labelled.cloud;
  const LabelDistributions& distributions = labelled.distributions;
  PcdTable table =
      labelled.table.fields.empty() ? newTable(labelled, name) : labelled.table;
  const int classes = distributions.classes();
  if (table.points() != cloud.size() ||
      (classes > 0 && distributions.size() != Eigen::Index(cloud.size())))
    badParameter(name, ": the cloud has ", cloud.size(), " points, its table ",
                 table.points(), ", its distributions ", distributions.size());
  std::vector<std::uint32_t> labels;
  labels.reserve(cloud.size());
  for (const pcl::PointXYZRGBL& point : cloud)
    labels.push_back(point.label);
  table.setColumn("label", labels);
  if (classes > 0)
    table.setColumn(
        {"probability", 0, pcl::PCLPointField::FLOAT32, pcl::uindex_t(classes)},
        distributions.matrix().data(),
        sizeof(float) * std::size_t(distributions.matrix().size()));
  const std::vector<pcl::PointIndices> old = cliquesOfColumn(name, table, cloud);
  if (!std::equal(old.begin(), old.end(), labelled.cliques.begin(),
                  labelled.cliques.end(),
                  [](const auto& a, const auto& b) { return a.indices == b.indices; }))
    setCliqueColumn(name, labelled.cliques, table);
  return table;
}

void
moveToVoxelCentres(LabelledCloud& labelled)
{
  const auto& [size, x, y, z] = labelled.table.voxel_grid;
  if (!(size > 0.0))
    return;
  const Eigen::Vector3d corner = Eigen::Vector3d(x, y, z) - labelled.origin;
  for (pcl::PointXYZRGBL& point : *labelled.cloud) {
    const Eigen::Vector3d voxel =
        ((point.getVector3fMap().cast<double>() - corner).array() / size).floor();
    point.getVector3fMap() = (corner + centreOf(voxel, size)).cast<float>();
  }
}

} // namespace pcl_semantic
