// SPDX-License-Identifier: BSD-3-Clause
#include "opencv_runner.h"

#include <opencv2/dnn.hpp>

#include <utility>

namespace pcl_semantic {

namespace {

class OpenCvRunner : public NetworkRunner {
public:
  OpenCvRunner(std::vector<std::uint8_t> bytes, std::string input, std::string output)
      : bytes_(std::move(bytes)), input_(std::move(input)), output_(std::move(output))
  {
    load();
  }

  cv::Mat
  run(const cv::Mat& input) override
  {
    try {
      return forward(input);
    }
    catch (const cv::Exception& error) {
      if (error.code == cv::Error::StsNoMem)
        throw;
      // OpenCV 4.10 fuses layers of some networks (ESPNetv2) into layers that do not
      // fit.
      load();
      net_.enableFusion(false);
      return forward(input);
    }
  }

private:
  void
  load()
  {
    net_ = cv::dnn::readNetFromONNX(bytes_);
    net_.setPreferableBackend(cv::dnn::DNN_BACKEND_OPENCV);
    net_.setPreferableTarget(cv::dnn::DNN_TARGET_CPU);
  }

  cv::Mat
  forward(const cv::Mat& input)
  {
    net_.setInput(input, input_);
    return net_.forward(output_);
  }

  const std::vector<std::uint8_t> bytes_;
  const std::string input_, output_;
  cv::dnn::Net net_;
};

} // namespace

std::unique_ptr<NetworkRunner>
runWithOpenCv(std::vector<std::uint8_t> bytes, const std::string& input,
              const std::string& output)
{
  return std::make_unique<OpenCvRunner>(std::move(bytes), input, output);
}

} // namespace pcl_semantic
