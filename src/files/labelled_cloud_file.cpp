// SPDX-License-Identifier: BSD-3-Clause
#include "pcd_file.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/files/cloud_file.h>
#include <pcl_semantic/files/labelled_cloud_file.h>
#include <pcl_semantic/files/pcd_table.h>

#include <pcl/PointIndices.h>
#include <pcl/common/point_tests.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

namespace pcl_semantic {

/** \brief A field of one element. \throws BadInputException if it has more */
PcdColumn singleColumn(const std::string& path, const PcdTable& table, int field);

/** \brief Says that a value of a field is not what was expected.
 * \throws BadInputException */
[[noreturn]] void badPcdValue(const std::string& path, const PcdColumn& column,
                              std::size_t point, double value,
                              const std::string& expected);

/** \brief A value of a field. \throws BadInputException unless it is a whole number
 * from 0 to \a largest */
std::uint32_t wholeNumber(const std::string& path, const PcdColumn& column,
                          std::size_t point, std::uint32_t largest);

/** \brief The finite points of each number of the field `clique` but 0, in the order of
 * the numbers; none without that field. \throws BadInputException */
std::vector<pcl::PointIndices>
cliquesOfColumn(const std::string& path, const PcdTable& table,
                const pcl::PointCloud<pcl::PointXYZRGBL>& cloud);

/** \brief Whether two lists of cliques hold the same points in the same order. */
bool sameCliques(const std::vector<pcl::PointIndices>& a,
                 const std::vector<pcl::PointIndices>& b);

/** \brief Puts cliques into the field `clique`: the first is number 1.
 * \throws InvalidParameterException if an index is out of range or two overlap */
void setCliqueColumn(const std::string& path,
                     const std::vector<pcl::PointIndices>& cliques, PcdTable& table);

namespace {

constexpr const char* kField = "clique";

} // namespace

PcdColumn
singleColumn(const std::string& path, const PcdTable& table, int field)
{
  const PcdColumn column(table, field);
  if (column.field().count != 1)
    PCL_THROW_EXCEPTION(BadInputException,
                        path << ": field '" << column.field().name << "' has COUNT "
                             << column.field().count << ", expected 1");
  return column;
}

void
badPcdValue(const std::string& path, const PcdColumn& column, std::size_t point,
            double value, const std::string& expected)
{
  PCL_THROW_EXCEPTION(BadInputException, path << ": field '" << column.field().name
                                              << "' of point " << point << " is "
                                              << value << ", expected " << expected);
}

std::uint32_t
wholeNumber(const std::string& path, const PcdColumn& column, std::size_t point,
            std::uint32_t largest)
{
  const double value = column(point);
  if (!(value >= 0.0 && value <= largest) || value != std::floor(value))
    badPcdValue(path, column, point, value,
                "a whole number from 0 to " + std::to_string(largest));
  return static_cast<std::uint32_t>(value);
}

std::vector<pcl::PointIndices>
cliquesOfColumn(const std::string& path, const PcdTable& table,
                const pcl::PointCloud<pcl::PointXYZRGBL>& cloud)
{
  const int field = table.find(kField);
  if (field < 0)
    return {};
  const PcdColumn column = singleColumn(path, table, field);
  std::vector<std::pair<std::uint32_t, pcl::index_t>> members; // clique, point
  for (std::size_t i = 0; i < table.points; ++i) {
    const std::uint32_t number =
        wholeNumber(path, column, i, std::numeric_limits<std::uint32_t>::max());
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

bool
sameCliques(const std::vector<pcl::PointIndices>& a,
            const std::vector<pcl::PointIndices>& b)
{
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const pcl::PointIndices& x, const pcl::PointIndices& y) {
                      return x.indices == y.indices;
                    });
}

void
setCliqueColumn(const std::string& path, const std::vector<pcl::PointIndices>& cliques,
                PcdTable& table)
{
  std::vector<std::uint32_t> numbers(table.points, 0);
  std::uint32_t number = 0;
  for (const pcl::PointIndices& clique : cliques) {
    ++number;
    for (const pcl::index_t index : clique.indices) {
      if (index < 0 || static_cast<std::size_t>(index) >= table.points)
        PCL_THROW_EXCEPTION(InvalidParameterException, path << ": clique " << number - 1
                                                            << " has point " << index
                                                            << " of " << table.points);
      std::uint32_t& entry = numbers[static_cast<std::size_t>(index)];
      if (entry != 0)
        PCL_THROW_EXCEPTION(InvalidParameterException,
                            path << ": point " << index << " is in cliques "
                                 << entry - 1 << " and " << number - 1
                                 << ", but a field holds one");
      entry = number;
    }
  }
  std::vector<std::uint8_t> bytes(numbers.size() * sizeof(std::uint32_t));
  if (!numbers.empty())
    std::memcpy(bytes.data(), numbers.data(), bytes.size());
  table.setColumn({kField, 'U'}, bytes);
}

namespace {

using Cloud = pcl::PointCloud<pcl::PointXYZRGBL>;

constexpr double kLargest = std::numeric_limits<float>::max();

class Reader {
public:
  Reader(PcdTable read, const std::string& name, const LabelMapping* mapping)
      : path_(name), mapping_(mapping)
  {
    result_.table = std::move(read);
    if (table().points > std::size_t(std::numeric_limits<pcl::index_t>::max()))
      PCL_THROW_EXCEPTION(BadInputException, path_
                                                 << ": has " << table().points
                                                 << " points, more than PCL can index");
  }

