// SPDX-License-Identifier: BSD-3-Clause
#include "label_fields.h"
#include "clouds/known_fields.h"
#include "clouds/table_parts.h"
#include "core/fail.h"

#include <pcl/common/io.h>

#include <algorithm>
#include <cstring>

namespace pcl_semantic {

namespace {

using Field = pcl::PCLPointField;

// Returns the byte after the value.
template <typename T>
std::uint8_t*
put(float number, std::uint8_t* to)
{
  const auto value = T(number);
  std::memcpy(to, &value, sizeof(value));
  return to + sizeof(value);
}

template <typename T>
void
writeAs(std::uint8_t* bytes, std::uint32_t label)
{
  const auto value = static_cast<T>(label);
  std::memcpy(bytes, &value, sizeof(value));
}

} // namespace

LabelFields::LabelFields(const pcl::PCLPointCloud2& cloud, const PcdTable& table)
{
  const int label = findLabelField(cloud);
  if (label < 0)
    badParameter("cloud: has no field 'label' to write the result to");
  label_ = cloud.fields[std::size_t(label)];
  if (pcl::getFieldSize(label_.datatype) == 0 || label_.datatype == Field::INT8 ||
      label_.datatype == Field::BOOL)
    badParameter("cloud: the field 'label' has a type that cannot hold 255");
  write_label_ = withTypeOf(label_, [](auto zero) { return &writeAs<decltype(zero)>; });
  for (const int index : findProbabilityFields(table))
    for (const pcl::PCLPointField& field : cloud.fields)
      if (field.name == table.fields[std::size_t(index)].name)
        probabilities_.push_back(field);
}

void
LabelFields::requireRead(const LabelledCloud& read)
{
  if (label_.name != "label" && read.table.label_source != label_.name) {
    for (const std::string& doubt : read.table.doubts)
      if (doubt.find("'" + label_.name + "' is not read as labels") != doubt.npos)
        badInput(doubt);
    badInput("cloud: field '", label_.name, "' is not read as labels");
  }
  if (read.distributions.classes() == 0)
    probabilities_.clear();
  for (const pcl::PCLPointField& field : probabilities_)
    if (field.datatype != Field::FLOAT32 && field.datatype != Field::FLOAT64)
      badParameter("cloud: the field '", field.name,
                   "' has a type that cannot hold probabilities");
}

void
LabelFields::requireClasses(int classes) const
{
  std::size_t room = 0;
  for (const pcl::PCLPointField& field : probabilities_)
    room += std::max<std::size_t>(field.count, 1);
  if (!probabilities_.empty() && room != std::size_t(classes))
    badParameter("cloud: the field '", probabilities_[0].name, "' holds ", room,
                 " classes, and the result has ", classes);
}

void
passOver(const std::vector<std::string>& names, PcdTable& table)
{
  for (auto& field : table.fields)
    if (std::count(names.begin(), names.end(), field.name))
      field.name = "_"; // as PCL's padding
}

void
LabelFields::write(std::uint8_t* point, std::uint32_t label,
                   const LabelDistributions& distributions, Eigen::Index column) const
{
  write_label_(point + label_.offset, label);
  const float* values = distributions.column(column);
  for (const pcl::PCLPointField& field : probabilities_) {
    std::uint8_t* to = point + field.offset;
    for (std::size_t k = 0; k < std::max<std::size_t>(field.count, 1); ++k, ++values)
      to = field.datatype == pcl::PCLPointField::FLOAT64 ? put<double>(*values, to)
                                                         : put<float>(*values, to);
  }
}

} // namespace pcl_semantic
