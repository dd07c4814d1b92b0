// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/stereo_camera.h>

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <opencv2/core/mat.hpp>

#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Triangulates a disparity image: Z = f b / d.
 * \param[in] disparity CV_32FC1 [px], 0 = none
 * \param[in] image the left image, CV_8UC3 (BGR) or CV_8UC1, of the same size
 * \param[in] camera its image size is checked if known
 * \return organized cloud in the left camera's frame [m], one point per pixel; without
 * disparity x, y, z are NaN and the colour is kept
 * \throws InvalidParameterException as StereoCamera::validate()
 * \throws BadInputException if the sizes of the images and the camera differ, for
 * another type, or for a negative or non-finite disparity */
pcl::PointCloud<pcl::PointXYZRGB>::Ptr disparityToCloud(const cv::Mat& disparity,
                                                        const cv::Mat& image,
                                                        const StereoCamera& camera);

/** \brief The image in the colours of an organized cloud, CV_8UC3 (BGR), including
 * points without depth. */
cv::Mat imageOfCloud(const pcl::PointCloud<pcl::PointXYZRGB>& cloud);

/** \brief Standard deviation of the distance to each point [m]: Z^2 sigma / (f b) for a
 * depth Z, scaled from depth to distance along the ray.
 * \param[in] cloud from disparityToCloud()
 * \param[in] disparity_deviation sigma of each disparity [px], CV_32FC1
 * \param[in] scale factor on the deviations
 * \return one per point; 0 without depth
 * \throws InvalidParameterException if the scale is negative or not finite
 * \throws BadInputException unless the deviations are CV_32FC1 of the cloud's size */
std::vector<float> distanceDeviations(const pcl::PointCloud<pcl::PointXYZRGB>& cloud,
                                      const StereoCamera& camera,
                                      const cv::Mat& disparity_deviation,
                                      double scale = 1.0);

} // namespace pcl_semantic
