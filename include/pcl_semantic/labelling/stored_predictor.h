// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/labelling/label_predictor.h>

#include <string>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Reads the label distributions of a frame from a folder: NNNNNN.bin, .npy or
 * .png, in the formats of readDistributions(). */
class StoredPredictor : public LabelPredictor {
public:
  /** \param[in] folder of the files
   * \param[in] classes L
   * \param[in] png_confidence probability of the class in a .png, in (0, 1]
   * \param[in] mapping of the pixels of a .png, see readDistributions()
   * \throws InvalidParameterException if \a classes or \a png_confidence is out of
   * range
   * \throws BadInputException if the folder does not exist */
  StoredPredictor(const std::string& folder, int classes, float png_confidence,
                  PixelMapping mapping = {});

  void requireFrames(const std::vector<int>& frames) const override;

  /** \throws BadInputException if the frame has no file, more than one, or a file that
   * has not one distribution per pixel of \a image */
  LabelDistributions predict(const cv::Mat& image, int frame) override;

private:
  /** \brief The one file of a frame. */
  std::string findFile(int frame) const;

  std::string folder_;
  int classes_;
  float png_confidence_;
  PixelMapping mapping_;
};

} // namespace pcl_semantic
