// SPDX-License-Identifier: BSD-3-Clause

// 05: a clique generator of your own, for the hierarchical model.
//
// Points in one column above the ground probably belong to one object. The cloud is a
// square of ground with thin poles; a third of the labels on the poles is wrong.

#include <pcl_semantic/cliques/clique_generator.h>
#include <pcl_semantic/filters/semantic_crf.h>

#include <pcl/common/point_tests.h>

#include <cmath>
#include <iostream>
#include <map>
#include <random>

using namespace pcl_semantic;

namespace {

// One clique for each column of 0.3 m x 0.3 m: its points higher than 0.3 m.
class ColumnCliques : public CliqueGenerator {
public:
  std::vector<pcl::PointIndices>
  generate(const Cloud& cloud) override
  {
    std::map<std::pair<float, float>, pcl::PointIndices> columns;
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      const pcl::PointXYZRGB& point = cloud[i];
      if (pcl::isFinite(point) && point.z > 0.3f)
        columns[{std::floor(point.x / 0.3f), std::floor(point.y / 0.3f)}]
            .indices.push_back(pcl::index_t(i));
    }
    std::vector<pcl::PointIndices> cliques;
    for (const auto& [position, members] : columns)
      cliques.push_back(members);
    return cliques;
  }
};

using Cloud = pcl::PointCloud<pcl::PointXYZL>;
const std::uint32_t ground = 1, pole = 2, sign = 3;

Cloud::Ptr
polesOnGround()
{
  Cloud::Ptr cloud(new Cloud);
  std::mt19937 random(1);
  for (int x = 0; x < 60; ++x)
    for (int y = 0; y < 60; ++y)
      for (int z = 0; z < (x % 15 == 7 && y % 15 == 7 ? 60 : 1); ++z)
        cloud->emplace_back(0.1f * float(x), 0.1f * float(y), 0.05f * float(z),
                            z == 0              ? ground
                            : random() % 3 == 0 ? sign
                                                : pole);
  return cloud;
}

void
print(const char* what, const Cloud& cloud)
{
  std::size_t wrong = 0;
  for (const pcl::PointXYZL& point : cloud)
    wrong += point.label != (point.z > 0.0f ? pole : ground);
  std::cout << what << ": " << wrong << " of " << cloud.size() << " wrong\n";
}

} // namespace

int
main(int, char** argv)
try {
  const Cloud::Ptr cloud = polesOnGround();
  print("measured", *cloud);
  SemanticCRF<pcl::PointXYZL> crf;
  crf.setInputCloud(cloud);
  crf.setLabelConfidence(0.7, int(sign));
  Cloud refined;
  crf.filter(refined);
  print("dense", refined);

  SemanticCRFParameters parameters = crf.getParameters();
  parameters.iterations = 5;          // several messages between cliques and points
  parameters.clique_truncation = 0.5; // tolerated fraction of other labels
  crf.setParameters(parameters);
  crf.setModel(CRFModelType::hierarchical);
  crf.setCliqueGenerator(std::make_shared<ColumnCliques>());
  crf.filter(refined);
  print("with columns", refined);
  std::cout << crf.getReport().cliques << " cliques\n";
}
catch (const std::exception& error) {
  std::cerr << argv[0] << ": " << error.what() << "\n";
  return 1;
}
