#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "wellgyro/live/observer.h"
#include "wellgyro/record/advice.h"
#include "wellgyro/record/glance.h"

#include "voice.h"

namespace wellgyro::apps {

/// Says what a live program has to say on standard error, and never waits for who reads it.
/// On a terminal one line lives below what was said; else it is a plain line every few seconds.
class Console : public LiveObserver {
 public:
  Console();
  void OnNotice(std::string_view sentence) override;
  void OnGlance(const Glance& glance) override;
  void OnAdvice(const Advice& advice) override { advice_ = advice.text; }

  /// Shows `line` in place of the one before.
  void Show(const std::string& line);

  /// The run is over: what follows may be said directly. Nothing more may be said here.
  void End() { voice_.End(); }

 private:
  Voice voice_;
  std::int64_t said_us_;
  std::string advice_;  ///< said last, shown before the glance
};

}  // namespace wellgyro::apps
