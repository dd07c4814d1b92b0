// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/label_set.h>
#include <pcl_semantic/pictures/scene_view.h>
#include <pcl_semantic/things/object_summary.h>
#include <pcl_semantic/things/plane_summary.h>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include <optional>
#include <utility>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief A line in a scene. */
struct SceneLine {
  Eigen::Vector3d from, to; ///< in the world frame of a view [m]
  cv::Vec3b colour;         ///< blue, green, red
};

/** \brief The edges of the yaw boxes of objects, in the colours of their classes.
 * \param[in] origin of the lines' frame, in the frame of the objects [m] */
std::vector<SceneLine> boxLines(const std::vector<ObjectSummary>& objects,
                                const LabelSet& label_set,
                                const Eigen::Vector3d& origin);

/** \brief The outlines of planes and of their holes, in the colours of their classes.
 * \param[in] origin of the lines' frame, in the frame of the planes [m] */
std::vector<SceneLine> outlineLines(const std::vector<PlaneSummary>& planes,
                                    const LabelSet& label_set,
                                    const Eigen::Vector3d& origin);

/** \brief Projects a line into an image.
 * \param[in] from,to in the world frame of the view [m]
 * \return the part inside the image and in front of the camera, as column, row and
 * depth [m] of its ends; none if there is no such part */
std::optional<std::pair<Eigen::Vector3d, Eigen::Vector3d>>
projectLine(const SceneView& view, const Eigen::Vector3d& from,
            const Eigen::Vector3d& to);

/** \brief Draws the parts of lines that are not behind a surface, with a white border
 * for contrast.
 * \param[in,out] picture CV_8UC3 (BGR), of the view's size
 * \param[in] depth of the surface (CV_64FC1), 0 = none [m]
 * \param[in] margin by which a visible line may be behind the surface [m]
 * \param[in] width [px] */
void drawLines(cv::Mat& picture, const cv::Mat& depth, const SceneView& view,
               const std::vector<SceneLine>& lines, double margin, int width);

} // namespace pcl_semantic
