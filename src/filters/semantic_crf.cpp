// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/filters/semantic_crf.h>

namespace pcl_semantic {

template class SemanticCRF<pcl::PointXYZL>;
template class SemanticCRF<pcl::PointXYZRGBL>;
template class SemanticCRF<pcl::PointXYZLNormal>;

} // namespace pcl_semantic