  LabelledCloud
  read()
  {
    Cloud& cloud = *result_.cloud;
    cloud.resize(table().points);
    cloud.width = static_cast<std::uint32_t>(table().width);
    cloud.height = static_cast<std::uint32_t>(table().height);
    readViewpoint();
    readPositions();
    readColours();
    readProbabilities();
    readLabels();
    result_.cliques = cliquesOfColumn(path_, table(), cloud);
    return std::move(result_);
  }

private:
  const PcdTable&
  table() const
  {
    return result_.table;
  }

  void
  readViewpoint()
  {
    const std::array<double, 7>& viewpoint = table().viewpoint;
    for (const double value : viewpoint)
      if (std::abs(value) > kLargest)
        PCL_THROW_EXCEPTION(BadInputException,
                            path_ << ": VIEWPOINT is beyond single precision: "
                                  << value);
    const Eigen::Matrix<float, 7, 1> v =
        Eigen::Map<const Eigen::Matrix<double, 7, 1>>(viewpoint.data()).cast<float>();
    result_.cloud->sensor_origin_ << v[0], v[1], v[2], 0.0f;
    result_.cloud->sensor_orientation_ = Eigen::Quaternionf(v[3], v[4], v[5], v[6]);
  }

  void
  readPositions()
  {
    Cloud& cloud = *result_.cloud;
    cloud.is_dense = true;
    const char* const names[] = {"x", "y", "z"};
    for (int axis = 0; axis < 3; ++axis) {
      const int field = table().find(names[axis]);
      if (field < 0)
        PCL_THROW_EXCEPTION(BadInputException,
                            path_ << ": has no field '" << names[axis] << "'");
      const PcdColumn column = singleColumn(path_, table(), field);
      for (std::size_t i = 0; i < cloud.size(); ++i) {
        const double value = column(i);
        if (std::isfinite(value) && std::abs(value) > kLargest)
          badPcdValue(path_, column, i, value, "a number of single precision");
        cloud[i].data[axis] = static_cast<float>(value);
        cloud.is_dense = cloud.is_dense && std::isfinite(value);
      }
    }
  }

  void
  readColours()
  {
    const int rgb = table().find("rgb"), rgba = table().find("rgba");
    if (rgb >= 0 && rgba >= 0)
      PCL_THROW_EXCEPTION(BadInputException,
                          path_ << ": has both 'rgb' and 'rgba', expected one");
    if (rgb < 0 && rgba < 0)
      return;
    const PcdColumn column = singleColumn(path_, table(), std::max(rgb, rgba));
    if (column.field().size != 4)
      PCL_THROW_EXCEPTION(BadInputException, path_ << ": field '" << column.field().name
                                                   << "' has " << column.field().size
                                                   << " bytes, expected 4");
    Cloud& cloud = *result_.cloud;
    for (std::size_t i = 0; i < cloud.size(); ++i)
      cloud[i].rgba = column.bits(i);
    result_.has_colour = true;
  }

  void
  readProbabilities()
  {
    const int field = table().find("probability");
    if (field < 0)
      return;
    const PcdColumn column(table(), field);
    const int classes = column.field().count;
    if (classes > 255)
      PCL_THROW_EXCEPTION(BadInputException, path_ << ": field 'probability' has COUNT "
                                                   << classes
                                                   << ", expected 1 to 255 classes");
    LabelDistributions::Matrix values(classes, Eigen::Index(table().points));
    for (std::size_t i = 0; i < table().points; ++i) {
      double sum = 0.0;
      for (int k = 0; k < classes; ++k) {
        const double value = column(i, k);
        if (!(value >= 0.0 && value <= kLargest))
          badPcdValue(path_, column, i, value, "0 to 1");
        values(k, Eigen::Index(i)) = static_cast<float>(value);
        sum += value;
      }
      constexpr double tolerance = 0.1; // as in files of distributions
      if (sum != 0.0 && std::abs(sum - 1.0) > tolerance)
        PCL_THROW_EXCEPTION(BadInputException,
                            path_ << ": field 'probability' of point " << i
                                  << " sums to " << sum << ", expected 1");
    }
    result_.distributions = LabelDistributions(classes, 0);
    if (table().points > 0)
      result_.distributions = LabelDistributions(std::move(values));
    result_.has_labels = true;
  }

