// SPDX-License-Identifier: BSD-3-Clause

// Fields and labels that filters over clouds could misread: rewritten as they are, or
// refused.

#include "support/thrown_message.h"

#include <pcl_semantic/cliques/cube_cliques.h>
#include <pcl_semantic/clouds/pcd_table.h>
#include <pcl_semantic/clouds/point_cloud2.h>
#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/filters/label_voxel_grid.h>
#include <pcl_semantic/filters/semantic_crf.h>

#include <pcl/common/io.h>

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <limits>

/** \brief Points whose labels are floats, as CloudCompare has them, or have a sign. */
struct FloatLabelPoint {
  float x, y, z;
  float label;
};

struct SignedLabelPoint {
  float x, y, z;
  std::int16_t label;
};

POINT_CLOUD_REGISTER_POINT_STRUCT(FloatLabelPoint,
                                  (float, x, x)(float, y, y)(float, z, z)(float, label,
                                                                          label))
POINT_CLOUD_REGISTER_POINT_STRUCT(SignedLabelPoint,
                                  (float, x, x)(float, y, y)(float, z, z)(std::int16_t,
                                                                          label, label))

namespace {

using namespace pcl_semantic;
using Blob = pcl::PCLPointCloud2;
using Type = pcl::PCLPointField;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr int edge = 20, classes = 3;

struct Field {
  std::string name;
  int type;
  int count = 1;
};

using Fields = std::vector<Field>;

void
put(double value, int type, std::uint8_t* to)
{
  const auto as = [&](auto zero) {
    const auto number = decltype(zero)(value);
    std::memcpy(to, &number, sizeof(number));
  };
  type == Type::UINT8     ? as(std::uint8_t())
  : type == Type::INT32   ? as(std::int32_t())
  : type == Type::UINT32  ? as(std::uint32_t())
  : type == Type::FLOAT32 ? as(float())
                          : as(double());
}

double
get(const Blob& blob, std::size_t point, const std::string& name, int element = 0)
{
  const PcdTable table(blob);
  return PcdColumn(table, table.find(name))(point, element);
}

// Two halves of 1 and 2, with points of 3 among them, as all that is known of labels.
int
labelOf(std::size_t point)
{
  return point % 37 == 0 ? 3 : point % edge < edge / 2 ? 1 : 2;
}

using Value = std::function<double(const Field&, std::size_t point, int element)>;

// A square of points with x y z and other fields, whose values are given.
Blob::Ptr
blobOf(const Fields& more, const Value& value)
{
  Fields fields{{"x", Type::FLOAT32}, {"y", Type::FLOAT32}, {"z", Type::FLOAT32}};
  fields.insert(fields.end(), more.begin(), more.end());
  const Blob::Ptr blob(new Blob);
  for (const Field& field : fields) {
    Type to;
    to.name = field.name;
    to.datatype = std::uint8_t(field.type);
    to.count = pcl::uindex_t(field.count);
    to.offset = blob->point_step;
    blob->point_step += pcl::uindex_t(field.count * pcl::getFieldSize(field.type));
    blob->fields.push_back(to);
  }
  blob->width = blob->height = edge;
  blob->row_step = blob->width * blob->point_step;
  blob->data.resize(std::size_t(blob->row_step) * blob->height);
  std::uint8_t* to = blob->data.data();
  for (std::size_t i = 0; i < edge * edge; ++i)
    for (const Field& field : fields)
      for (int k = 0; k < field.count; ++k, to += pcl::getFieldSize(field.type)) {
        const auto column = double(i % edge), row = double(i / edge);
        put(field.name == "x"   ? 0.1 * column + 0.03
            : field.name == "y" ? 0.1 * row + 0.03
            : field.name == "z" ? 0.5
                                : value(field, i, k),
            field.type, to);
      }
  return blob;
}

// Labels alone, with one that is different.
Blob::Ptr
withOneLabel(const Field& label, double other)
{
  return blobOf({label}, [&](const Field&, std::size_t i, int) {
    return i == 5 ? other : labelOf(i);
  });
}

void
runCrf(const Blob::Ptr& blob, Blob& output)
{
  SemanticCRF<Blob> crf;
  crf.setLabelConfidence(0.8, classes);
  crf.setInputCloud(blob);
  crf.filter(output);
}

void
runGrid(const Blob::Ptr& blob, Blob& output)
{
  LabelVoxelGrid grid;
  grid.setLeafSize(0.2);
  grid.setInputCloud(blob);
  grid.filter(output);
}

template <typename Point>
typename pcl::PointCloud<Point>::Ptr
typedCloud()
{
  const typename pcl::PointCloud<Point>::Ptr cloud(
      new pcl::PointCloud<Point>(edge, edge));
  for (std::size_t i = 0; i < cloud->size(); ++i) {
    (*cloud)[i].x = 0.1f * float(i % edge) + 0.03f;
    (*cloud)[i].y = 0.1f * float(i / edge) + 0.03f;
    (*cloud)[i].z = 0.5f;
    (*cloud)[i].label = decltype((*cloud)[i].label)(labelOf(i));
  }
  return cloud;
}

// A cloud of one odd label among measured ones.
template <typename Point>
std::string
complaintOf(double odd)
{
  const auto cloud = typedCloud<Point>();
  (*cloud)[5].label = decltype((*cloud)[5].label)(odd);
  SemanticCRF<Point> crf;
  crf.setLabelConfidence(0.8, classes);
  crf.setInputCloud(cloud);
  pcl::PointCloud<Point> output;
  return thrownMessage<BadInputException>([&] { crf.filter(output); });
}

} // namespace

