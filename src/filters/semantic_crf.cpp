// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/filters/semantic_crf.h>

#include <pcl/point_types.h>

namespace pcl_semantic {

template class PCL_SEMANTIC_INSTANCE SemanticCRF<pcl::PointXYZL>;
template class PCL_SEMANTIC_INSTANCE SemanticCRF<pcl::PointXYZRGBL>;
template class PCL_SEMANTIC_INSTANCE SemanticCRF<pcl::PointXYZLNormal>;

} // namespace pcl_semantic
