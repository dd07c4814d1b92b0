// SPDX-License-Identifier: BSD-3-Clause

// The dense CRF over the pixels of an image, compared with a plain single-thread
// permutohedral mean field, with the same kernels (3 px; 40 px and 4 grey levels),
// weights and self-interaction. It uses ImageCRF's summation, on two threads. Then the
// lattice over positions and colours of voxels.

#include "bench/kitti_map.h"
#include "bench/ratio.h"
#include "crf/lattice_kernel.h"
#include "support/plain_lattice.h"
#include "support/street_scans.h"

#include <pcl_semantic/core/threads.h>
#include <pcl_semantic/images/image_crf.h>

#include <cstdio>

namespace {

using namespace pcl_semantic;

constexpr int updates = 5;
constexpr float weights[2] = {3.0f, 8.0f};

struct LabelledImage {
  cv::Mat image;
  LabelDistributions distributions;
  Eigen::MatrixXf unary;
  Eigen::MatrixXf features[2]; // of the pixels, row by row
};

LabelledImage
labelledImage(const cv::Mat& image, const LabelDistributions& distributions)
{
  const Eigen::Index count = distributions.size();
  LabelledImage result;
  result.image = image;
  result.distributions = distributions;
  result.unary = -distributions.matrix().array().max(1e-6f).log();
  result.features[0].resize(2, count);
  result.features[1].resize(5, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const int x = int(i) % image.cols, y = int(i) / image.cols;
    const auto& colour = image.at<cv::Vec3b>(y, x);
    result.features[0].col(i) << float(x) / 3.0f, float(y) / 3.0f;
    result.features[1].col(i) << float(x) / 40.0f, float(y) / 40.0f,
        float(colour[0]) / 4.0f, float(colour[1]) / 4.0f, float(colour[2]) / 4.0f;
  }
  return result;
}

Eigen::MatrixXf
runOurs(const LabelledImage& image)
{
  ImageCRF crf;
  SemanticCRFParameters parameters = SemanticCRFParameters::forImages();
  parameters.smoothness_weight = double(weights[0]);
  parameters.appearance_weight = double(weights[1]);
  parameters.iterations = updates;
  parameters.self_interaction = true;
  crf.setParameters(parameters);
  return crf.refine(image.image, image.distributions).matrix();
}

Eigen::MatrixXf
runPlain(const LabelledImage& image, int iterations)
{
  return plainLatticeMeanField(image.unary, {image.features[0], image.features[1]},
                               {weights[0], weights[1]}, iterations, true);
}

void
printAgreement(const Eigen::MatrixXf& a, const Eigen::MatrixXf& b)
{
  Eigen::Index equal = 0, best_a, best_b;
  for (Eigen::Index i = 0; i < a.cols(); ++i) {
    a.col(i).maxCoeff(&best_a);
    b.col(i).maxCoeff(&best_b);
    equal += best_a == best_b;
  }
  std::printf("  labels equal on %.4f %% of the pixels, marginals differ by %.2g on "
              "average\n",
              100.0 * double(equal) / double(a.cols()),
              double((a - b).cwiseAbs().mean()));
}

// Prints the time to set up a kernel, and of its product with the labels.
void
printParts(const char* name, const Eigen::MatrixXf& features, Eigen::Index labels)
{
  const double set_up = medianSeconds(5, [&] { LatticeKernel kernel(features); });
  const LatticeKernel kernel(features);
  const Eigen::Index rows = (labels + 15) / 16 * 16; // padding of the engine
  const Eigen::MatrixXf values = Eigen::MatrixXf::Constant(rows, kernel.size(), 0.1f);
  Eigen::MatrixXf result = Eigen::MatrixXf::Zero(rows, kernel.size());
  const double product = medianSeconds(9, [&] { kernel.addProduct(values, result); });
  std::printf("  %s: %ld points, %ld vertices; set-up %.1f ms, product %.1f ms\n", name,
              long(kernel.size()), long(kernel.lattice().vertices), 1e3 * set_up,
              1e3 * product);
}

void
compare(const std::string& name, const LabelledImage& image)
{
  std::printf("%s: %ld pixels, %ld labels\n", name.c_str(), long(image.unary.cols()),
              long(image.unary.rows()));
  const Eigen::Index labels = image.unary.rows();
  printParts("3 px", image.features[0], labels);
  printParts("40 px and 4 levels", image.features[1], labels);
  const double plain_set_up = medianSeconds(1, [&] { runPlain(image, 0); });
  const double plain = medianSeconds(1, [&] { runPlain(image, updates); });
  const double ours = medianSeconds(5, [&] { runOurs(image); });
  std::printf(
      "  %d updates, set-up included: ours %.3f s, plain lattice %.3f s (%.3f s "
      "of it set-up)\n",
      updates, ours, plain, plain_set_up);
  printAgreement(runOurs(image), runPlain(image, updates));
  printRatio("image_crf_" + name + "_vs_plain_lattice", plain / ours, 5);
}

LabelledImage
streetImage()
{
  const SyntheticView view =
      SyntheticRenderer(SyntheticScene(1, 1), 1241, 376).render(0);
  return labelledImage(view.left, syntheticDistributions(view, 1));
}

LabelledImage
kittiImage()
{
  const StereoFrame frame = KittiSequence(realDataFolder() + "/kitti/15").frame(0);
  return labelledImage(frame.left, kittiNetwork()->predict(frame.left, frame.number));
}

void
printVoxels(const char* name, const VoxelCloud& voxels)
{
  Eigen::MatrixXf features(6, Eigen::Index(voxels.size()));
  for (std::size_t i = 0; i < voxels.size(); ++i) {
    const pcl::PointXYZRGBL& point = (*voxels.cloud)[i];
    features.col(Eigen::Index(i)) << point.getVector3fMap() / 0.2f,
        float(point.r) / 8.0f, float(point.g) / 8.0f, float(point.b) / 8.0f;
  }
  std::printf("%s\n", name);
  printParts("0.2 m and 8 levels", features, voxels.measured.classes());
}

} // namespace

int
main()
{
  setNumberOfThreads(2);
  compare("street", streetImage());
  printVoxels("voxels of the street", makeStreetMap(6));
  if (!realDataFolder().empty()) {
    compare("kitti", kittiImage());
    printVoxels("voxels of KITTI 15 to 20 m", makeKittiMap(20.0));
    printVoxels("voxels of KITTI 15 to 40 m", makeKittiMap(40.0));
  }
  return 0;
}