// Whatever the field is called, all labels would become 0.
TEST(UnfitFields, LabelsThatAreNotUnderstoodAreRefused)
{
  struct Case {
    Field field;
    double value;
    std::string complaint;
  };
  for (const Case& each :
       std::vector<Case>{{{"semantic", Type::INT32}, -1, "not all are 0 to 255"},
                         {{"class", Type::INT32}, 300, "not all are 0 to 255"},
                         {{"scalar_Label", Type::FLOAT32}, kNaN, "whole numbers"},
                         {{"Label", Type::UINT32, 2}, 1, "they have COUNT 1"},
                         {{"label", Type::INT32}, -1, "'label' of point 5 is -1"},
                         {{"label", Type::UINT32, 2}, 1, "COUNT 2"}}) {
    const Blob::Ptr blob = withOneLabel(each.field, each.value);
    const std::vector<std::uint8_t> before = blob->data;
    for (const auto run : {runCrf, runGrid}) {
      const std::string complaint =
          thrownMessage<BadInputException>([&] { run(blob, *blob); });
      EXPECT_TRUE(holds(complaint, each.complaint)) << complaint;
      EXPECT_TRUE(holds(complaint, "field '" + each.field.name + "'")) << complaint;
      EXPECT_TRUE(blob->data == before);
    }
  }
  for (const char* const name : {"label", "semantic", "Label", "scalar_class"}) {
    Blob output;
    runCrf(withOneLabel({name, Type::INT32}, 1), output);
    EXPECT_EQ(get(output, 0, name), 1.0) << "as its neighbours are";
  }
}

// Single precision holds 24 bits: of class 1 of instance 300 the class is lost.
TEST(UnfitFields, FloatsThatLostTheClassBesideTheInstanceAreRefused)
{
  const double small = 65536.0 * 200.0, large = 65536.0 * 300.0;
  for (const char* const name : {"label", "scalar_Label"})
    for (const int type : {int(Type::FLOAT32), int(Type::FLOAT64), int(Type::INT32)}) {
      const auto instancesFrom = [&](double first) {
        return blobOf({{name, type}}, [&](const Field&, std::size_t i, int) {
          return labelOf(i) + first;
        });
      };
      Blob expected, refined;
      runCrf(instancesFrom(0), expected);
      runCrf(instancesFrom(small), refined);
      EXPECT_EQ(refined.data, expected.data);
      for (const auto run : {runCrf, runGrid}) {
        const std::string complaint =
            type != Type::FLOAT32 ? (run(instancesFrom(large), refined), std::string())
                                  : thrownMessage<BadInputException>(
                                        [&] { run(instancesFrom(large), refined); });
        EXPECT_EQ(holds(complaint, "single precision"), type == Type::FLOAT32);
      }
    }
  EXPECT_TRUE(holds(complaintOf<FloatLabelPoint>(large + 1), "single precision"));
}

