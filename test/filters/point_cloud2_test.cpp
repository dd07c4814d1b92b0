// SPDX-License-Identifier: BSD-3-Clause

// The filters over clouds whose fields are known by name.

#include "support/plain_cloud_crf.h"
#include "support/thrown_message.h"

#include <pcl_semantic/clouds/point_cloud2.h>
#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/files/cloud_file.h>
#include <pcl_semantic/filters/label_voxel_grid.h>
#include <pcl_semantic/filters/semantic_crf.h>

#include <pcl/conversions.h>
#include <pcl/filters/extract_indices.h>

#include <cstring>

namespace {

using namespace pcl_semantic;
using Blob = pcl::PCLPointCloud2;
using Cloud = pcl::PointCloud<pcl::PointXYZRGBL>;

// x y z rgba label of a cloud with further fields; `probability` if there are classes.
Blob::Ptr
blobOf(const CrfCloud& cloud, bool with_probability)
{
  Blob typed;
  pcl::toPCLPointCloud2(*cloud.cloud, typed);
  PcdTable table(typed);
  std::vector<float> intensity;
  std::vector<std::uint32_t> clique;
  for (std::size_t i = 0; i < table.points(); ++i) {
    intensity.push_back(0.5f * float(i));
    clique.push_back(std::uint32_t(i % 40));
  }
  table.setColumn("intensity", intensity);
  table.setColumn("clique", clique);
  if (with_probability) {
    const auto& matrix = cloud.distributions.matrix();
    table.setColumn("probability",
                    std::vector<float>(matrix.data(), matrix.data() + matrix.size()),
                    4);
  }
  Blob::Ptr blob(new Blob(table));
  blob->header.frame_id = "lidar";
  blob->header.stamp = 7;
  return blob;
}

std::vector<double>
valuesOf(const Blob& blob, const std::string& name, int element = 0)
{
  const PcdTable table(blob);
  const PcdColumn column(table, table.find(name));
  std::vector<double> values;
  for (std::size_t i = 0; i < table.points(); ++i)
    values.push_back(column(i, element));
  return values;
}

Blob
thinned(const Blob::Ptr& blob, double leaf_size)
{
  LabelVoxelGrid grid;
  grid.setLeafSize(leaf_size);
  grid.setInputCloud(blob);
  Blob output;
  grid.filter(output);
  return output;
}

CrfCloud
labelledCloud()
{
  CrfCloud cloud = makeCrfCloud(400, 3);
  for (std::size_t i = 0; i < cloud.cloud->size(); ++i)
    (*cloud.cloud)[i].label = cloud.distributions.mapLabel(Eigen::Index(i));
  return cloud;
}

} // namespace

TEST(PointCloud2Filters, ReadMeasurementsAndCliquesOfTheirFields)
{
  const CrfCloud cloud = labelledCloud();
  const Blob::Ptr blob = blobOf(cloud, true);
  CrfFilter expected;
  expected.setModel(CRFModelType::hierarchical);
  std::vector<pcl::PointIndices> cliques(39);
  for (int i = 0; i < 400; ++i)
    if (i % 40 != 0)
      cliques[std::size_t(i % 40 - 1)].indices.push_back(i);
  expected.setCliques(cliques);
  Cloud refined;
  const Eigen::MatrixXf probabilities = refine(expected, cloud, &refined);

  SemanticCRF<Blob> crf;
  crf.setModel(CRFModelType::hierarchical);
  crf.setInputCloud(blob);
  Blob output;
  for (int run = 0; run < 2; ++run) { // each takes what its own cloud has
    crf.filter(output);
    const std::vector<double> labels = valuesOf(output, "label");
    int changed = 0;
    for (std::size_t i = 0; i < labels.size(); ++i) {
      ASSERT_EQ(labels[i], refined[i].label);
      changed += refined[i].label != (*cloud.cloud)[i].label;
    }
    EXPECT_GT(changed, 0);
  }
  for (int k = 0; k < 4; ++k) {
    const std::vector<double> probability = valuesOf(output, "probability", k);
    for (Eigen::Index i = 0; i < 400; ++i)
      ASSERT_EQ(probability[std::size_t(i)], probabilities(k, i));
  }
  EXPECT_EQ(valuesOf(output, "intensity"), valuesOf(*blob, "intensity"));
  EXPECT_EQ(output.header.frame_id, "lidar");
  EXPECT_EQ(output.header.stamp, 7u);
  Blob::Ptr in_place(new Blob(*blob));
  crf.setInputCloud(in_place);
  crf.filter(*in_place);
  EXPECT_EQ(in_place->data, output.data);
  EXPECT_EQ(in_place->point_step, output.point_step);
}

