// SPDX-License-Identifier: BSD-3-Clause
#include "label_fields.h"
#include "core/fail.h"
#include "files/known_fields.h"

#include <algorithm>
#include <cstring>
#include <string>
#include <vector>

namespace pcl_semantic {

namespace {

template <typename T>
void
writeAs(std::uint8_t* bytes, std::uint32_t label)
{
  const auto value = static_cast<T>(label);
  std::memcpy(bytes, &value, sizeof(value));
}

void (*writerOf(const pcl::PCLPointField& field))(std::uint8_t*, std::uint32_t)
{
  using Field = pcl::PCLPointField;
  switch (field.datatype) {
  case Field::UINT8:
    return writeAs<std::uint8_t>;
  case Field::INT16:
    return writeAs<std::int16_t>;
  case Field::UINT16:
    return writeAs<std::uint16_t>;
  case Field::INT32:
    return writeAs<std::int32_t>;
  case Field::UINT32:
    return writeAs<std::uint32_t>;
  case Field::INT64:
    return writeAs<std::int64_t>;
  case Field::UINT64:
    return writeAs<std::uint64_t>;
  case Field::FLOAT32:
    return writeAs<float>;
  case Field::FLOAT64:
    return writeAs<double>;
  default:
    badParameter("cloud: the field 'label' has a type that cannot hold 255");
  }
}

} // namespace

LabelFields::LabelFields(const pcl::PCLPointCloud2& cloud)
{
  const auto find = [&](const std::string& name) {
    return std::find_if(
        cloud.fields.begin(), cloud.fields.end(),
        [&](const pcl::PCLPointField& field) { return field.name == name; });
  };
  std::vector<std::string> names;
  for (const pcl::PCLPointField& field : cloud.fields)
    names.push_back(field.name);
  const int found = findLabelField(names);
  const auto label = found < 0 ? cloud.fields.end() : cloud.fields.begin() + found;
  const auto probability = find("probability");
  if (label == cloud.fields.end())
    badParameter("cloud: has no field 'label' to write the result to");
  label_ = *label;
  write_label_ = writerOf(label_);
  if (probability != cloud.fields.end() &&
      probability->datatype == pcl::PCLPointField::FLOAT32)
    probability_ = *probability;
}

void
LabelFields::write(std::uint8_t* point, std::uint32_t label,
                   const LabelDistributions& distributions, Eigen::Index column) const
{
  write_label_(point + label_.offset, label);
  if (probability_ && int(probability_->count) == distributions.classes())
    std::memcpy(point + probability_->offset, distributions.column(column),
                sizeof(float) * probability_->count);
}

} // namespace pcl_semantic