TEST(UnfitFields, TypedLabelsThatAreNoneAreNamed)
{
  for (const double odd : {1.5, -1.0, kNaN, 300.0, 4.0})
    EXPECT_TRUE(holds(complaintOf<FloatLabelPoint>(odd), "point 5 has the label"))
        << odd;
  EXPECT_TRUE(holds(complaintOf<SignedLabelPoint>(-1), "point 5 has the label -1"));
  // Where they are no measurements, they are only written.
  const auto cloud = typedCloud<FloatLabelPoint>();
  LabelDistributions measured(classes, edge * edge);
  for (int i = 0; i < edge * edge; ++i)
    measured.setLabel(i, Label(labelOf(std::size_t(i))), 0.8f);
  (*cloud)[5].label = float(kNaN);
  SemanticCRF<FloatLabelPoint> crf;
  crf.setLabelDistributions(measured);
  crf.setInputCloud(cloud);
  pcl::PointCloud<FloatLabelPoint> output;
  crf.filter(output);
  EXPECT_EQ(output[5].label, 1.0f);
}

// In their own type and spelling.
TEST(UnfitFields, ProbabilitiesAreRewrittenAsTheyAre)
{
  const auto value = [](const Field& field, std::size_t i, int element) {
    if (field.name == "label")
      return double(labelOf(i));
    const int k = field.count > 1 ? element : field.name.back() - '0';
    return k + 1 == labelOf(i) ? 0.8 : 0.1;
  };
  const Field label{"label", Type::UINT32};
  for (const Fields& fields : {Fields{label, {"probability", Type::FLOAT32, 3}},
                               Fields{label, {"probability", Type::FLOAT64, 3}},
                               Fields{{"softmax", Type::FLOAT32, 3}, label},
                               Fields{{"prob_0", Type::FLOAT32},
                                      {"prob_2", Type::FLOAT64},
                                      {"prob_1", Type::FLOAT32},
                                      label}}) {
    const std::string name =
        fields[0].name == "label" ? fields[1].name : fields[0].name;
    SCOPED_TRACE(name);
    const Blob::Ptr blob = blobOf(fields, value);
    const auto probability = [&](const Blob& cloud, std::size_t i, int k) {
      return name == "prob_0" ? get(cloud, i, "prob_" + std::to_string(k))
                              : get(cloud, i, name, k);
    };
    SemanticCRF<Blob> crf;
    crf.setInputCloud(blob);
    Blob refined, thin;
    crf.filter(refined);
    for (int i = 0; i < edge * edge; ++i)
      for (int k = 0; k < classes; ++k)
        ASSERT_EQ(probability(refined, std::size_t(i), k),
                  double(crf.getLabelDistributions().matrix()(k, i)));
    EXPECT_EQ(get(refined, 0, "label"), 1.0);
    runGrid(blob, thin);
    // Of the four points of the first voxel one has label 3.
    EXPECT_NEAR(probability(thin, 0, 0), 0.625, 1e-6);
    EXPECT_NEAR(probability(thin, 0, 2), 0.275, 1e-6);
    // There is no room for the classes of other measurements.
    crf.setLabelConfidence(0.8, 5);
    expectBadParameter("the field '" + name + "' holds 3 classes, and the result has 5",
                       [&] { crf.filter(refined); });
  }
  const Blob::Ptr whole =
      blobOf({label, {"probability", Type::UINT8, 3}},
             [](const Field& field, std::size_t i, int k) {
               return field.count == 1 ? labelOf(i) : k + 1 == labelOf(i);
             });
  Blob output;
  expectBadParameter("cannot hold probabilities", [&] { runGrid(whole, output); });
}

