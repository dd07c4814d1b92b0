/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include "labelled_table.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/files/pcd_file.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>

namespace pcl_semantic::tool {

namespace {

// A whole number that is in a column.
std::uint32_t
numberIn(const PcdColumn& column, std::size_t point, double largest,
         const std::string& path)
{
  const double value = column(point);
  if (!(value >= 0.0 && value <= largest) || value != std::floor(value))
    PCL_THROW_EXCEPTION(BadInputException,
                        path << ": point " << point << " has the "
                             << column.field().name << " " << value
                             << ", expected a whole number from 0 to " << largest);
  return std::uint32_t(value);
}

template <typename T>
void
setColumn(PcdTable& table, const PcdField& field, const std::vector<T>& values)
{
  std::vector<std::uint8_t> bytes(values.size() * sizeof(T));
  std::memcpy(bytes.data(), values.data(), bytes.size());
  table.setColumn(field, bytes);
}

} // namespace

LabelledTable::LabelledTable(const std::string& file) : path(file), table(readPcd(file))
{
  for (const char* name : {"x", "y", "z"})
    if (table.find(name) < 0)
      PCL_THROW_EXCEPTION(BadInputException, path << ": has no field '" << name << "'");
  if (table.find("label") < 0 && table.find("probability") < 0)
    PCL_THROW_EXCEPTION(BadInputException,
                        path << ": has no field 'label' or 'probability'");
}

bool
LabelledTable::hasColour() const
{
  return table.find("rgb") >= 0 || table.find("rgba") >= 0;
}

pcl::PointCloud<pcl::PointXYZRGBL>::Ptr
LabelledTable::cloud() const
{
  auto cloud = std::make_shared<pcl::PointCloud<pcl::PointXYZRGBL>>();
  cloud->resize(table.points);
  if (table.width * table.height == table.points) {
    cloud->width = std::uint32_t(table.width);
    cloud->height = std::uint32_t(table.height);
  }
  cloud->is_dense = false;
  const PcdColumn x(table, table.find("x")), y(table, table.find("y")),
      z(table, table.find("z"));
  for (std::size_t i = 0; i < table.points; ++i)
    (*cloud)[i].getVector3fMap() << float(x(i)), float(y(i)), float(z(i));
  if (table.find("label") >= 0) {
    const PcdColumn label(table, table.find("label"));
    for (std::size_t i = 0; i < table.points; ++i)
      (*cloud)[i].label = numberIn(label, i, 255.0, path);
  }
  if (hasColour()) {
    const PcdColumn colour(table, std::max(table.find("rgb"), table.find("rgba")));
    for (std::size_t i = 0; i < table.points; ++i)
      (*cloud)[i].rgba = colour.bits(i);
  }
  return cloud;
}

LabelDistributions
LabelledTable::distributions(int classes, double confidence) const
{
  const auto count = static_cast<Eigen::Index>(table.points);
  if (table.find("probability") < 0) {
    const auto labels = cloud();
    int most = 1;
    for (const pcl::PointXYZRGBL& point : *labels)
      most = std::max(most, int(point.label));
    if (classes > 0 && most > classes)
      PCL_THROW_EXCEPTION(BadInputException, path << ": has the label " << most
                                                  << ", expected 0 to " << classes);
    LabelDistributions distributions(classes > 0 ? classes : most, count);
    for (Eigen::Index i = 0; i < count; ++i)
      distributions.setLabel(i, Label((*labels)[std::size_t(i)].label),
                             float(confidence));
    return distributions;
  }
  const PcdColumn column(table, table.find("probability"));
  const int found = column.field().count;
  if (found > 255 || (classes > 0 && found != classes))
    PCL_THROW_EXCEPTION(BadInputException, path << ": has probabilities of " << found
                                                << " classes, expected "
                                                << (classes > 0 ? classes : 255)
                                                << (classes > 0 ? "" : " at most"));
  LabelDistributions distributions(found, count);
  for (Eigen::Index i = 0; i < count; ++i)
    for (int k = 0; k < found; ++k)
      distributions.matrix()(k, i) = float(column(std::size_t(i), k));
  try {
    distributions.normalize();
  }
  catch (const BadInputException& error) {
    PCL_THROW_EXCEPTION(BadInputException, path << ": " << error.what());
  }
  return distributions;
}

std::vector<pcl::PointIndices>
LabelledTable::cliques() const
{
  if (table.find("clique") < 0)
    PCL_THROW_EXCEPTION(BadInputException, path << ": has no field 'clique'");
  const PcdColumn column(table, table.find("clique"));
  std::map<std::uint32_t, pcl::PointIndices> cliques;
  for (std::size_t i = 0; i < table.points; ++i)
    if (const std::uint32_t number = numberIn(column, i, 4294967295.0, path))
      cliques[number].indices.push_back(pcl::index_t(i));
  std::vector<pcl::PointIndices> lists;
  for (auto& [number, clique] : cliques)
    lists.push_back(std::move(clique));
  return lists;
}

void
LabelledTable::setResult(const pcl::PointCloud<pcl::PointXYZRGBL>& labels,
                         const LabelDistributions& distributions)
{
  std::vector<std::uint32_t> numbers;
  std::vector<float> entropies;
  for (std::size_t i = 0; i < table.points; ++i) {
    numbers.push_back(labels[i].label);
    entropies.push_back(distributions.entropy(Eigen::Index(i)));
  }
  setColumn(table, {"label", 'U', 4, 1}, numbers);
  setColumn(table, {"probability", 'F', 4, distributions.classes()},
            std::vector<float>(distributions.matrix().data(),
                               distributions.matrix().data() +
                                   distributions.matrix().size()));
  if (table.find("entropy") >= 0)
    setColumn(table, {"entropy", 'F', 4, 1}, entropies);
}

} // namespace pcl_semantic::tool
