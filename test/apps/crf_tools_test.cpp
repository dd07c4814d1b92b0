// SPDX-License-Identifier: BSD-3-Clause

// pcl_semantic_crf and pcl_semantic_image_crf.

#include "files/pcd_file.h"
#include "support/ascii_cloud.h"
#include "support/bad_case.h"
#include "support/thrown_message.h"
#include "support/tiny_street.h"

#include <pcl_semantic/cliques/cube_cliques.h>
#include <pcl_semantic/cliques/supervoxel_cliques.h>
#include <pcl_semantic/filters/semantic_crf.h>
#include <pcl_semantic/images/distribution_file.h>
#include <pcl_semantic/images/image_crf.h>
#include <pcl_semantic/images/image_file.h>
#include <pcl_semantic/superpixels/slic.h>

#include <opencv2/core.hpp>
#include <pcl/common/io.h>

#include <random>

namespace pcl_semantic {

namespace fs = std::filesystem;

namespace {

// 12 x 10 points in two rooms of 0.1 m steps, some labelled otherwise than the others.
struct TextCloud {
  pcl::PointCloud<pcl::PointXYZRGBL>::Ptr cloud{
      new pcl::PointCloud<pcl::PointXYZRGBL>(12, 10)};

  TextCloud()
  {
    std::mt19937 random(1);
    for (int i = 0; i < 120; ++i) {
      pcl::PointXYZRGBL& point = (*cloud)[std::size_t(i)];
      point.getVector3fMap() << 0.1f * float(i % 12), 0.1f * float(i / 12), 0.5f;
      point.r = point.g = point.b = std::uint8_t(i % 12 < 6 ? 80 : 120);
      point.label = random() % 6 == 0 ? 3 : i % 12 < 6 ? 1 : 2;
    }
  }

  // Number of the clique that a point has in the file.
  static int
  clique(int i)
  {
    return i % 12 < 5 ? 8 : i % 12 < 8 ? 0 : 3;
  }

  std::string
  text(const std::string& fields = "x y z rgba label serial clique") const
  {
    std::ostringstream rows;
    for (int i = 0; i < 120; ++i) {
      const pcl::PointXYZRGBL& point = (*cloud)[std::size_t(i)];
      std::istringstream words(fields);
      for (std::string word; words >> word;)
        rows << (word == "x"        ? std::to_string(point.x)
                 : word == "y"      ? std::to_string(point.y)
                 : word == "z"      ? std::to_string(point.z)
                 : word == "rgba"   ? std::to_string(point.rgba)
                 : word == "label"  ? std::to_string(point.label)
                 : word == "serial" ? std::to_string(1000 + i)
                                    : std::to_string(clique(i)))
             << " ";
      rows << "\n";
    }
    return asciiCloud(fields, rows.str(), 10);
  }