TEST(UnfitFields, ThoseThatAreNotUsedMayHoldAnything)
{
  const Blob::Ptr blob = blobOf(
      {{"label", Type::UINT32},
       {"clique", Type::INT32},
       {"rgb", Type::UINT32},
       {"rgba", Type::UINT32}},
      [](const Field& field, std::size_t i, int) {
        return field.name == "label" ? labelOf(i) : field.name == "clique" ? -1.0 : 7.0;
      });
  Blob refined, thin;
  runGrid(blob, thin);
  EXPECT_EQ(thin.width, 100u);
  SemanticCRF<Blob> crf;
  crf.setLabelConfidence(0.8, classes);
  crf.setInputCloud(blob);
  EXPECT_THROW(crf.filter(refined), BadInputException) << "which colour?";
  crf.setUseColour(false);
  crf.filter(refined);
  EXPECT_EQ(get(refined, 5, "clique"), -1.0);
  crf.setModel(CRFModelType::hierarchical);
  EXPECT_THROW(crf.filter(refined), BadInputException);
}

TEST(UnfitFields, AModelOfCliquesNeedsSome)
{
  const Blob::Ptr blob = withOneLabel({"label", Type::UINT32}, 1);
  SemanticCRF<Blob> crf;
  crf.setModel(CRFModelType::hierarchical);
  crf.setLabelConfidence(0.8, classes);
  crf.setInputCloud(blob);
  Blob output;
  expectBadParameter("needs cliques", [&] { crf.filter(output); });
}

// The cells of cliques lie the same whatever was taken off the positions.
TEST(UnfitFields, TheOriginOfABlobMovesTheCellsOfCliques)
{
  const auto cliquesAt = [&](double shift) {
    const Blob::Ptr blob = withOneLabel({"label", Type::UINT32}, 1);
    for (std::size_t i = 0; i < edge * edge; ++i)
      put(get(*blob, i, "x") - shift, Type::FLOAT32, &blob->data[i * blob->point_step]);
    SemanticCRF<Blob> crf;
    crf.setModel(CRFModelType::hierarchical);
    crf.setLabelConfidence(0.8, classes);
    crf.setCliqueGenerator(std::make_shared<CubeCliques>(0.5));
    crf.setOrigin({shift, 0, 0});
    crf.setInputCloud(blob);
    Blob output;
    crf.filter(output);
    return crf.getReport().cliques;
  };
  EXPECT_EQ(cliquesAt(0.25), cliquesAt(0.0));
  EXPECT_THROW(SemanticCRF<Blob>().setOrigin({kNaN, 0, 0}), InvalidParameterException);
}

// As points.push_back() leaves a cloud.
TEST(UnfitFields, AGeneratorNeedsTheSizeOfTheCloud)
{
  const auto cloud = typedCloud<pcl::PointXYZL>();
  SemanticCRF<pcl::PointXYZL> crf;
  crf.setModel(CRFModelType::hierarchical);
  crf.setLabelConfidence(0.8, classes);
  crf.setCliqueGenerator(std::make_shared<CubeCliques>(0.5));
  crf.setInputCloud(cloud);
  pcl::PointCloud<pcl::PointXYZL> output;
  for (const std::uint32_t width : {0u, 7u, 400u}) {
    cloud->width = width;
    cloud->height = edge;
    expectBadParameter("a width of " + std::to_string(width) +
                           " and a height of 20, but 400 points",
                       [&] { crf.filter(output); });
  }
  cloud->width = edge;
  crf.filter(output);
  EXPECT_EQ(crf.getReport().cliques, 16u);
}

