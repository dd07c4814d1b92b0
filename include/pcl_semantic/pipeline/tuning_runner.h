// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/pipeline/tuning_sequence.h>
#include <pcl_semantic/pipeline/tuning_view.h>

#include <cstdint>
#include <list>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Maps sequences with configurations and counts what is right.
 *
 * Maps that differ only in their CRF share everything before it: mapped frames are kept
 * as long as they fit the memory, those used last the longest. */
class TuningRunner {
public:
  /** \param[in] memory for mapped frames [bytes]; those of the runs under way are kept
   * even if they need more */
  TuningRunner(std::vector<std::shared_ptr<const TuningSequence>> sequences,
               const LabelSet& label_set, std::size_t memory);

  /** \brief Threads may call it at once.
   * \param[in] sequence its place
   * \throws InvalidParameterException, BadInputException */
  TuningResult run(const MapperConfig& config, std::size_t sequence);

  /** \brief What the mapped frames depend on, as text. */
  static std::string mapKey(const MapperConfig& config);

private:
  using Views = std::vector<TuningView>;

  struct Entry {
    std::string key;
    std::mutex making;
    std::shared_ptr<const Views> views; ///< null until they are made
    std::size_t bytes = 0;
  };

  template <typename Visit>
  void mapFrames(MapperConfig config, std::size_t sequence, const Visit& visit) const;

  std::shared_ptr<Entry> entryOf(const std::string& key);

  std::shared_ptr<const Views> viewsOf(const MapperConfig& config,
                                       std::size_t sequence);

  void forgetOldest();

  std::vector<std::shared_ptr<const TuningSequence>> sequences_;
  LabelSet label_set_;
  std::size_t memory_;
  std::mutex entries_lock_;
  std::list<std::shared_ptr<Entry>> entries_; // used last first
};

} // namespace pcl_semantic
