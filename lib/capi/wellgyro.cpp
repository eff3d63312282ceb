#include "wellgyro.h"

#include <algorithm>
#include <cstring>
#include <deque>
#include <exception>
#include <filesystem>
#include <memory>
#include <new>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "wellgyro/earth/grid.h"
#include "wellgyro/io/exchange/survey_csv.h"
#include "wellgyro/io/toml/job_file.h"
#include "wellgyro/survey/surveyor.h"

namespace {

using wellgyro::Fault;
using wellgyro::Quality;
using wellgyro::Station;

// What waits to be polled, and how much was refused.
class Mailbox : public wellgyro::Sink {
 public:
  void OnStation(const Station& station) override { waiting.push_back(station); }
  void OnFault(const Fault& fault) override {
    ++refused;
    last = SentenceOf(fault);
  }

  std::deque<Station> waiting;
  std::int64_t refused = 0;
  std::string last;
};

std::optional<wellgyro::DepthKind> KindOf(std::int32_t kind) {
  using wellgyro::DepthKind;
  constexpr DepthKind kKinds[] = {DepthKind::kIndicated, DepthKind::kWireline,
                                  DepthKind::kDrillPipe, DepthKind::kTubing, DepthKind::kOther};
  if (kind < 0 || kind >= static_cast<std::int32_t>(std::size(kKinds))) return std::nullopt;
  return kKinds[kind];
}

// Microseconds that nanoseconds can hold; what lies beyond is refused by the surveyor all the same.
wellgyro::UtcTime UtcOf(std::int64_t utime_us) {
  constexpr std::int64_t kMost = INT64_MAX / 1000;
  return {std::clamp(utime_us, -kMost, kMost) * 1000};
}

wellgyro::ImuSample SampleOf(const wellgyro_imu& from) {
  wellgyro::ImuSample to;
  to.stamp = {.tool_time = {from.tool_ns},
              .utc = UtcOf(from.utime_us),
              .seq = from.seq,
              .session = from.session,
              .run = from.run,
              .tool = from.tool,
              .period_ns = from.period_ns,
              .gyro_saturated = (from.flags & WELLGYRO_GYRO_SATURATED) != 0,
              .accel_saturated = (from.flags & WELLGYRO_ACCEL_SATURATED) != 0,
              .utc_unsynced = (from.flags & WELLGYRO_UTC_UNSYNCED) != 0,
              .temperature = from.temperature_degc};
  to.w_IT_T = Eigen::Vector3d(from.rate_rad_per_s);
  to.f_T = Eigen::Vector3d(from.force_mps2);
  to.b_T = Eigen::Vector3d(from.field_t);
  to.has_gz = (from.flags & WELLGYRO_HAS_GZ) != 0;
  to.has_mag = (from.flags & WELLGYRO_HAS_MAG) != 0;
  return to;
}

wellgyro::DepthMark MarkOf(const wellgyro_depth& from, wellgyro::DepthKind kind) {
  wellgyro::DepthMark to;
  to.utc = UtcOf(from.utime_us);
  to.seq = from.seq;
  to.session = from.session;
  to.run = from.run;
  to.kind = kind;
  to.md = from.md_m;
  // NaN goes on, and is refused.
  if (!(from.sigma_m < 0)) to.sigma = from.sigma_m;
  to.stopped = from.stopped != 0;
  return to;
}

void Copy(const Eigen::Matrix3d& from, double (&to)[9]) {
  for (int i = 0; i < 9; ++i) to[i] = from(i / 3, i % 3);
}

wellgyro_station StationOf(const Station& from) {
  wellgyro_station to{};
  to.utime_us = from.utc.ns / 1000;
  to.tool = from.tool;
  to.run = from.run;
  to.pass = static_cast<std::int32_t>(from.pass);
  to.pass_number = from.pass_number;
  to.number = from.number;
  to.revision = from.revision;
  to.status = static_cast<std::int32_t>(from.status);
  to.kind = static_cast<std::int32_t>(from.kind);
  to.quality = static_cast<std::uint32_t>(from.quality);
  to.md_m = from.md;
  to.inclination_rad = from.inclination;
  to.azimuth_true_rad = from.azimuth;
  to.toolface_rad = from.toolface;
  to.north_m = from.p_WT_W.x();
  to.east_m = from.p_WT_W.y();
  to.tvd_m = from.p_WT_W.z();
  Copy(from.cov_md_inc_azi, to.cov_md_inc_azi);
  Copy(from.cov_p_WT_W, to.cov_position_m2);
  return to;
}

wellgyro_directed_station DirectedOf(const Station& from) {
  wellgyro_directed_station to{};
  to.station = StationOf(from);
  for (int i = 0; i < 3; ++i) to.tangent[i] = from.tangent_L[i];
  Copy(from.cov_tangent_L, to.cov_tangent_rad2);
  return to;
}

constexpr bool Is(Quality quality, std::uint32_t bit) {
  return static_cast<std::uint32_t>(quality) == bit;
}
static_assert(Is(Quality::kGood, WELLGYRO_QUALITY_GOOD) &&
              Is(Quality::kMoved, WELLGYRO_QUALITY_MOVED) &&
              Is(Quality::kMirror, WELLGYRO_QUALITY_MIRROR) &&
              Is(Quality::kVertical, WELLGYRO_QUALITY_VERTICAL) &&
              Is(Quality::kSaturated, WELLGYRO_QUALITY_SATURATED) &&
              Is(Quality::kGap, WELLGYRO_QUALITY_GAP) &&
              Is(Quality::kDepth, WELLGYRO_QUALITY_DEPTH) &&
              Is(Quality::kTemperature, WELLGYRO_QUALITY_TEMPERATURE) &&
              Is(Quality::kAliased, WELLGYRO_QUALITY_ALIASED) &&
              Is(Quality::kGravity, WELLGYRO_QUALITY_GRAVITY) &&
              Is(Quality::kEarthRate, WELLGYRO_QUALITY_EARTH_RATE) &&
              Is(Quality::kClock, WELLGYRO_QUALITY_CLOCK) &&
              Is(Quality::kUnfit, WELLGYRO_QUALITY_UNFIT));

std::int32_t NumberOf(wellgyro::Verdict verdict) {
  switch (verdict) {
    case wellgyro::Verdict::kPass:
      return WELLGYRO_VERDICT_PASS;
    case wellgyro::Verdict::kWarn:
      return WELLGYRO_VERDICT_WARN;
    default:
      return WELLGYRO_VERDICT_FAIL;
  }
}

thread_local std::string opening_error;
constexpr const char* kDoesNotFit = "the text does not fit";

}  // namespace

