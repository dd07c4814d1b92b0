// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "renderer.h"

#include <pcl_semantic/core/label_distributions.h>

namespace pcl_semantic {

/** \brief Fraction of the full label noise at which the default sequence is as hard as
 * a good network makes real streets. */
constexpr double kSyntheticLabelNoise = 0.5;

/** \brief Label distributions of a view as a network would give them.
 *
 * Made from the true labels, with the mistakes networks make: borders that wander,
 * thin things swallowed by what is behind them, blobs of a class taken for a similar
 * one (mostly at borders, far away and in the dark), many of them with confidence. A
 * part of a mistake sticks to its place in the world, most of it changes from frame to
 * frame. \param[in] seed of the mistakes \param[in] label_noise 0 (nearly perfect) to
 * 1: scales the fraction of wrong pixels \return 11 x (width * height), pixels row by
 * row \throws InvalidParameterException unless 0 <= label_noise <= 1 */
LabelDistributions syntheticDistributions(const SyntheticView& view, std::uint32_t seed,
                                          double label_noise = kSyntheticLabelNoise);

} // namespace pcl_semantic
