#include "wellgyro/io/sensor/gyro_raw.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include <fmt/core.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/base/units.h"
#include "wellgyro/earth/earth.h"
#include "wellgyro/io/iso_time_internal.h"
#include "wellgyro/io/text_file.h"

namespace wellgyro {
namespace {

// Inclination by the accelerometers against the one stated: uncorrected accelerometers and sag are
// off by less. The wrong sign gives 180 deg - I, which agrees too only where I is within 2 deg of
// horizontal.
constexpr double kAgree = FromDegrees(2);
// Earth's rate along the vertical, Omega sin L, that tells up from down there: 8 deg of latitude.
// Half of it is more than gyros of some tenths of a deg/h are off by, and what a third axis that
// is not there would add, 15 sin 2 deg = 0.5 deg/h.
constexpr double kTellsUp = 2 * units::kDegPerHour;
// Least sigmas, of records that state none by jobs that state no noise: what their digits round,
// 0.04 deg of azimuth at the equator and 6e-4 deg of inclination.
constexpr double kRateLeast = 0.01 * units::kDegPerHour;
constexpr double kForceLeast = 1e-4;  // [m/s^2]
// From the end of a record without a time to the next, which has none either: only the order
// counts.
constexpr std::int64_t kMinuteNs = 60'000'000'000;

double InclinationOf(const Eigen::Vector3d& f, double sign) {
  return std::atan2(std::hypot(f.x(), f.y()), -sign * f.z());
}

/// 2026:01:15:06:12:00.5, as P7/17 writes it, or ISO 8601; UTC where no zone is given.
std::optional<UtcTime> TimeOf(std::string text) {
  if (text.size() >= 19 && text[4] == ':' && text[7] == ':' && text[10] == ':') {
    text[4] = text[7] = '-';
    text[10] = 'T';
  }
  auto seconds = UtcOf(text);
  if (!seconds) seconds = UtcOf(text + "Z");
  if (!seconds || !(std::abs(*seconds) < 4e9)) return std::nullopt;
  return UtcTime{} + Duration::Seconds(*seconds);
}

/// The same of records that are horizontal, by the Earth's rate: w f / |f|, f specific force, is
/// Omega sin L.
Result<double> SignByEarthRate(const std::vector<GyroRawRecord>& records, double latitude) {
  double sum = 0, count = 0;
  for (const GyroRawRecord& g : records) {
    if (!g.used) continue;
    sum += g.w.dot(g.f.stableNormalized());
    count += 1;
  }
  const double up = kEarthRate * std::sin(latitude), along = sum / count;
  for (const double sign : {1.0, -1.0}) {
    if (std::abs(up) >= kTellsUp && std::abs(sign * along - up) < std::abs(up) / 2) return sign;
  }
  return Fault{.code = FaultCode::kConflict,
               .text = fmt::format(
                   "all G7 records are horizontal, where gravity and specific force have the "
                   "same inclination, and the rate along the accelerometers' vertical, "
                   "{:.2f} deg/h, where the Earth's is {:.2f}, does not tell them apart: "
                   "keep a record at another inclination in the file",
                   along / units::kDegPerHour, up / units::kDegPerHour)};
}

/// +1: specific force, -1: gravity; by what the file says of its own inclinations.
Result<double> SignOfForce(const std::vector<GyroRawRecord>& records, double latitude) {
  double worst[2] = {0, 0};
  int number = 0;
  for (const GyroRawRecord& g : records) {
    if (!g.used) continue;
    for (const int i : {0, 1}) {
      const double off = std::abs(InclinationOf(g.f, i == 0 ? 1 : -1) - g.inclination);
      if (off > worst[i]) {
        worst[i] = off;
        number = g.number;
      }
    }
  }
  if (std::max(worst[0], worst[1]) <= kAgree) return SignByEarthRate(records, latitude);
  if (worst[0] <= kAgree) return 1.0;
  if (worst[1] <= kAgree) return -1.0;
  return Fault{
      .code = FaultCode::kConflict,
      .text = fmt::format("G7 record {}: its accelerometers give another inclination than it "
                          "states; axes must be x and y across the tool and z down-hole",
                          number)};
}

}  // namespace

Result<std::vector<StillWindow>> WindowsOfGyroRaw(const SurveyTable& table, const Job& job) {
  const std::vector<GyroRawRecord>& records = table.head.gyro_raw;
  if (std::ranges::none_of(records, &GyroRawRecord::used)) {
    return Fault{.code = FaultCode::kLost, .text = "it holds no G7 record that is used"};
  }
  const Result<double> sign = SignOfForce(records, job.well.latitude);
  if (!sign) return sign.fault();
  const bool third = std::ranges::any_of(records, [](const auto& g) { return g.w.z() != 0; });
  const double seconds = job.alignment.min_still;
  const double rate = std::max(job.noise.angle_random_walk / std::sqrt(seconds), kRateLeast);
  const double force = std::max(job.errors.accel_noise / std::sqrt(seconds), kForceLeast);
  std::vector<StillWindow> windows;
  std::int64_t next_ns = 0;
  for (const GyroRawRecord& g : records) {
    if (!g.used) continue;
    StillWindow window;
    window.utc_begin = TimeOf(g.time).value_or(UtcTime{next_ns});
    window.utc_end = window.utc_begin + Duration::Seconds(seconds);
    next_ns = window.utc_begin.ns + kMinuteNs + Duration::Seconds(seconds).ns;
    window.f_T = *sign * g.f;
    window.w_IT_T = g.w;
    window.has_gz = third;
    window.sigma_w_IT_T.setConstant(rate);
    window.sigma_f_T.setConstant(force);
    if (!third) window.w_IT_T[2] = window.sigma_w_IT_T[2] = 0;
    window.md = g.md;
    windows.push_back(window);
  }
  return windows;
}

bool IsIogpFile(const std::filesystem::path& path) {
  const Result<std::string> head = ReadTextHead(path, 8);
  if (!head) return false;
  std::string_view text = *head;
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  return text.starts_with("IOGP,");
}

}  // namespace wellgyro