struct wellgyro_session {
  explicit wellgyro_session(wellgyro::Job its_job) : job(std::move(its_job)) {
    if (job.grid) {
      grid.emplace(*job.grid, wellgyro::GeodeticPoint{.latitude = job.well.latitude,
                                                      .longitude = job.well.longitude});
    }
    surveyor.emplace(job, mailbox);
  }

  wellgyro::Job job;
  std::optional<wellgyro::WellGrid> grid;
  Mailbox mailbox;
  std::optional<wellgyro::Surveyor> surveyor;
  std::string error;
};

namespace {

// Runs `work`, which gives an answer and may leave a sentence in `error`; nothing it throws leaves.
template <class Work>
int Guard(std::string& error, const Work& work) noexcept {
  try {
    error.clear();
    return work();
  } catch (const std::bad_alloc&) {
    return WELLGYRO_INTERNAL;
  } catch (const std::exception& thrown) {
    try {
      error = thrown.what();
    } catch (...) {
      return WELLGYRO_INTERNAL;
    }
    return WELLGYRO_UNUSABLE;
  } catch (...) {
    return WELLGYRO_INTERNAL;
  }
}

int Refuse(std::string& error, const char* why) {
  error = why;
  return WELLGYRO_USAGE;
}

int RefuseNull() noexcept {
  return Guard(opening_error, [] { return Refuse(opening_error, "null session"); });
}

int Open(const wellgyro::Result<wellgyro::JobFile>& file, wellgyro_session** session) {
  if (!file) {
    opening_error = SentenceOf(file.fault());
    return WELLGYRO_UNUSABLE;
  }
  *session = std::make_unique<wellgyro_session>(file->job).release();
  return WELLGYRO_OK;
}

// Calls `push` with a running session; the sentence of what was refused stays.
template <class Push>
int PushInto(wellgyro_session* session, const void* data, std::size_t count,
             const Push& push) noexcept {
  if (!session) return RefuseNull();
  return Guard(session->error, [&] {
    if (!data && count > 0) return Refuse(session->error, "null data");
    if (session->surveyor->finished()) return Refuse(session->error, "the survey is finished");
    const std::int64_t before = session->mailbox.refused;
    push();
    if (session->mailbox.refused > before) session->error = session->mailbox.last;
    return int{WELLGYRO_OK};
  });
}

// Takes what waits as structs that `made` makes of it.
template <class Given, class Make>
int PollInto(wellgyro_session* session, Given* stations, std::size_t capacity, std::size_t* count,
             const Make& made) noexcept {
  if (count) *count = 0;
  if (!session) return RefuseNull();
  return Guard(session->error, [&] {
    if (!count || (!stations && capacity > 0)) return Refuse(session->error, "null stations");
    std::deque<Station>& waiting = session->mailbox.waiting;
    for (; *count < capacity && !waiting.empty(); waiting.pop_front()) {
      stations[(*count)++] = made(waiting.front());
    }
    return int{WELLGYRO_OK};
  });
}

// `from` with its ending zero into `text`; false: it does not fit.
bool Fits(const std::string& from, char* text, std::size_t capacity, std::size_t& size) {
  size = from.size() + 1;
  if (capacity < size) return false;
  std::memcpy(text, from.c_str(), size);
  return true;
}

}  // namespace