// Two clouds of one fleet, joined as messages.
TEST(UnfitFields, VoxelsAreOfOneMap)
{
  const auto voxelsAt = [](double x, double size) {
    VoxelCloud voxels;
    voxels.voxel_size = size;
    voxels.origin.x() = x;
    for (int i = 0; i < 5; ++i) {
      voxels.indices.emplace_back(i, 0, 0);
      voxels.observations.push_back(3);
      voxels.cloud->emplace_back();
      voxels.cloud->back().label = 1;
    }
    voxels.refined = LabelDistributions(classes, 5);
    voxels.refined.matrix().row(0).setOnes();
    voxels.measured = voxels.refined;
    Blob blob;
    toPCLPointCloud2(voxels, blob);
    return blob;
  };
  const auto complaint = [](const Blob& blob) {
    VoxelCloud voxels;
    return thrownMessage<BadInputException>([&] { fromPCLPointCloud2(blob, voxels); });
  };
  const auto joined = [&](double x, double size) {
    Blob blob = voxelsAt(0, 0.1);
    const Blob other = voxelsAt(x, size);
    blob.data.insert(blob.data.end(), other.data.begin(), other.data.end());
    blob.width += other.width;
    blob.row_step += other.row_step;
    return blob;
  };
  VoxelCloud voxels;
  fromPCLPointCloud2(joined(0, 0.1), voxels);
  EXPECT_EQ(voxels.size(), 10u);
  EXPECT_TRUE(holds(complaint(joined(7e5, 0.1)), "voxel 5 has the origin 700000 0 0"));
  EXPECT_TRUE(holds(complaint(joined(0, 0.2)), "voxel 5 has the size 0.2 m"));
  struct Case {
    std::string field;
    double value;
    int type;
  };
  for (const Case& each : std::vector<Case>{{"voxel_size", -1, Type::FLOAT64},
                                            {"voxel_size", kNaN, Type::FLOAT64},
                                            {"origin", kNaN, Type::FLOAT64},
                                            {"label", 300, Type::UINT32},
                                            {"label", 4, Type::UINT32},
                                            {"probability", kNaN, Type::FLOAT32},
                                            {"measured", -0.5, Type::FLOAT32}}) {
    Blob blob = voxelsAt(0, 0.1);
    const auto field = std::size_t(pcl::getFieldIndex(blob, each.field));
    put(each.value, each.type, &blob.data[blob.fields[field].offset]);
    EXPECT_TRUE(holds(complaint(blob), "field '" + each.field + "' of voxel 0"));
  }
}

TEST(UnfitFields, ARowBeyondTheDataIsNamed)
{
  const Blob::Ptr blob = withOneLabel({"label", Type::UINT32}, 1);
  blob->row_step = 1 << 20;
  Blob output;
  expectBadParameter("row_step is 1048576, too large", [&] { runGrid(blob, output); });
}

TEST(LabelVoxelGrid, PassesOverAPointFarOffAndCountsEachOnce)
{
  const Blob::Ptr blob =
      blobOf({{"label", Type::UINT32}},
             [](const Field&, std::size_t i, int) { return i == 0 ? 2 : 1; });
  put(1e30, Type::FLOAT32, &blob->data[5 * blob->point_step]);
  Blob output;
  runGrid(blob, output);
  EXPECT_EQ(output.width, 100u);
  LabelVoxelGrid grid;
  grid.setLeafSize(10.0);
  grid.setInputCloud(blob);
  grid.setIndices(pcl::make_shared<pcl::Indices>(pcl::Indices{0, 1, 2, 0, 0, 0}));
  grid.filter(output);
  EXPECT_EQ(get(output, 0, "label"), 1.0);
  for (const int beyond : {400, -1}) {
    grid.setIndices(pcl::make_shared<pcl::Indices>(1, beyond));
    expectBadParameter("the index " + std::to_string(beyond) +
                           " is beyond the cloud of 400 points",
                       [&] { grid.filter(output); });
  }
}