TEST(PointCloud2Filters, ChangeTheLabelsOfTheirIndicesInPclsOwnLayout)
{
  const CrfCloud cloud = labelledCloud();
  Blob::Ptr blob(new Blob);
  pcl::toPCLPointCloud2(*cloud.cloud, *blob); // with padding
  SemanticCRF<pcl::PointXYZRGBL> expected;
  SemanticCRF<Blob> crf;
  const auto indices = pcl::make_shared<pcl::Indices>(allIndices(200));
  expected.setLabelConfidence(0.8, 4);
  crf.setLabelConfidence(0.8, 4);
  expected.setInputCloud(cloud.cloud);
  crf.setInputCloud(blob);
  expected.setIndices(indices);
  crf.setIndices(indices);
  Cloud refined, typed;
  expected.filter(refined);
  Blob output;
  crf.filter(output);
  pcl::fromPCLPointCloud2(output, typed);
  for (std::size_t i = 0; i < 400; ++i)
    ASSERT_EQ(typed[i].label, refined[i].label);
  EXPECT_TRUE(crf.getRemovedIndices()->empty());
}

// What makes cliques of an image finds its rows.
TEST(PointCloud2Filters, GiveGeneratorsAnOrganizedCloud)
{
  struct Watcher : CliqueGenerator {
    std::vector<pcl::PointIndices>
    generate(const CliqueGenerator::Cloud& cloud) override
    {
      width = cloud.width;
      height = cloud.height;
      return {};
    }

    std::uint32_t width = 0, height = 0;
  };
  const CrfCloud cloud = labelledCloud();
  cloud.cloud->width = 40;
  cloud.cloud->height = 10;
  Blob::Ptr blob(new Blob);
  pcl::toPCLPointCloud2(*cloud.cloud, *blob);
  const auto watcher = std::make_shared<Watcher>();
  SemanticCRF<Blob> crf;
  crf.setModel(CRFModelType::hierarchical);
  crf.setLabelConfidence(0.8, 4);
  crf.setInputCloud(blob);
  crf.setCliqueGenerator(watcher);
  Blob output;
  crf.filter(output);
  EXPECT_EQ(watcher->width, 40u);
  EXPECT_EQ(watcher->height, 10u);
}

TEST(PointCloud2Filters, RefuseCloudsThatLackAField)
{
  const Blob::Ptr blob = blobOf(labelledCloud(), false);
  SemanticCRF<Blob> crf;
  crf.setInputCloud(blob);
  Blob output;
  expectBadParameter("has no field 'probability'", [&] { crf.filter(output); });
  for (pcl::PCLPointField& field : blob->fields)
    if (field.name == "label")
      field.name = "kind";
  expectBadParameter("has no field 'label'", [&] { crf.filter(output); });
}

TEST(LabelVoxelGrid, KeepsThePointNearestToTheMeanWithTheMostFrequentLabel)
{
  Cloud cloud;
  const auto add = [&](float x, std::uint32_t label) {
    pcl::PointXYZRGBL point;
    point.x = x;
    point.y = point.z = 0.05f;
    point.label = label;
    cloud.push_back(point);
  };
  add(1.01f, 3); // of the second voxel
  add(0.01f, 1);
  add(0.05f, 3);
  add(0.09f, 3);
  add(1.02f, 0);
  add(2.05f, 2); // a tie with 1
  add(2.06f, 1);
  add(std::numeric_limits<float>::quiet_NaN(), 5);
  Blob::Ptr blob(new Blob);
  pcl::toPCLPointCloud2(cloud, *blob);
  const Blob output = thinned(blob, 0.1);
  Cloud thin;
  pcl::fromPCLPointCloud2(output, thin);
  ASSERT_EQ(thin.size(), 3u);
  EXPECT_EQ(output.row_step, 3 * output.point_step);
  EXPECT_EQ(output.data.size(), output.row_step);
  EXPECT_EQ(thin[0].x, 0.05f);
  EXPECT_EQ(thin[0].label, 3u);
  EXPECT_EQ(thin[1].label, 3u); // 0 is no measurement
  EXPECT_EQ(thin[2].label, 1u);
}

