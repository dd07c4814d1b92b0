// SPDX-License-Identifier: BSD-3-Clause
#include "arrays.h"
#include "core/fail.h"

#include <pcl_semantic/evaluation/confusion_matrix.h>

#include <numeric>

namespace pcl_semantic::python {

namespace {

std::vector<Label>
labelsOf(const Array<std::int64_t>& numbers, const char* name)
{
  std::vector<Label> labels;
  labels.reserve(std::size_t(numbers.size()));
  for (py::ssize_t i = 0; i < numbers.size(); ++i)
    labels.push_back(labelOf(numbers.data()[i], name, std::size_t(i)));
  return labels;
}

py::array_t<std::uint64_t>
confusionMatrix(const py::object& given_truth, const py::object& given_prediction,
                int classes)
{
  const auto truths = integersOf<std::int64_t>(given_truth, "ground truth labels");
  const auto predictions =
      integersOf<std::int64_t>(given_prediction, "predicted labels");
  if (shapeOf(truths) != shapeOf(predictions))
    badParameter("ground truth labels are ", shapeOf(truths), ", predicted ones ",
                 shapeOf(predictions), ", expected the same");
  const auto truth = labelsOf(truths, "ground truth labels");
  const auto prediction = labelsOf(predictions, "predicted labels");
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
  std::uint64_t sum = 0;
  for (py::ssize_t t = 0; t < size; ++t)
    for (py::ssize_t p = 0; p < size; ++p) {
      sum += counts.at(t, p);
      if (sum < counts.at(t, p))
        badParameter("counts sum to more than 64 bits hold");
      matrix.add(Label(t), Label(p), counts.at(t, p));
    }
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