extern "C" {

const char* wellgyro_version(void) { return WELLGYRO_VERSION; }

int wellgyro_open(const char* path, wellgyro_session** session) {
  return Guard(opening_error, [&] {
    if (session) *session = nullptr;
    if (!path || !session) return Refuse(opening_error, "null path or session");
    return Open(wellgyro::ReadJob(path), session);
  });
}

int wellgyro_open_text(const char* text, const char* folder, wellgyro_session** session) {
  return Guard(opening_error, [&] {
    if (session) *session = nullptr;
    if (!text || !folder || !session) return Refuse(opening_error, "null text, folder or session");
    return Open(wellgyro::ParseJob(text, "job", folder), session);
  });
}

int wellgyro_push_imu(wellgyro_session* session, const wellgyro_imu* samples, size_t count) {
  return PushInto(session, samples, count, [&] {
    for (const wellgyro_imu& sample : std::span(samples, count)) {
      session->surveyor->Push(SampleOf(sample));
    }
  });
}

int wellgyro_push_depth(wellgyro_session* session, const wellgyro_depth* marks, size_t count) {
  return PushInto(session, marks, count, [&] {
    for (const wellgyro_depth& mark : std::span(marks, count)) {
      if (const auto kind = KindOf(mark.kind)) {
        session->surveyor->Push(MarkOf(mark, *kind));
      } else {
        session->mailbox.OnFault(Fault{
            wellgyro::FaultCode::kRange,
            fmt::format("a depth mark has kind {}, which is none, and was left out", mark.kind)});
      }
    }
  });
}

int wellgyro_poll(wellgyro_session* session, wellgyro_station* stations, size_t capacity,
                  size_t* count) {
  return PollInto(session, stations, capacity, count, StationOf);
}

int wellgyro_poll_directed(wellgyro_session* session, wellgyro_directed_station* stations,
                           size_t capacity, size_t* count) {
  return PollInto(session, stations, capacity, count, DirectedOf);
}

int64_t wellgyro_refused(const wellgyro_session* session) {
  return session ? session->mailbox.refused : 0;
}

int wellgyro_adjust(wellgyro_session* session) {
  return PushInto(session, nullptr, 0, [&] { session->surveyor->Adjust(); });
}

int wellgyro_finish(wellgyro_session* session) {
  const int pushed = PushInto(session, nullptr, 0, [&] { session->surveyor->Finish(); });
  if (pushed != WELLGYRO_OK) return pushed;
  return Guard(session->error, [&] {
    for (const std::int32_t tool : session->surveyor->tools()) {
      if (session->surveyor->Current(tool).unusable.empty()) return int{WELLGYRO_OK};
    }
    const auto tools = session->surveyor->tools();
    session->error = session->surveyor->Current(tools.empty() ? 0 : tools.front()).unusable;
    return int{WELLGYRO_UNUSABLE};
  });
}

int wellgyro_verdict(wellgyro_session* session, int32_t tool, int32_t* verdict, char* causes,
                     size_t capacity, size_t* size) {
  if (size) *size = 0;
  if (verdict) *verdict = WELLGYRO_VERDICT_FAIL;
  if (!session) return RefuseNull();
  return Guard(session->error, [&] {
    if (!verdict) return Refuse(session->error, "null verdict");
    if (!causes && capacity > 0) return Refuse(session->error, "null causes");
    if (causes && !size) return Refuse(session->error, "null size");
    const wellgyro::Survey survey = session->surveyor->Current(tool);
    if (!survey.unusable.empty()) {
      session->error = survey.unusable;
      return int{WELLGYRO_UNUSABLE};
    }
    *verdict = NumberOf(survey.verdict.verdict);
    if (!size) return int{WELLGYRO_OK};
    const std::string lines = fmt::format("{}", fmt::join(survey.verdict.causes, "\n"));
    if (!Fits(lines, causes, capacity, *size)) return Refuse(session->error, kDoesNotFit);
    return int{WELLGYRO_OK};
  });
}

int wellgyro_survey_csv(wellgyro_session* session, int32_t tool, char* text, size_t capacity,
                        size_t* size) {
  if (size) *size = 0;
  if (!session) return RefuseNull();
  return Guard(session->error, [&] {
    if (!size || (!text && capacity > 0)) return Refuse(session->error, "null text or size");
    const wellgyro::Survey survey = session->surveyor->Current(tool);
    if (!survey.unusable.empty()) {
      session->error = survey.unusable;
      return int{WELLGYRO_UNUSABLE};
    }
    const std::string csv =
        wellgyro::SurveyCsv(survey.chosen, session->grid ? &*session->grid : nullptr);
    if (!Fits(csv, text, capacity, *size)) return Refuse(session->error, kDoesNotFit);
    return int{WELLGYRO_OK};
  });
}

const char* wellgyro_error(const wellgyro_session* session) {
  return session ? session->error.c_str() : opening_error.c_str();
}

void wellgyro_close(wellgyro_session* session) { delete session; }

}  // extern "C"