TEST(LabelVoxelGrid, TakesTheMeanOfProbabilities)
{
  CrfCloud cloud = makeCrfCloud(2, 1);
  cloud.distributions.matrix() << 0.6f, 0.0f, 0.4f, 0.5f, 0.0f, 0.5f, 0.0f, 0.0f;
  for (pcl::PointXYZRGBL& point : *cloud.cloud) {
    point.getVector3fMap().setConstant(0.01f);
    point.label = 1;
  }
  const Blob output = thinned(blobOf(cloud, true), 0.1);
  EXPECT_EQ(valuesOf(output, "label"), std::vector<double>{2});
  EXPECT_NEAR(valuesOf(output, "probability", 1)[0], 0.45, 1e-6);
}

TEST(LabelVoxelGrid, RefusesASizeThatCannotBe)
{
  LabelVoxelGrid grid;
  EXPECT_THROW(grid.setLeafSize(0.0), InvalidParameterException);
  grid.setInputCloud(blobOf(labelledCloud(), false));
  Blob output;
  EXPECT_THROW(grid.filter(output), InvalidParameterException);
  grid.setLeafSize(1e-12);
  expectBadParameter("take larger ones", [&] { grid.filter(output); });
}

// What pcl::ExtractIndices leaves of a cloud if it takes no point: with or without
// fields, without a size of its points.
TEST(PointCloud2Filters, GiveNothingOfNothing)
{
  const CrfCloud cloud = labelledCloud();
  const Blob::Ptr whole = blobOf(cloud, true);
  pcl::ExtractIndices<Blob> extract;
  extract.setInputCloud(whole);
  extract.setIndices(pcl::make_shared<pcl::Indices>());
  const Blob::Ptr extracted(new Blob), no_size(new Blob(*whole)), no_fields(new Blob),
      no_rows(new Blob(*whole));
  extract.filter(*extracted);
  no_size->width = no_size->height = no_size->point_step = no_size->row_step = 0;
  no_size->data.clear();
  no_rows->height = 0;
  no_rows->data.clear();
  for (const Blob::Ptr& empty : {extracted, no_size, no_fields, no_rows}) {
    SCOPED_TRACE(empty->fields.size());
    SemanticCRF<Blob> crf;
    LabelVoxelGrid grid;
    grid.setLeafSize(0.1);
    crf.setModel(CRFModelType::hierarchical);
    for (const Blob::Ptr& each : {whole, empty, whole}) { // as frames come
      Blob refined, thin;
      crf.setInputCloud(each);
      crf.filter(refined);
      grid.setInputCloud(each);
      grid.filter(thin);
      const bool is_whole = each == whole;
      EXPECT_EQ(refined.width * refined.height, is_whole ? 400u : 0u);
      EXPECT_EQ(thin.width * thin.height > 0, is_whole);
      EXPECT_EQ(refined.fields.size(), each->fields.size());
      EXPECT_EQ(crf.getLabelDistributions().size(), is_whole ? 400 : 0);
      EXPECT_EQ(crf.getSkippedPoints(), 0u);
    }
    const PcdTable table(*empty);
    EXPECT_EQ(table.points(), 0u);
    EXPECT_EQ(table.fields.size(), empty->fields.size());
    EXPECT_EQ(labelledCloudOf(table, "cloud").cloud->size(), 0u);
  }
  VoxelCloud voxels;
  Blob blob;
  toPCLPointCloud2(voxels, blob);
  for (const Blob& empty : {blob, Blob()}) {
    fromPCLPointCloud2(empty, voxels);
    EXPECT_EQ(voxels.size(), 0u);
  }
}

