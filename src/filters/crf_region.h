// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/label_set.h>
#include <pcl_semantic/core/voxel_cloud.h>
#include <pcl_semantic/filters/crf_parameters.h>
#include <pcl_semantic/filters/semantic_crf.h>

#include <pcl/types.h>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief The part of a refined map that the next run of the CRF has to see: where
 * no voxel was measured since, its result would be what it was. */
struct CrfRegion {
  pcl::Indices updated; ///< voxels whose result may be another one, in rising order
  pcl::Indices seen;    ///< these and all that they hear of, in rising order
};

/** \brief How far what a voxel says is heard after some updates [m]. */
double crfReach(const SemanticCRFParameters& parameters, double voxel_size);

/** \brief The same in blocks of 8 x 8 x 8 voxels, rounded up. */
int blocksWithin(double reach, double voxel_size);

/** \brief The voxels without a result (VoxelCloud::is_refined) and those around them,
 * by whole blocks of 8 x 8 x 8.
 *
 * \param[in] reach [m] */
CrfRegion crfRegion(const VoxelCloud& voxels, double reach);

/** \brief Runs a CRF, whose model and parameters are set, over what the region has
 * seen, and gives what it says to the voxels that are updated. */
void refineRegion(SemanticCRF<pcl::PointXYZRGBL>& crf, const LabelSet& label_set,
                  const CrfRegion& region, VoxelCloud& voxels);

} // namespace pcl_semantic
