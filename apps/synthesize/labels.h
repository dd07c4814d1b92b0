// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "renderer.h"
#include "room_renderer.h"

#include <pcl_semantic/core/label_distributions.h>

namespace pcl_semantic {

/** \brief Fraction of the full label noise at which the default sequence is as
 * difficult as real streets for a good network. */
constexpr double kSyntheticLabelNoise = 0.5;

/** \brief Simulates a network's label distributions of a view.
 *
 * Made from the ground truth, with typical mistakes of networks: shifted borders, thin
 * objects replaced by their background, blobs of a class replaced by a similar one
 * (mostly at borders, far away and in the dark), many of them with high confidence. A
 * part of a mistake is fixed in the world; most of it changes from frame to frame.
 * \param[in] seed of the mistakes
 * \param[in] label_noise 0 (nearly perfect) to 1: scales the fraction of wrong pixels
 * \return 11 x (width * height), pixels row by row
 * \throws InvalidParameterException unless 0 <= label_noise <= 1 */
LabelDistributions syntheticDistributions(const SyntheticView& view, std::uint32_t seed,
                                          double label_noise = kSyntheticLabelNoise);

/** \brief The same for a room: 13 x (width * height). */
LabelDistributions syntheticDistributions(const RoomView& view, std::uint32_t seed,
                                          double label_noise = kSyntheticLabelNoise);

} // namespace pcl_semantic
