// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/cliques/cube_cliques.h>
#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/label_distributions.h>
#include <pcl_semantic/core/label_set.h>
#include <pcl_semantic/files/data_folder.h>
#include <pcl_semantic/files/label_set_file.h>
#include <pcl_semantic/filters/semantic_crf.h>
#include <pcl_semantic/map/semantic_voxel_map.h>
#include <pcl_semantic/version.h>

#include <cmath>
#include <iostream>

/** \brief A point type of the user's own: a laser return with a label. */
struct LaserPoint {
  PCL_ADD_POINT4D;
  float range;
  std::uint32_t label;
  PCL_MAKE_ALIGNED_OPERATOR_NEW
};

POINT_CLOUD_REGISTER_POINT_STRUCT(LaserPoint,
                                  (float, x, x)(float, y, y)(float, z, z)(
                                      float, range, range)(std::uint32_t, label, label))

namespace ps = pcl_semantic;

namespace {

int failures = 0;

void
check(bool holds, const char* what)
{
  if (!holds) {
    std::cerr << "downstream: wrong: " << what << "\n";
    ++failures;
  }
}

void
checkDistributions()
{
  ps::LabelDistributions distributions(3, 2);
  distributions.setLabel(0, 2, 0.8f);
  distributions.matrix().col(1) << 2.0f, 1.0f, 1.0f;
  distributions.normalize();
  check(distributions.mapLabel(0) == 2, "label of the first point");
  check(distributions.mapLabel(1) == 1, "label of the second point");
  check(std::abs(distributions.matrix()(0, 1) - 0.5f) < 1e-6f, "normalised value");
}

// Exceptions and their types have to survive the border of the shared library.
void
checkErrors()
{
  try {
    ps::LabelSet({{"road", {}}, {"road", {}}});
    check(false, "a class name used twice was accepted");
  }
  catch (const ps::InvalidParameterException& error) {
    check(std::string(error.what()).find("road") != std::string::npos,
          "the message names the class");
  }
  try {
    ps::readLabelSet("no/such.yaml");
    check(false, "a label set that is not there was read");
  }
  catch (const pcl::PCLException& error) {
    check(dynamic_cast<const ps::BadInputException*>(&error) != nullptr,
          "PCL's exception is one of ours too");
  }
}

// They lie beside the library, not beside this program.
void
checkData()
{
  const std::string path = ps::findDataFile("label_sets/kitti11.yaml");
  check(ps::readLabelSet(path).size() == 11, "eleven classes of KITTI");
}

// A wall of points, all labelled 2 but one: into a map, and through the filter.
void
checkMapAndFilter()
{
  pcl::PointCloud<LaserPoint>::Ptr cloud(new pcl::PointCloud<LaserPoint>);
  for (int y = -5; y <= 5; ++y)
    for (int z = -5; z <= 5; ++z) {
      LaserPoint point{};
      point.getVector3fMap() << 4.05f, 0.1f * float(y) + 0.05f, 0.1f * float(z) + 0.05f;
      cloud->push_back(point);
    }
  ps::LabelDistributions labels(2, Eigen::Index(cloud->size()));
  for (Eigen::Index i = 0; i < labels.size(); ++i)
    labels.setLabel(i, i == 60 ? 1 : 2, 0.8f);

  ps::SemanticVoxelMap map(ps::LabelSet({{"road", {}}, {"wall", {}}}),
                           ps::SemanticVoxelMap::Parameters());
  map.integrate(*cloud, Eigen::Isometry3d::Identity(), labels);
  check(map.occupied().size() == cloud->size(), "a voxel a point");
  check(map.labels({{4.05, 0.15, 0.15}})[0] == 2, "label of a place in the map");
  check(map.occupancy({2.0, 0.0, 0.0}) == ps::Occupancy::free, "free space");

  ps::SemanticCRF<LaserPoint> crf;
  crf.setInputCloud(cloud);
  crf.setLabelDistributions(labels);
  pcl::PointCloud<LaserPoint> refined;
  crf.filter(refined);
  check(refined.size() == cloud->size(), "the filter keeps all points");
  check(refined[60].label == 2, "the odd one out takes the label of its neighbours");

  // The paper's model, from hard labels: cubes of half a metre as cliques.
  for (std::size_t i = 0; i < cloud->size(); ++i)
    (*cloud)[i].label = i == 60 ? 1 : 2;
  crf.setModel(ps::CRFModelType::hierarchical);
  crf.setCliqueGenerator(std::make_shared<ps::CubeCliques>(0.5));
  crf.setLabelConfidence(0.8, 2);
  crf.filter(*cloud); // in place
  check((*cloud)[60].label == 2, "and that of its clique");
  check(crf.getReport().cliques > 1, "there are cliques");
}

} // namespace

int
main()
{
  checkDistributions();
  checkErrors();
  checkData();
  checkMapAndFilter();
  std::cout << "downstream of pcl_semantic " << PCL_SEMANTIC_VERSION << ": "
            << (failures == 0 ? "works" : "fails") << "\n";
  return failures == 0 ? 0 : 1;
}
