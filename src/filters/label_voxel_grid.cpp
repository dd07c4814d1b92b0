// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/filters/label_voxel_grid.h>

#include "core/fail.h"
#include "label_fields.h"

#include <pcl_semantic/clouds/labelled_cloud.h>
#include <pcl_semantic/core/no_return.h>
#include <pcl_semantic/core/position_steps.h>
#include <pcl_semantic/core/voxel_index.h>
#include <pcl_semantic/filters/cloud_crf.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace pcl_semantic {

namespace {

struct Member {
  VoxelIndex voxel;
  pcl::index_t point;
};

bool
isBefore(const Member& a, const Member& b)
{
  if (a.voxel != b.voxel)
    return VoxelIndexLess()(a.voxel, b.voxel);
  return a.point < b.point;
}

// As in SemanticCRF.
bool
isOutOfReach(const pcl::PointXYZRGBL& point)
{
  return point.getArray3fMap().abs().maxCoeff() > CloudCRF::max_coordinate;
}

using Range = std::pair<const Member*, const Member*>; // of one voxel

// At a tie, the first.
pcl::index_t
nearestToMean(const pcl::PointCloud<pcl::PointXYZRGBL>& cloud, const Range& members)
{
  const auto position = [&](const Member* member) {
    return cloud[std::size_t(member->point)].getVector3fMap().cast<double>();
  };
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Member* m = members.first; m != members.second; ++m)
    mean += position(m) / double(members.second - members.first);
  return std::min_element(members.first, members.second,
                          [&](const Member& a, const Member& b) {
                            return (position(&a) - mean).squaredNorm() <
                                   (position(&b) - mean).squaredNorm();
                          })
      ->point;
}

Label
mostFrequentLabel(const pcl::PointCloud<pcl::PointXYZRGBL>& cloud, const Range& members)
{
  std::array<std::size_t, 256> counts{};
  for (const Member* m = members.first; m != members.second; ++m)
    ++counts[cloud[std::size_t(m->point)].label];
  const auto most = std::max_element(counts.begin() + 1, counts.end());
  return *most > 0 ? Label(most - counts.begin()) : kUnlabelled;
}

} // namespace

void
LabelVoxelGrid::setLeafSize(double edge)
{
  if (!(edge > 0.0 && std::isfinite(edge)))
    badParameter("voxel size is ", edge, " m, expected more than 0");
  edge_ = edge;
}

void
LabelVoxelGrid::applyFilter(pcl::PCLPointCloud2& output)
{
  if (!(edge_ > 0.0))
    badParameter("LabelVoxelGrid needs a voxel size: setLeafSize()");
  if (input_->width == 0 || input_->height == 0) {
    output = *input_;
    return;
  }
  PcdTable table(*input_);
  LabelFields label_fields(*input_, table);
  passOver({"rgb", "rgba", "clique"}, table);
  const LabelledCloud labelled = labelledCloudOf(std::move(table), "cloud");
  label_fields.requireRead(labelled);
  const auto& cloud = *labelled.cloud;
  for (const std::string& doubt : labelled.table.doubts)
    warnOfDoubt("LabelVoxelGrid", doubt);
  const PlaceTest has_place(cloud);
  const CloudPositions positions(labelled);
  std::vector<Member> members;
  for (const pcl::index_t i : *indices_) {
    if (i < 0 || std::size_t(i) >= cloud.size())
      badParameter("the index ", i, " is beyond the cloud of ", cloud.size(),
                   " points");
    const pcl::PointXYZRGBL& point = cloud[std::size_t(i)];
    if (!has_place(point) || isOutOfReach(point))
      continue;
    const Eigen::Array3d voxel = (positions(std::size_t(i)).array() / edge_).floor();
    if (!(voxel.abs() < double(kMaxVoxelIndex)).all())
      badParameter("point ", i, " is more than ", kMaxVoxelIndex, " voxels of ", edge_,
                   " m from the origin; take larger ones");
    members.push_back({voxel.cast<int>(), i});
  }
  std::sort(members.begin(), members.end(), isBefore);
  const auto isSame = [](const Member& a, const Member& b) {
    return a.point == b.point;
  };
  members.erase(std::unique(members.begin(), members.end(), isSame), members.end());
  pcl::PCLPointCloud2 result;
  result.header = input_->header;
  result.fields = input_->fields;
  result.point_step = input_->point_step;
  result.height = 1;
  result.is_dense = true;
  LabelDistributions mean;
  if (labelled.distributions.classes() > 0)
    mean = LabelDistributions(labelled.distributions.classes(), 1);
  const Member* const end = members.data() + members.size();
  for (const Member* first = members.data(); first != end;) {
    const Range range(first, std::find_if(first, end, [&](const Member& member) {
                        return member.voxel != first->voxel;
                      }));
    Label label = mostFrequentLabel(cloud, range);
    if (mean.classes() > 0) {
      mean.matrix().setZero();
      for (const Member* m = range.first; m != range.second; ++m)
        mean.matrix().col(0) += labelled.distributions.matrix().col(m->point);
      mean.normalize();
      label = mean.mapLabel(0);
    }
    const std::uint8_t* const point =
        input_->data.data() +
        offsetOfPoint(*input_, std::size_t(nearestToMean(cloud, range)));
    result.data.insert(result.data.end(), point, point + input_->point_step);
    label_fields.write(result.data.data() + result.data.size() - result.point_step,
                       label, mean, 0);
    ++result.width;
    first = range.second;
  }
  result.row_step = result.width * result.point_step;
  output = std::move(result);
}

} // namespace pcl_semantic
