// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/filters/semantic_crf.h>

#include "core/fail.h"
#include "label_fields.h"

#include <pcl_semantic/clouds/labelled_cloud.h>

namespace pcl_semantic {

template class SemanticCRF<pcl::PointXYZL>;
template class SemanticCRF<pcl::PointXYZRGBL>;
template class SemanticCRF<pcl::PointXYZLNormal>;

void
SemanticCRF<pcl::PCLPointCloud2>::applyFilter(pcl::PCLPointCloud2& output)
{
  if (input_->width == 0 || input_->height == 0) {
    runEmpty();
    output = *input_;
    return;
  }
  const ThreadScope threads(terms_.threads);
  PcdTable table(*input_);
  LabelFields label_fields(*input_, table);
  const bool reads_measurements = !hasMeasurements();
  const bool reads_cliques =
      terms_.usesCliques() && !hasCliqueSource() && table.find("clique") >= 0;
  if (!reads_cliques)
    passOver({"clique"}, table);
  if (!usesColour())
    passOver({"rgb", "rgba"}, table);
  LabelledCloud labelled = labelledCloudOf(std::move(table), "cloud");
  label_fields.requireRead(labelled);
  if (reads_measurements && labelled.distributions.classes() == 0)
    badParameter("cloud: has no field 'probability'; call setLabelConfidence() "
                 "to start from its labels");
  CloudFields fields;
  fields.width = input_->width;
  fields.height = input_->height;
  fields.origin = labelled.origin + origin_;
  fields.is_single = labelled.is_single;
  const auto count = Eigen::Index(labelled.cloud->size());
  fields.positions.resize(3, count);
  fields.colours.resize(3, labelled.has_colour ? count : 0);
  for (Eigen::Index i = 0; i < count; ++i) {
    const pcl::PointXYZRGBL& point = (*labelled.cloud)[std::size_t(i)];
    fields.positions.col(i) = point.getVector3fMap();
    fields.labels.push_back(point.label);
    if (labelled.has_colour)
      fields.colours.col(i) << float(point.r), float(point.g), float(point.b);
  }
  run(fields, *indices_, reads_measurements ? &labelled.distributions : nullptr,
      reads_cliques ? &labelled.cliques : nullptr);
  label_fields.requireClasses(getLabelDistributions().classes());
  output = *input_;
  for (const pcl::index_t i : *indices_)
    label_fields.write(output.data.data() + offsetOfPoint(output, std::size_t(i)),
                       fields.labels[std::size_t(i)], getLabelDistributions(), i);
}

} // namespace pcl_semantic
