// SPDX-License-Identifier: BSD-3-Clause
#include "label_fields.h"
#include "core/fail.h"
#include "files/known_fields.h"
#include "files/pcd_table.h"

#include <pcl/common/io.h>

#include <cstring>

namespace pcl_semantic {

namespace {

using Field = pcl::PCLPointField;

template <typename T>
void
writeAs(std::uint8_t* bytes, std::uint32_t label)
{
  const auto value = static_cast<T>(label);
  std::memcpy(bytes, &value, sizeof(value));
}

} // namespace

LabelFields::LabelFields(const pcl::PCLPointCloud2& cloud)
{
  const int label = findLabelField(cloud);
  const int probability = pcl::getFieldIndex(cloud, "probability");
  if (label < 0)
    badParameter("cloud: has no field 'label' to write the result to");
  label_ = cloud.fields[std::size_t(label)];
  if (pcl::getFieldSize(label_.datatype) == 0 || label_.datatype == Field::INT8 ||
      label_.datatype == Field::BOOL)
    badParameter("cloud: the field 'label' has a type that cannot hold 255");
  write_label_ = withTypeOf(label_, [](auto zero) { return &writeAs<decltype(zero)>; });
  if (probability >= 0 &&
      cloud.fields[std::size_t(probability)].datatype == Field::FLOAT32)
    probability_ = cloud.fields[std::size_t(probability)];
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
