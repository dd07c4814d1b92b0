// SPDX-License-Identifier: BSD-3-Clause
#include "onnx_runtime_runner.h"

#include <omp.h>
#include <onnxruntime_cxx_api.h>

#include <iostream>
#include <mutex>
#include <new>
#include <optional>
#include <streambuf>
#include <string>
#include <utility>

namespace pcl_semantic {

namespace {

// Whether memory was insufficient; ONNX Runtime has no error code for this.
bool
lacksMemory(const std::string& error)
{
  return error.find("std::bad_alloc") != std::string::npos ||
         error.find("Failed to allocate memory") != std::string::npos;
}

// Returns the result of \a body; converts exceptions of ONNX Runtime.
template <typename Body>
auto
withOnnxRuntime(Body&& body)
{
  try {
    return body();
  }
  catch (const Ort::Exception& error) {
    if (lacksMemory(error.what()))
      throw std::bad_alloc();
    throw EngineError(error.what());
  }
}

// ONNX Runtime requires one environment per process.
Ort::Env&
environment()
{
  static Ort::Env env(ORT_LOGGING_LEVEL_FATAL, "pcl_semantic"); // may throw too
  return env;
}

Ort::SessionOptions
sessionOptions()
{
  Ort::SessionOptions options;
  options.SetIntraOpNumThreads(omp_get_max_threads());
  // Waiting threads of ONNX Runtime must not block processors for the library's
  // threads.
  options.AddConfigEntry("session.intra_op.allow_spinning", "0");
  // ONNX Runtime's own format is not checked by readOnnxInterface().
  options.AddConfigEntry("session.load_model_format", "ONNX");
  return options;
}

// With the first network of a process, Debian's ONNX Runtime 1.21 prints to std::cerr
// that each of 500 operations is registered twice. Real errors are thrown.
class QuietErrors {
public:
  QuietErrors() : buffer_(std::cerr.rdbuf(nullptr)) {}
  ~QuietErrors() { std::cerr.rdbuf(buffer_); }
  QuietErrors(const QuietErrors&) = delete;
  QuietErrors& operator=(const QuietErrors&) = delete;

private:
  std::streambuf* const buffer_;
};

Ort::Session
load(const std::vector<std::uint8_t>& bytes)
{
  static std::mutex mutex;
  static bool is_first = true;
  const std::lock_guard<std::mutex> lock(mutex);
  std::optional<QuietErrors> quiet;
  if (is_first)
    quiet.emplace();
  Ort::Session session(environment(), bytes.data(), bytes.size(), sessionOptions());
  is_first = false;
  return session;
}

class OnnxRuntimeRunner : public NetworkRunner {
public:
  OnnxRuntimeRunner(const std::vector<std::uint8_t>& bytes, std::string input,
                    std::string output)
      : input_(std::move(input)), output_(std::move(output)), session_(load(bytes))
  {}

  cv::Mat
  run(const cv::Mat& input) override
  {
    return withOnnxRuntime([&] {
      const std::vector<std::int64_t> shape(input.size.p, input.size.p + input.dims);
      const Ort::Value value = Ort::Value::CreateTensor<float>(
          Ort::MemoryInfo::CreateCpu(OrtArenaAllocator, OrtMemTypeDefault),
          const_cast<float*>(input.ptr<float>()), input.total(), shape.data(),
          shape.size());
      const char* const input_name = input_.c_str();
      const char* const output_name = output_.c_str();
      std::vector<Ort::Value> outputs = session_.Run(
          Ort::RunOptions{nullptr}, &input_name, &value, 1, &output_name, 1);
      return matOf(outputs.at(0));
    });
  }

private:
  static cv::Mat
  matOf(Ort::Value& value)
  {
    if (!value.IsTensor())
      throw EngineError("its output is no tensor");
    const auto info = value.GetTensorTypeAndShapeInfo();
    if (info.GetElementType() != ONNX_TENSOR_ELEMENT_DATA_TYPE_FLOAT)
      throw EngineError("its output is not of 32-bit floating point");
    const std::vector<std::int64_t> shape = info.GetShape();
    if (shape.empty() || shape.size() > CV_MAX_DIM)
      throw EngineError("its output has " + std::to_string(shape.size()) + " axes");
    const std::vector<int> size(shape.begin(), shape.end());
    return cv::Mat(size, CV_32FC1, value.GetTensorMutableData<float>()).clone();
  }

  const std::string input_, output_;
  Ort::Session session_;
};

} // namespace

std::unique_ptr<NetworkRunner>
runWithOnnxRuntime(const std::vector<std::uint8_t>& bytes, const std::string& input,
                   const std::string& output)
{
  return withOnnxRuntime(
      [&] { return std::make_unique<OnnxRuntimeRunner>(bytes, input, output); });
}

} // namespace pcl_semantic
