// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/label_set.h>
#include <pcl_semantic/core/voxel_cloud.h>
#include <pcl_semantic/filters/crf_parameters.h>
#include <pcl_semantic/filters/semantic_crf.h>

#include <pcl/types.h>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Part of a refined map for the next run of the CRF. Voxels without new
 * measurements nearby would get the same result again. */
struct CrfRegion {
  pcl::Indices updated; ///< voxels whose result may change, ascending
  pcl::Indices seen;    ///< these and all within their reach, ascending
};

/** \brief Distance over which a voxel influences others after all updates, with or
 * without colours [m]. */
double crfReach(const SemanticCRFParameters& parameters, double voxel_size);

/** \brief A reach in blocks of 8 x 8 x 8 voxels, rounded up. */
int blocksWithin(double reach, double voxel_size);

/** \brief Returns the voxels without a result (VoxelCloud::is_refined) and their
 * surroundings, by whole blocks of 8 x 8 x 8.
 *
 * \param[in] reach [m] */
CrfRegion crfRegion(const VoxelCloud& voxels, double reach);

/** \brief Runs a CRF, whose model and parameters are set, over the `seen` voxels of a
 * region and writes the result to its `updated` voxels. */
void refineRegion(SemanticCRF<pcl::PointXYZRGBL>& crf, const LabelSet& label_set,
                  const CrfRegion& region, VoxelCloud& voxels);

} // namespace pcl_semantic