  // The filter itself.
  template <typename PointT>
  Eigen::MatrixXf
  refined(CRFModelType model, const std::vector<pcl::PointIndices>& cliques = {}) const
  {
    const auto points = std::make_shared<pcl::PointCloud<PointT>>();
    pcl::copyPointCloud(*cloud, *points);
    for (std::size_t i = 0; i < 120; ++i)
      (*points)[i].label = (*cloud)[i].label;
    SemanticCRF<PointT> crf;
    crf.setModel(model);
    crf.setCliques(cliques);
    crf.setInputCloud(points);
    crf.setLabelConfidence(0.8, 3);
    pcl::PointCloud<PointT> output;
    crf.filter(output);
    return crf.getLabelDistributions().matrix();
  }
};

Eigen::MatrixXf
probabilitiesIn(const std::string& path)
{
  const PcdTable table = readPcd(path);
  const PcdColumn column(table, table.find("probability"));
  Eigen::MatrixXf matrix(Eigen::Index(column.field().count),
                         Eigen::Index(table.points()));
  for (Eigen::Index i = 0; i < matrix.cols(); ++i)
    for (int k = 0; k < int(matrix.rows()); ++k)
      matrix(k, i) = float(column(std::size_t(i), k));
  return matrix;
}

double
largestDifference(const Eigen::MatrixXf& a, const Eigen::MatrixXf& b)
{
  if (a.rows() != b.rows() || a.cols() != b.cols())
    return 1.0;
  return double((a - b).cwiseAbs().maxCoeff());
}

} // namespace

TEST(CrfTool, RewritesLabelsAndKeepsEverythingElse)
{
  const TemporaryFolder folder;
  const TextCloud input;
  const std::string in = folder.write("in.pcd", input.text());
  succeed("crf " + in + " " + folder.path("out.pcd"));
  const PcdTable before = readPcd(in), after = readPcd(folder.path("out.pcd"));
  EXPECT_EQ(after.width, 12u);
  EXPECT_EQ(after.height, 10u);
  EXPECT_EQ(after.viewpoint, before.viewpoint);
  for (const char* name : {"x", "y", "z", "rgba", "serial", "clique"}) {
    const PcdColumn was(before, before.find(name)), is(after, after.find(name));
    for (std::size_t i = 0; i < 120; ++i)
      EXPECT_EQ(is.bits(i), was.bits(i)) << name;
  }
  const Eigen::MatrixXf probabilities = probabilitiesIn(folder.path("out.pcd"));
  EXPECT_LT(largestDifference(probabilities,
                              input.refined<pcl::PointXYZRGBL>(CRFModelType::dense)),
            1e-5);
  const PcdColumn label(after, after.find("label"));
  int changed = 0;
  for (std::size_t i = 0; i < 120; ++i) {
    EXPECT_EQ(label(i), mapLabel(probabilities.col(Eigen::Index(i)).data(), 3));
    changed += label(i) != (*input.cloud)[i].label;
  }
  EXPECT_GT(changed, 10);
}

TEST(CrfTool, WorksOnItsOwnOutputAndWithoutColour)
{
  const TemporaryFolder folder;
  const TextCloud input;
  const std::string in = folder.write("in.pcd", input.text());
  succeed("crf " + in + " " + folder.path("once.pcd") + " --crf unary");
  succeed("crf " + folder.path("once.pcd") + " " + folder.path("twice.pcd"));
  succeed("crf " + in + " " + folder.path("direct.pcd"));
  EXPECT_LT(largestDifference(probabilitiesIn(folder.path("twice.pcd")),
                              probabilitiesIn(folder.path("direct.pcd"))),
            1e-5);
  folder.write("in.pcd", input.text("x y z label"));
  succeed("crf " + in + " " + folder.path("out.pcd"));
  EXPECT_LT(largestDifference(probabilitiesIn(folder.path("out.pcd")),
                              input.refined<pcl::PointXYZL>(CRFModelType::dense)),
            1e-5);
}

// A floor of two classes, of which a fifth of the labels is wrong.
std::string
noisyFloor(double step, std::vector<int>& truth)
{
  constexpr int width = 40;
  std::ostringstream rows;
  std::mt19937 random(3);
  for (int i = 0; i < width * width; ++i) {
    truth.push_back(i % width < width / 2 ? 1 : 3);
    const int label = random() % 5 == 0 ? 2 : truth.back();
    rows << step * (i % width) << ' ' << step * (i / width) << " 0 " << label << '\n';
  }
  return asciiCloud("x y z label", rows.str());
}

TEST(CrfTool, MendsACloudWithoutColourInAnyUnit)
{
  const TemporaryFolder folder;
  for (const double step : {0.1, 0.5, 100.0}) {
    std::vector<int> truth;
    const std::string in = folder.write("in.pcd", noisyFloor(step, truth));
    const std::string text = succeed("crf " + in + " " + folder.path("out.pcd"));
    EXPECT_FALSE(holds(text, "warning"));
    const PcdTable table = readPcd(folder.path("out.pcd"));
    const PcdColumn labels(table, table.find("label"));
    int wrong = 0;
    for (std::size_t i = 0; i < truth.size(); ++i)
      wrong += labels(i) != truth[i];
    EXPECT_LT(wrong, 16) << step; // one in a hundred; 300 before
    EXPECT_TRUE(holds(text, "changed_of_classes: "));
    EXPECT_TRUE(holds(text, " of 2"));
  }
}

TEST(CrfTool, SaysWhyNothingWasMended)
{
  const TemporaryFolder folder;
  std::vector<int> truth;
  const std::string floor = folder.write("floor.pcd", noisyFloor(100.0, truth));
  const auto says = [&](const std::string& arguments, const std::string& words) {
    const std::string text =
        succeed("crf " + arguments + " " + folder.path("out.pcd") + " --quiet");
    EXPECT_TRUE(holds(text, words));
  };
  says(floor + " --smoothness-deviation 0.2", "is the cloud in metres?");
  says(floor + " --smoothness-weight 0 --appearance-weight 0", "no label changed");
  const std::string even =
      "FIELDS x y z probability\nSIZE 4 4 4 4\nTYPE F F F F\nCOUNT 1 1 1 2\n"
      "WIDTH 2\nHEIGHT 1\nPOINTS 2\nDATA ascii\n0 0 0 0.5 0.5\n0.1 0 0 0.5 0.5\n";
  says(folder.write("even.pcd", even), "all classes are equally likely");
  const std::string blank = asciiCloud("x y z label", "0 0 0 0\n0.1 0 0 0\n");
  says(folder.write("blank.pcd", blank), "no point has a label");
}

TEST(CrfTool, CliquesOfAFieldOfAFileAndOfCubes)
{
  const TemporaryFolder folder;
  const TextCloud input;
  const std::string in = folder.write("in.pcd", input.text());
  std::vector<pcl::PointIndices> cliques(2); // 3 and 8
  for (int i = 0; i < 120; ++i)
    if (TextCloud::clique(i) > 0)
      cliques[TextCloud::clique(i) == 3 ? 0 : 1].indices.push_back(i);
  std::string list;
  for (const pcl::PointIndices& clique : cliques) {
    for (const pcl::index_t index : clique.indices)
      list += std::to_string(index) + " ";
    list += "\n";
  }
  folder.write("list.txt", list);
  CliqueGenerator::Cloud places;
  pcl::copyPointCloud(*input.cloud, places);
  const auto cubes = CubeCliques(0.35).generate(places);
  SupervoxelParameters distance;
  distance.seed_resolution = 0.35;
  const auto supervoxels = SupervoxelCliques(distance).generate(places);
  for (const auto& [name, model] :
       {std::pair<std::string, CRFModelType>("pn-potts", CRFModelType::pn_potts),
        {"hierarchical", CRFModelType::hierarchical}})
    for (const auto& [words, expected] :
         {std::pair<std::string, std::vector<pcl::PointIndices>>("field", cliques),
          {folder.path("list.txt"), cliques},
          {"cubes:0.35", cubes},
          {"supervoxel:0.35", supervoxels}}) {
      succeed("crf " + in + " " + folder.path("out.pcd") + " --crf " + name +
              " --cliques " + words);
      EXPECT_LT(largestDifference(probabilitiesIn(folder.path("out.pcd")),
                                  input.refined<pcl::PointXYZRGBL>(model, expected)),
                1e-5)
          << name << " " << words;
    }
}

TEST(CrfTool, AConfigThatIsPrintedIsReadBack)
{
  const TemporaryFolder folder;
  const std::string lattice = folder.write("lattice.yaml", "crf_kernels: lattice\n");
  for (const std::string tool : {"crf", "image_crf"}) {
    const std::string options =
        " --crf hierarchical --cliques slic:40 --crf-iterations 7 --clique-weight 2.5 "
        "--crf-normalization one-sided --clique-free-label false --print-config";
    const std::string printed = succeed(tool + options + " --config " + lattice);
    EXPECT_TRUE(holds(printed, "\ncrf_normalization: one-sided "));
    EXPECT_TRUE(holds(printed, "\ncrf_kernels: lattice "));
    const std::string path = folder.write("config.yaml", printed);
    EXPECT_EQ(runTool(tool + " --config " + path + " --print-config").text, printed);
    EXPECT_NE(runTool(tool + " --print-config").text, printed);
  }
}

TEST(CrfTool, RefinesAMapAndItsEntropy)
{
  const TemporaryFolder folder;
  succeed(mapOf(tinyStreet()) + " --frames 0:1 --crf none --output " +
          folder.path("map"));
  const std::string out = folder.path("refined.pcd");
  succeed("crf " + folder.path("map/map.pcd") + " " + out +
          " --crf hierarchical --cliques cubes:1" + of_kitti11);
  const PcdTable table = readPcd(out);
  const PcdColumn entropy(table, table.find("entropy"));
  LabelDistributions distributions;
  distributions.matrix() = probabilitiesIn(out);
  EXPECT_GT(table.points(), 500u);
  for (std::size_t i = 0; i < table.points(); ++i)
    EXPECT_NEAR(entropy(i), double(distributions.entropy(Eigen::Index(i))), 1e-5);
}

TEST(SimdTiers, AllGiveTheSameBits)
{
  const TemporaryFolder folder;
  std::vector<int> truth;
  const std::string input = folder.write("floor.pcd", noisyFloor(0.1, truth));
  std::vector<Eigen::MatrixXf> results;
  for (const std::string tier : {"plain", "avx2", "avx512", ""}) {
    const std::string output = folder.path("tier_" + tier + ".pcd");
    succeed("crf " + input + " " + output + " --crf-iterations 5",
            "PCL_SEMANTIC_SIMD=" + tier);
    results.push_back(probabilitiesIn(output));
    EXPECT_EQ(largestDifference(results.back(), results[0]), 0.0) << tier;
  }
  const ToolResult unknown =
      runTool("crf " + input + " " + folder.path("out.pcd"), "PCL_SEMANTIC_SIMD=sse9");
  EXPECT_EQ(unknown.code, 2);
  EXPECT_EQ(unknown.text, "pcl_semantic_crf: PCL_SEMANTIC_SIMD is 'sse9', expected "
                          "plain, neon, avx2 or avx512\n");
}

TEST(ImageCrfTool, WritesWhatTheFilterSays)
{
  const TemporaryFolder folder;
  const std::string image = tinyStreet() + "/image_2/000001.png";
  const std::string labels = tinyStreet() + "/labels/000001.bin";
  succeed("image_crf " + image + " " + labels + " " + folder.path("out.png") +
          " --crf hierarchical --cliques slic:60 --overlay " +
          folder.path("overlay.png") + " --refined " + folder.path("out.bin"));
  const cv::Mat picture = readPng(image, ImageKind::grey_or_colour);
  SlicParameters slic;
  slic.superpixels = 60;
  ImageCRF crf;
  crf.setModel(CRFModelType::hierarchical);
  crf.setCliques(cliquesOfSegments(slicSuperpixels(picture, slic)));
  const LabelDistributions measured =
      readDistributions(labels, picture.cols, picture.rows, 11, 0.8f);
  const LabelDistributions expected = crf.refine(picture, measured);
  const cv::Mat1b classes = readPng(folder.path("out.png"), ImageKind::labels);
  ASSERT_EQ(classes.size(), picture.size());
  int changed = 0;
  for (Eigen::Index j = 0; j < expected.size(); ++j) {
    EXPECT_EQ(classes.data[j], expected.mapLabel(j));
    changed += classes.data[j] != measured.mapLabel(j);
  }
  EXPECT_GT(changed, 100);
  EXPECT_LT(largestDifference(readDistributions(folder.path("out.bin"), picture.cols,
                                                picture.rows, 11, 0.8f)
                                  .matrix(),
                              expected.matrix()),
            1e-5);
  EXPECT_EQ(readPng(folder.path("overlay.png"), ImageKind::grey_or_colour).cols,
            picture.cols);
}

TEST(BadInput, OfTheCrfTools)
{
  const TextCloud cloud;
  const auto file = [](const std::string& name, const std::string& text) {
    return
        [=](const std::string& street) { std::ofstream(street + "/" + name) << text; };
  };
  const auto whole = file("in.pcd", cloud.text());
  const std::string crf = "crf STREET/in.pcd OUT.pcd ";
  const auto with = [&](const std::string& from, const std::string& to) {
    return file("in.pcd", replaceAll(cloud.text(), from, to));
  };
  const std::string image =
      "image_crf STREET/image_2/000000.png STREET/labels/000000.bin OUT.png ";
  const cv::Mat small(20, 30, CV_8UC1, cv::Scalar(1));
  expectAllFail({
      {2, "expected IN OUT.pcd", "crf"},
      {3, "in.pcd: ", crf},
      {3, "in.pcd: has no field 'z'", crf, with("FIELDS x y z", "FIELDS x y w")},
      {3, "in.pcd: has no field 'label' or 'probability'", crf,
       file("in.pcd", cloud.text("x y z rgba"))},
      {2, "in.pcd: is given as an output", "crf STREET/in.pcd STREET/./in.pcd", whole},
      {3, "label 12 of point", crf + of_kitti11, with(" 1 1000 8", " 12 1000 8")},
      {2, "--crf: 'best', expected unary, dense, pn-potts or hierarchical",
       crf + "--crf best"},
      {2, "need cliques", crf + "--crf hierarchical"},
      {2, "--cliques has no effect with --crf dense", crf + "--cliques field"},
      {3, "in.pcd: has no field 'clique'", crf + "--crf pn-potts --cliques field",
       file("in.pcd", cloud.text("x y z label"))},
      {3, "calib.txt line 1", crf + "--crf pn-potts --cliques STREET/calib.txt", whole},
      {2, "", crf + "--crf pn-potts --cliques cubes:0", whole},
      {2, "'big'", crf + "--crf pn-potts --cliques cubes:big", whole},
      {2, "expected slic:N with N 1 to 65536", crf + "--crf pn-potts --cliques slic:0",
       whole},
      {3, "no:ne.txt", crf + "--crf pn-potts --cliques STREET/no:ne.txt", whole},
      {3, "organized", crf + "--crf pn-potts --cliques slic",
       with("WIDTH 12\nHEIGHT 10", "WIDTH 120\nHEIGHT 1")},
      {2, "clique_weight is -1", crf + "--clique-weight -1"},
      {3, "config.yaml line 1: key 'voxel_size'", crf + "--config STREET/config.yaml",
       file("config.yaml", "voxel_size: 1\n")},
      {3, "config.yaml: clique_truncation is 2", crf + "--config STREET/config.yaml",
       file("config.yaml", "clique_truncation: 2\n")},
      {5, "calib.txt", "crf STREET/in.pcd STREET/calib.txt/x.pcd", whole},
      {5, "there is no folder", "crf STREET/none.pcd none/x.pcd"},
      {2, "x.ply: expected a name that ends in .pcd", "crf STREET/in.pcd x.ply"},
      {2, "cliques are 'supervoxels', expected none, field",
       crf + "--crf pn-potts --cliques supervoxels", whole},
      {2, "expected IMAGE DISTRIBUTIONS OUT.png", "image_crf a b"},
      {3, "none.png", "image_crf STREET/none.png STREET/labels/000000.bin OUT.png"},
      {2, "000000.png: is given as an output",
       "image_crf STREET/image_2/000000.png STREET/labels/000000.bin "
       "STREET/image_2/../image_2/000000.png"},
      {2, "is given as an output", image + "--overlay OUT.png"},
      {2, "expected a name that ends in .bin", image + "--refined OUT.txt"},
      {2, "need cliques", image + "--crf pn-potts"},
      {3, "small.png: has 30 x 20 pixels, expected 208 x 64",
       image + "--crf pn-potts --cliques STREET/small.png",
       [=](const std::string& street) { writePng(street + "/small.png", small); }},
  });
}

} // namespace pcl_semantic