  void
  readLabels()
  {
    Cloud& cloud = *result_.cloud;
    const int field = table().find("label"), classes = result_.distributions.classes();
    if (field < 0) {
      for (std::size_t i = 0; i < cloud.size(); ++i)
        cloud[i].label =
            classes > 0 ? result_.distributions.mapLabel(Eigen::Index(i)) : kUnlabelled;
      return;
    }
    const PcdColumn column = singleColumn(path_, table(), field);
    const int largest = classes > 0 ? classes : 255;
    for (std::size_t i = 0; i < cloud.size(); ++i)
      cloud[i].label = mapping_ ? mapped(column, i) : label(column, i, largest);
    result_.has_labels = true;
  }

  std::uint32_t
  label(const PcdColumn& column, std::size_t i, int largest) const
  {
    const double value = column(i);
    if (value >= 0.0 && value <= largest && value == std::floor(value))
      return std::uint32_t(value);
    badPcdValue(path_, column, i, value,
                "a whole number from 0 to " + std::to_string(largest) +
                    ", or a label mapping for other numberings");
  }

  // Numbers below 0 are what other programs write for unlabelled.
  std::uint32_t
  mapped(const PcdColumn& column, std::size_t i) const
  {
    const double value = column(i);
    if (!(std::abs(value) <= double(1u << 31)) || value != std::floor(value))
      badPcdValue(path_, column, i, value, "a whole number");
    return value < 0.0 ? kUnlabelled : (*mapping_)(std::uint32_t(value));
  }

  const std::string& path_;
  const LabelMapping* mapping_;
  LabelledCloud result_;
};

template <typename T>
std::vector<std::uint8_t>
bytesOf(const T* values, std::size_t count)
{
  std::vector<std::uint8_t> bytes(count * sizeof(T));
  if (count > 0)
    std::memcpy(bytes.data(), values, bytes.size());
  return bytes;
}

// One column of a cloud; `value` takes a point.
template <typename Value>
void
putColumn(PcdTable& table, const PcdField& field, const Cloud& cloud, Value&& value)
{
  std::vector<decltype(value(cloud[0]))> values;
  values.reserve(cloud.size());
  for (const pcl::PointXYZRGBL& point : cloud)
    values.push_back(value(point));
  table.setColumn(field, bytesOf(values.data(), values.size()));
}

// Of a cloud that was in no file.
PcdTable
newTable(const LabelledCloud& labelled)
{
  const Cloud& cloud = *labelled.cloud;
  PcdTable table;
  table.points = cloud.size();
  if (cloud.isOrganized()) {
    table.width = cloud.width;
    table.height = cloud.height;
  }
  const Eigen::Vector4f& origin = cloud.sensor_origin_;
  const Eigen::Quaternionf& q = cloud.sensor_orientation_;
  table.viewpoint = {origin[0], origin[1], origin[2], q.w(), q.x(), q.y(), q.z()};
  putColumn(table, {"x"}, cloud, [](const auto& point) { return point.x; });
  putColumn(table, {"y"}, cloud, [](const auto& point) { return point.y; });
  putColumn(table, {"z"}, cloud, [](const auto& point) { return point.z; });
  if (labelled.has_colour)
    putColumn(table, {"rgba", 'U'}, cloud,
              [](const auto& point) { return point.rgba; });
  return table;
}

} // namespace

LabelledCloud
readLabelledCloud(const std::string& path, const LabelMapping* mapping)
{
  return labelledCloudOf(readCloudTable(path), path, mapping);
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
  PcdTable table = labelled.table.fields.empty() ? newTable(labelled) : labelled.table;
  const int classes = distributions.classes();
  if (table.points != cloud.size() ||
      (classes > 0 && distributions.size() != Eigen::Index(cloud.size())))
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        name << ": the cloud has " << cloud.size()
                             << " points, its table " << table.points
                             << ", its distributions " << distributions.size());
  putColumn(table, {"label", 'U'}, cloud,
            [](const auto& point) { return point.label; });
  if (classes > 0)
    table.setColumn({"probability", 'F', 4, classes},
                    bytesOf(distributions.matrix().data(),
                            std::size_t(distributions.matrix().size())));
  if (!sameCliques(cliquesOfColumn(name, table, cloud), labelled.cliques))
    setCliqueColumn(name, labelled.cliques, table);
  return table;
}

void
writeLabelledCloud(const std::string& path, const LabelledCloud& labelled)
{
  writePcd(path, tableOf(labelled, path));
}

void
writeCliques(const std::string& path, const LabelledCloud& labelled)
{
  PcdTable table = labelled.table;
  if (table.points != labelled.cloud->size())
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        path << ": the cloud has " << labelled.cloud->size()
                             << " points, its table " << table.points);
  setCliqueColumn(path, labelled.cliques, table);
  writePcd(path, table);
}

} // namespace pcl_semantic
