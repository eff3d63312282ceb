#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string_view>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"
#include "wellgyro/record/check.h"
#include "wellgyro/record/operations.h"
#include "wellgyro/record/station.h"

/// @file
/// What a live session wants of the program that runs it.
namespace wellgyro {

inline constexpr std::int64_t kSecondUs = 1'000'000;

/// The clocks of the program that runs a live session: the library itself reads none, so that a
/// test may give it any time. Both are called from several threads.
struct LiveClock {
  std::function<std::int64_t()> utc_us;        ///< since 1970 [us]
  std::function<std::int64_t()> monotonic_us;  ///< for lengths of time [us]
};

// What pages and consoles show: defined in record/, for our own program.
struct Advice;
struct Glance;

/// Status::text of a session that hears and says nothing else for the moment.
inline constexpr std::string_view kBusy = "busy adjusting or catching up";

/// Who wants to hear how a live session gets on. Override what you want to hear. Calls come one at
/// a time, but from several threads, while the session runs: they must not wait for it.
class WELLGYRO_EXPORT LiveObserver {
 public:
  virtual ~LiveObserver();
  virtual void OnNotice(std::string_view /*sentence*/) {}  ///< for the person on the rig
  virtual void OnStation(const Station& /*station*/) {}    ///< as sent
  virtual void OnStatus(const Status& /*status*/) {}       ///< once a second
  virtual void OnGlance(const Glance& /*glance*/) {}       ///< once a second
  virtual void OnAdvice(const Advice& /*advice*/) {}       ///< every few seconds, if asked for
  /// Stop was called and the session does not come to an end, because an adjustment takes long. The
  /// files in its folder are whole and nothing writes to them any more: the program may end here.
  /// `kept`: their verdict, the worst of the tools'; nothing: they hold no survey yet.
  virtual void OnStuck(const std::optional<RunVerdict>& /*kept*/) {}
};

}  // namespace wellgyro
