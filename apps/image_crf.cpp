// SPDX-License-Identifier: BSD-3-Clause
#include "image_tool.h"
#include "messages.h"
#include "tool.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/threads.h>
#include <pcl_semantic/files/input_file.h>
#include <pcl_semantic/files/label_set_file.h>
#include <pcl_semantic/filters/crf_config.h>
#include <pcl_semantic/images/distribution_file.h>
#include <pcl_semantic/images/image_crf.h>
#include <pcl_semantic/images/image_file.h>
#include <pcl_semantic/pictures/map_images.h>
#include <pcl_semantic/superpixels/clique_config.h>
#include <pcl_semantic/superpixels/slic.h>

namespace {

using namespace pcl_semantic;
using namespace pcl_semantic::tool;

struct Arguments {
  std::string image, distributions, output, label_set, overlay, refined, config;
  CRFConfig parameters;

  Arguments()
  {
    parameters.parameters = SemanticCRFParameters::forImages();
    parameters.unit = "px";
    parameters.clique_words =
        "cliques: none, slic, slic:NUMBER or an image of segments (.png)";
  }
};

const Usage usage{
    "pcl_semantic_image_crf",
    "IMAGE DISTRIBUTIONS OUT.png [options]",
    R"(Makes the classes of an image's pixels consistent with a CRF, and writes class ids
(0 = unlabelled). DISTRIBUTIONS: .bin, .npy, or class ids as .png.)",
    R"(pcl_semantic_synthesize /tmp/street && \
  pcl_semantic_image_crf /tmp/street/image_2/000000.png /tmp/street/labels/000000.bin \
    /tmp/refined.png --overlay /tmp/refined_overlay.png)",
    {{"label-set FILE", "label set of the distributions (default: kitti11)"},
     {"overlay FILE", "output image with the classes drawn over it (.png)"},
     {"refined FILE", "output file of the refined distributions (.bin)"},
     {"cliques slic[:NUMBER]", "superpixels of pn-potts and hierarchical"},
     {"crf dense", "CRF model: unary, dense, pn-potts or hierarchical"},
     {"crf-iterations N", "number of mean-field updates"},
     {"smoothness-weight 3", "weight of the smoothness kernel"},
     {"appearance-weight 8", "weight of the appearance kernel"},
     {"clique-weight 1", "cost of a member whose label differs from its clique's"},
     {"label-confidence 0.8", "probability of the class of a label"},
     {"config FILE", "parameters (.yaml); --print-config writes them"}}};

Arguments
parse(int argc, char** argv)
{
  Arguments arguments;
  bool print_config = false;
  const po::variables_map values = parseCommandLine(
      argc, argv, usage,
      {{"image", arguments.image, "input image (.png, .jpg)"},
       {"distributions", arguments.distributions,
        "label distributions of the pixels (.bin, .npy), or class ids (.png)"},
       {"output", arguments.output, "output image of class ids (.png)"},
       {"label-set", arguments.label_set,
        "label set of the distributions (default: label_sets/kitti11.yaml)"},
       {"overlay", arguments.overlay,
        "output image with the classes drawn over it (.png)"},
       {"refined", arguments.refined,
        "output file of the refined distributions (.bin)"},
       {"config", arguments.config, "parameter file (.yaml); options override it"},
       {"print-config", print_config,
        "print the effective parameters as YAML and exit"}},
      {"image", "distributions", "output"}, parametersOf(arguments.parameters));
  setCRFConfig(values, arguments.config, print_config, arguments.parameters);
  refuseUnread(values,
               {unreadOptionsOfLabels(arguments.distributions),
                {arguments.refined.empty(), "without --refined", {"crf-temperature"}}});
  return arguments;
}

void
setCliques(const std::string& cliques, const cv::Mat& image, ImageCRF& crf)
{
  if (cliques == "none")
    return;
  SlicParameters slic;
  if (!parseSlic(cliques, slic)) {
    return crf.setSegments(readPng(cliques, ImageKind::segments, image.size()));
  }
  crf.setCliques(cliquesOfSegments(slicSuperpixels(image, slic)));
}

int
refine(const Arguments& arguments)
{
  refuseIf(arguments.output.empty(), "expected IMAGE DISTRIBUTIONS OUT.png");
  refuseSameFiles({arguments.image, arguments.distributions, arguments.config,
                   arguments.label_set, arguments.parameters.cliques},
                  {arguments.output, arguments.overlay, arguments.refined});
  requireOutput(arguments.output, ".png");
  requireOutput(arguments.overlay, ".png");
  requireOutput(arguments.refined, ".bin");
  arguments.parameters.requireFittingCliques();
  setNumberOfThreads(arguments.parameters.threads);
  const LabelSet label_set = readLabelSetOrDefault(arguments.label_set);
  const cv::Mat image = readImage(arguments.image);
  const LabelDistributions measured =
      readDistributions(arguments.distributions, image.cols, image.rows,
                        label_set.size(), float(arguments.parameters.label_confidence));
  ImageCRF crf;
  crf.setModel(arguments.parameters.model);
  crf.setParameters(arguments.parameters.parameters);
  crf.setThinLabels(label_set.thinLabels());
  setCliques(arguments.parameters.cliques, image, crf);
  const LabelDistributions refined = crf.refine(image, measured);
  cv::Mat1b labels(image.size());
  for (Eigen::Index j = 0; j < refined.size(); ++j)
    labels.data[j] = refined.mapLabel(j);
  if (!arguments.refined.empty())
    writeDistributions(arguments.refined, refined);
  if (!arguments.overlay.empty())
    writePng(arguments.overlay, drawOverlay(image, labels, label_set));
  writePng(arguments.output, labels);
  printResults({{"updates", std::size_t(crf.getReport().updates)},
                {"classes", arguments.output}});
  return exit_done;
}

} // namespace

int
main(int argc, char** argv)
{
  return runWithImages(usage.name, [&] { return refine(parse(argc, argv)); });
}