// One point at 0 0 0 may be real; several are a scanner's no-returns.
TEST(PointCloud2Filters, PassOverNoReturns)
{
  for (const std::size_t zeros : {1u, 2u, 40u}) {
    CrfCloud scan = labelledCloud();
    for (pcl::PointXYZRGBL& point : *scan.cloud)
      point.getVector3fMap().array() += 1.0f;
    for (std::size_t i = 0; i < zeros; ++i) {
      (*scan.cloud)[i].getVector3fMap().setZero();
      (*scan.cloud)[i].label = 2;
    }
    const Blob::Ptr blob = blobOf(scan, true);
    SemanticCRF<Blob> crf;
    crf.setInputCloud(blob);
    Blob refined;
    crf.filter(refined);
    EXPECT_EQ(crf.getSkippedPoints(), zeros > 1 ? zeros : 0u);
    const std::vector<double> labels = valuesOf(refined, "label");
    for (std::size_t i = 0; zeros > 1 && i < zeros; ++i)
      EXPECT_EQ(labels[i], 2.0) << "stays as it was";
    // The others are as if there were no such points.
    SemanticCRF<Blob> without;
    without.setInputCloud(blob);
    const auto rest = pcl::make_shared<pcl::Indices>();
    for (std::size_t i = zeros > 1 ? zeros : 0; i < 400; ++i)
      rest->push_back(pcl::index_t(i));
    without.setIndices(rest);
    Blob expected;
    without.filter(expected);
    EXPECT_EQ(refined.data, expected.data);

    const Blob thin = thinned(blob, 1e-3);
    std::size_t at_zero = 0;
    for (std::size_t i = 0; i < thin.width; ++i)
      at_zero += valuesOf(thin, "x")[i] == 0.0 && valuesOf(thin, "y")[i] == 0.0;
    EXPECT_EQ(at_zero, zeros == 1 ? 1u : 0u);
  }
}

TEST(PointCloud2Filters, RowsNeedTheirSize)
{
  const Blob::Ptr blob = blobOf(labelledCloud(), false);
  const Blob packed = *blob;
  blob->row_step = 0; // some drivers set none
  EXPECT_EQ(PcdTable(*blob).data, PcdTable(packed).data);
  blob->height = 2;
  blob->width = 200;
  expectBadParameter("row_step is 0, expected at least",
                     [&] { PcdTable table(*blob); });
  Blob nothing; // the product of its size is 0 in 64 bits
  nothing.width = nothing.height = 1u << 31;
  for (const pcl::uindex_t step : {0u, 1u << 31}) {
    nothing.point_step = nothing.row_step = step;
    EXPECT_TRUE(holds(
        thrownMessage<InvalidParameterException>([&] { PcdTable table(nothing); }),
        "cloud: "))
        << step;
  }
}

// The upper 16 bits of a label are an instance.
TEST(SemanticCRF, TakesInstancesOff)
{
  CrfCloud cloud = labelledCloud();
  Cloud expected, refined;
  for (Cloud* const output : {&expected, &refined}) {
    SemanticCRF<pcl::PointXYZRGBL> crf;
    crf.setInputCloud(cloud.cloud);
    crf.setLabelConfidence(0.8, 4);
    crf.filter(*output);
    for (pcl::PointXYZRGBL& point : *cloud.cloud)
      point.label |= 9u << 16;
  }
  for (std::size_t i = 0; i < expected.size(); ++i)
    EXPECT_EQ(refined[i].label, expected[i].label);
}

TEST(SemanticCRF, GivesNothingOfNothing)
{
  CrfFilter crf;
  CrfCloud empty = labelledCloud(); // with the distributions of a frame before, or none
  for (const int classes : {0, 4}) {
    empty.cloud = pcl::make_shared<Cloud>();
    if (classes > 0)
      empty.distributions = LabelDistributions(classes, 0);
    Cloud output;
    output.resize(3);
    EXPECT_EQ(refine(crf, empty, &output).cols(), 0);
    EXPECT_TRUE(output.empty());
  }
}
