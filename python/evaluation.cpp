// SPDX-License-Identifier: BSD-3-Clause
#include "arrays.h"
#include "core/fail.h"
#include "core/label_number.h"

#include <pcl_semantic/evaluation/confusion_matrix.h>

#include <numeric>

namespace pcl_semantic::python {

namespace {

std::vector<Label>
labelsOf(const py::object& numbers, const char* name)
{
  const auto array = integersOf<std::int64_t>(numbers, name);
  std::vector<Label> labels;
  labels.reserve(std::size_t(array.size()));
  for (py::ssize_t i = 0; i < array.size(); ++i) {
    const std::int64_t label = withoutInstance(array.data()[i]);
    requireWithin(label, 255, name);
    labels.push_back(Label(label));
  }
  return labels;
}

py::array_t<std::uint64_t>
confusionMatrix(const py::object& given_truth, const py::object& given_prediction,
                int classes)
{
  const auto truth = labelsOf(given_truth, "ground truth labels");
  const auto prediction = labelsOf(given_prediction, "predicted labels");
  if (truth.size() != prediction.size())
    badParameter("ground truth of ", truth.size(), " labels, prediction of ",
                 prediction.size());
  ConfusionMatrix matrix(classes);
  for (std::size_t i = 0; i < truth.size(); ++i)
    matrix.add(truth[i], prediction[i], 1);
  py::array_t<std::uint64_t> counts({classes + 1, classes + 1});
  for (int t = 0; t <= classes; ++t)
    for (int p = 0; p <= classes; ++p)
      counts.mutable_at(t, p) = matrix(Label(t), Label(p));
  return counts;
}

py::dict
scores(const py::object& confusion)
{
  const auto counts = integersOf<std::uint64_t>(confusion, "counts");
  const py::ssize_t size = counts.ndim() == 2 ? counts.shape(0) : 0;
  if (size < 2 || size > 256)
    badParameter("expected the matrix that confusion_matrix() gives");
  requireShape(counts, "counts", size, size);
  ConfusionMatrix matrix(int(size - 1));
  for (py::ssize_t t = 0; t < size; ++t)
    for (py::ssize_t p = 0; p < size; ++p)
      matrix.add(Label(t), Label(p), counts.at(t, p));
  std::vector<Label> evaluated(std::size_t(size - 1));
  std::iota(evaluated.begin(), evaluated.end(), Label(1));
  const Scores found = computeScores(matrix, evaluated);
  py::list iou;
  for (const ClassScores& each : found.classes)
    iou.append(each.iou_exclusive);
  py::dict result;
  result["iou"] = py::array_t<double>(iou);
  result["mean_iou"] = found.mean.iou_exclusive;
  result["mean_iou_inclusive"] = found.mean.iou_inclusive;
  result["global_accuracy"] = found.global_accuracy;
  result["coverage"] = found.coverage;
  return result;
}

} // namespace

void
bindEvaluation(py::module_& module)
{
  module.def(
      "confusion_matrix", &confusionMatrix, py::arg("truth"), py::arg("prediction"),
      py::arg("classes"),
      "Counts, (L + 1) x (L + 1), by true label (row) and predicted one; 0 is no\n"
      "ground truth, or not covered. Add the matrices of several frames.");
  module.def("scores", &scores, py::arg("confusion"),
             "Figures of a confusion matrix, 0 to 1: iou (by class, over what is\n"
             "covered), mean_iou, mean_iou_inclusive, global_accuracy, coverage.");
}

} // namespace pcl_semantic::python
