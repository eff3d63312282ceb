#pragma once

#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <string_view>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"
#include "wellgyro/live/observer.h"

namespace wellgyro {

/// What came from outside, with every byte that is not plain ASCII as \xNN.
WELLGYRO_EXPORT std::string Printable(std::string_view text);

/// What a live program says to the person in front of it, from any of its threads. Of faults the
/// first ten of each code are told, then one a second with how many there were.
class WELLGYRO_EXPORT Notices {
 public:
  /// Both must outlive this object.
  Notices(LiveObserver& observer, const LiveClock& clock) : observer_(observer), clock_(clock) {}

  void Say(std::string_view sentence);
  void Say(const Fault& fault) { Say(SentenceOf(fault)); }
  void Tell(const Fault& fault);

  /// Calls the observer, one at a time.
  template <class Call>
  void With(Call call) {
    const std::lock_guard lock(mutex_);
    call(observer_);
  }

 private:
  struct Count {
    std::int64_t told = 0, untold = 0;
    std::int64_t last_us = 0;
  };
  LiveObserver& observer_;
  const LiveClock& clock_;
  std::mutex mutex_;
  std::map<FaultCode, Count> counts_;
};

}  // namespace wellgyro
