// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/label_set.h>
#include <pcl_semantic/map/ray_caster.h>
#include <pcl_semantic/map/voxel_fusion.h>

namespace pcl_semantic {

/** \brief Takes FusionParameters::dynamic_decay off every occupied voxel of the window
 * whose MAP label is of a dynamic class. */
void decayDynamicVoxels(const LabelSet& label_set, const FusionParameters& fusion,
                        RayCaster::Grid& grid);

} // namespace pcl_semantic
