// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/label_set.h>

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Labels and object numbers of the points of a scan. */
struct ScanSegments {
  std::vector<Label> labels;          ///< 0 = unlabelled
  std::vector<std::uint32_t> objects; ///< as many; 0 = in no object
};

/** \brief Counts of segments. Ratios are 0..1, or NaN if there are no segments. */
struct SegmentCounts {
  std::uint64_t matched = 0;         ///< pairs with an IoU above 0.5
  std::uint64_t missed = 0;          ///< true segments without a match
  std::uint64_t false_positives = 0; ///< predicted segments without a match
  double iou = 0.0;                  ///< sum of the matched pairs
  std::uint64_t boxes = 0;           ///< true objects whose boxes were compared
  std::uint64_t boxes_25 = 0;        ///< of these, found with an IoU of 0.25 or more
  std::uint64_t boxes_50 = 0;        ///< of these, found with an IoU of 0.5 or more

  /** \brief Panoptic quality: the product of the other two. */
  double panopticQuality() const;

  /** \brief Recognition quality: F1 of the matches. */
  double recognitionQuality() const;

  /** \brief Segmentation quality: mean IoU of the matched pairs; 0 without a match. */
  double segmentationQuality() const;

  SegmentCounts& operator+=(const SegmentCounts& other);
};

/** \brief Scores of the object numbers over the frames of all sequences. */
struct AssociationScores {
  double association = 0.0;   ///< S_assoc of LSTQ, 0..1; NaN without true objects
  std::uint64_t objects = 0;  ///< true objects
  std::uint64_t switches = 0; ///< matches with another number than the previous one
};

/** \brief Compares segments of scans with ground truth: panoptic quality (Kirillov et
 * al., CVPR 2019), recall of boxes, and association over the frames (Aygun et al., 4D
 * Panoptic LiDAR Segmentation, CVPR 2021).
 *
 * A segment is an object of a class with objects (`thing`), or all points of another
 * class. As in SemanticKITTI's scorer, points without ground truth are left out, and an
 * unmatched segment counts only if it has the minimum number of points. Points of a
 * `thing` class without an object number are no ground truth; if predicted, they are in
 * no segment. */
class PanopticQuality {
public:
  static constexpr std::size_t default_min_points = 50; ///< as SemanticKITTI's scorer

  /** \brief Bands of distances begin there [m]; the last one has no end. */
  static constexpr std::array<double, 4> bands{0.0, 10.0, 20.0, 40.0};

  /** \param[in] min_points of a segment */
  explicit PanopticQuality(LabelSet label_set,
                           std::size_t min_points = default_min_points);

  /** \brief Begins another sequence: object numbers have no relation to earlier ones.
   */
  void startSequence();

  /** \brief Compares the next scan of the sequence.
   * \param[in] truth numbers of objects identify them over the frames
   * \param[in] prediction as many points; the numbers of objects are unique over all
   * classes
   * \param[in] positions of the points in the scanner's frame [m], NaN = unknown; empty
   * = neither boxes nor distances are compared. Distances are those of the nearest
   * point of the true segment, or of the predicted one without a match
   * \throws BadInputException for another number of points, or a label beyond L;
   * nothing is counted then */
  void add(const ScanSegments& truth, const ScanSegments& prediction,
           const std::vector<Eigen::Vector3d>& positions = {});

  /** \brief The counts of a class, at all distances. */
  SegmentCounts counts(Label label) const;

  /** \brief The counts of a class in a band of distances. Segments without positions
   * are in none. */
  const SegmentCounts&
  counts(Label label, std::size_t band) const
  {
    return counts_[label][band];
  }

  /** \brief Scores the numbers of the objects. As in the paper, the classes of
   * predicted objects are irrelevant for the association. In each frame, true objects
   * of fewer than the minimum number of points are left out. */
  AssociationScores association() const;

private:
  struct Frame;

  void addMatches(Frame& frame);
  void addRest(const Frame& frame);
  void addBoxes(const Frame& frame);
  void addTubes(const Frame& frame);

  using Number = std::pair<std::uint32_t, std::uint32_t>; ///< sequence, object

  LabelSet label_set_;
  std::size_t min_points_;
  std::uint32_t sequence_ = 0;
  /// By label and band; the last element is that of unknown distances.
  std::vector<std::array<SegmentCounts, bands.size() + 1>> counts_;
  std::map<Number, std::uint64_t> true_tubes_, predicted_tubes_;    ///< points
  std::map<std::pair<Number, Number>, std::uint64_t> common_tubes_; ///< points of both
  std::map<Number, std::uint32_t> last_matches_; ///< true object to predicted object
  std::uint64_t switches_ = 0;
};

} // namespace pcl_semantic
