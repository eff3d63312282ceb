#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"
#include "wellgyro/base/time.h"
#include "wellgyro/record/advice.h"
#include "wellgyro/record/glance.h"
#include "wellgyro/record/noise.h"
#include "wellgyro/record/operations.h"
#include "wellgyro/record/station.h"

namespace wellgyro {

/// What azimuth a stop is to have, and what that depends on beside the hole.
struct SigmaAsked {
  double sigma_azimuth = 0;  ///< [rad]
  NoiseCoefficients gyro;
  double latitude = 0;  ///< [rad]
};

/// What the readers of a live page are told, as server-sent events with JSON in them: lib/docs/
/// live-page.md names each.
///
/// What replaces something stands in its slot - the glance, a station by its tool, run and time -
/// and of a slot only the newest is kept, so that who reads slowly misses steps, never the state,
/// and memory grows with the stations alone. One thread puts (PutDocument may be another's); any
/// number reads, and none of them can hold up the one that puts for longer than it takes to copy a
/// few pointers.
class WELLGYRO_EXPORT LiveFeed {
 public:
  static constexpr std::size_t kNoticesKept = 200;  ///< of more the oldest are not shown
  /// A station each metre of four passes of the longest well is less; some 0.3 kB each, 15 MB.
  static constexpr std::size_t kStationsKept = 50'000;
  static constexpr std::size_t kAtOnce = 1 << 16;  ///< bytes a reader is given, about

  /// `epoch` names this run of the program: numbers of another one mean nothing here. Of more than
  /// `stations_kept` stations the oldest go.
  explicit LiveFeed(std::int64_t epoch, std::size_t stations_kept = kStationsKept)
      : epoch_(epoch), stations_kept_(stations_kept) {}
  /// Glances say from now on how long a stop must last for that (RestForSigma).
  void Ask(const SigmaAsked& asked) { asked_ = asked; }

  void Put(const Station& station);
  void Put(const Glance& glance);
  void Put(const Status& status);
  void Put(const Advice& advice);
  /// A sentence for the person on the rig, said at `utc_us`.
  void Say(std::string_view sentence, std::int64_t utc_us);
  /// Of a survey.json what changes while a survey runs: checks, diagnosis, differences of passes,
  /// verdict, operations. `part` tells the tools of one string apart. Fault kSyntax.
  [[nodiscard]] std::optional<Fault> PutDocument(const std::string& part,
                                                 std::string_view survey_json);
  /// How the survey ended; nothing comes behind it.
  void PutEnd(std::string_view how, std::string_view verdict);

  /// Wakes the readers for what was put since: once for many things.
  void Publish();
  /// No more is coming: readers are not held any longer.
  void Close();
  bool closed() const;

  /// A place in the feed.
  struct Place {
    std::int64_t number = 0;
  };
  /// Where the reader is who names the last event it had, as "EPOCH-NUMBER"; the begin for others.
  Place PlaceOf(std::string_view last_event_id) const;
  /// The first event of every reader: who speaks, and what the numbers of a station are.
  std::string Hello() const;
  /// Events behind `place`, which moves on; waits for one, empty where none came in time.
  std::string After(Place& place, Duration wait) const;

 private:
  void PutIn(const std::string& slot, std::string_view event, const std::string& json);
  using Text = std::shared_ptr<const std::string>;
  const std::int64_t epoch_;
  const std::size_t stations_kept_;
  std::optional<SigmaAsked> asked_;
  mutable std::mutex mutex_;
  mutable std::condition_variable woken_;
  std::map<std::int64_t, Text> events_;        ///< by number, what is newest in its slot
  std::map<std::string, std::int64_t> slots_;  ///< the number in each
  std::int64_t last_ = 0;                      ///< put
  std::int64_t notices_ = 0;
  std::map<std::int64_t, std::string> stations_;  ///< slots by the number of their first event
  std::map<std::string, std::string> documents_;  ///< by slot, to leave out what has not changed
  bool closed_ = false;
};

}  // namespace wellgyro
