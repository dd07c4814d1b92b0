// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/label_set.h>
#include <pcl_semantic/things/plane_extraction.h>

#include <Eigen/Core>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief A closed line in a plane; its last corner is connected with the first [m]. */
using PlaneRing = std::vector<Eigen::Vector3d>;

/** \brief One connected part of a plane. */
struct PlanePolygon {
  PlaneRing outer;              ///< counterclockwise seen against the normal
  std::vector<PlaneRing> holes; ///< clockwise
};

/** \brief A plane of a labelled cloud, in the frame of the cloud, or of a map, in the
 * world frame. */
struct PlaneSummary {
  std::uint32_t id = 0;                              ///< from 1
  Label label = kUnlabelled;                         ///< most frequent of its points
  std::size_t points = 0;                            ///< number of points
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ(); ///< length 1
  double offset = 0.0;                               ///< normal . p + offset = 0 [m]
  double area = 0.0;                                 ///< [m^2]
  std::vector<PlanePolygon> polygons;
};

/** \brief Summarizes a plane, without its id. Area and outline are those of the squares
 * of a grid in the plane that have points. Gaps of up to two squares are closed, and
 * the outline is simplified by at most one square.
 * \param[in] plane with at least one point
 * \param[in] position of a point [m]
 * \param[in] label of a point; unlabelled points do not vote
 * \param[in] square edge of a square, at least the distance of the points [m]
 * \throws InvalidParameterException unless the edge is positive
 * \throws BadInputException if a point is more than 2^28 squares from the origin */
PlaneSummary summarizePlane(const ExtractedPlane& plane,
                            const std::function<Eigen::Vector3d(std::size_t)>& position,
                            const std::function<Label(std::size_t)>& label,
                            double square);

/** \brief The planes of a labelled cloud. */
struct CloudPlanes {
  std::vector<PlaneSummary> planes;
  std::vector<std::uint32_t> numbers; ///< id of each point's plane, 0 = none
};

/** \brief Extracts and summarizes the planes of a cloud. Their ids are 1, 2, ... in the
 * order of PlaneExtraction.
 * \param[in] cloud with labels up to 255
 * \param[in] voxel_size edge of the voxels, for the automatic radius; 0 = use the
 * spacing of the points [m]
 * \param[in] origin that was subtracted from the positions [m]; the summaries are in
 * the frame before
 * \throws InvalidParameterException as PlaneParameters::validate()
 * \throws BadInputException as PlaneExtraction and summarizePlane() */
CloudPlanes findPlanes(const pcl::PointCloud<pcl::PointXYZRGBL>::ConstPtr& cloud,
                       double voxel_size,
                       const Eigen::Vector3d& origin = Eigen::Vector3d::Zero(),
                       PlaneParameters parameters = PlaneParameters());

} // namespace pcl_semantic
