#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "wellgyro/survey/stations/draft.h"

namespace wellgyro {

/// The drafts of a run in the order of time, and which of them are to be told. A draft is unheard
/// while no azimuth is known at its place, news once it may be told, and news again when it has
/// changed.
class DraftBook {
 public:
  const std::vector<Draft>& drafts() const { return drafts_; }
  std::vector<Draft>& drafts() { return drafts_; }

  /// `heard`: an azimuth is known there.
  void Add(const Draft& draft, bool heard) {
    drafts_.push_back(draft);
    (heard ? news_ : unheard_).push_back(drafts_.size() - 1);
  }
  /// The azimuth of all that waited for one has become known.
  void TellUnheard() {
    news_.insert(news_.end(), unheard_.begin(), unheard_.end());
    unheard_.clear();
  }
  /// Once more, or for the first time: not one that waits for an azimuth.
  void Tell(std::size_t draft) {
    if (!IsUnheard(draft)) news_.push_back(draft);
  }
  /// Lists it if it is not yet, and tells it then.
  void List(std::size_t draft) {
    if (!std::exchange(drafts_[draft].listed, true)) Tell(draft);
  }
  bool IsUnheard(std::size_t draft) const {
    return std::binary_search(unheard_.begin(), unheard_.end(), draft);
  }

  bool has_news() const { return !news_.empty(); }
  /// What is to be told since the last call.
  std::vector<std::size_t> News() { return std::exchange(news_, {}); }

 private:
  std::vector<Draft> drafts_;
  std::vector<std::size_t> unheard_, news_;  // indices into drafts_; unheard_ ascending
};

}  // namespace wellgyro
