#include "wellgyro/survey/intake/plausible.h"

#include <cmath>
#include <cstddef>
#include <string_view>
#include <utility>

#include <fmt/core.h>

#include "wellgyro/record/limits.h"
#include "wellgyro/survey/job_rules.h"

namespace wellgyro {
namespace {

/// Collects the first thing that is wrong.
class Complaint {
 public:
  void Within(std::string_view field, double value, double low, double high) {
    // False also for what is no number.
    if (text_.empty() && !(value >= low && value <= high)) {
      text_ = fmt::format("{} = {}, which is outside [{}, {}]", field, value, low, high);
    }
  }
  void Short(std::string_view field, const std::string& value) {
    if (text_.empty() && value.size() > limits::kText) {
      text_ = fmt::format("{} bytes of {}, {} are allowed", value.size(), field, limits::kText);
    }
  }
  std::string text() && { return std::move(text_); }

 private:
  std::string text_;
};

std::string LeftOut(std::string_view what, const std::string& odd) {
  return odd.empty() ? odd : fmt::format("{} was left out: {}", what, odd);
}

}  // namespace

std::string WhyImplausible(const DepthMark& mark) {
  Complaint complaint;
  constexpr auto kUtc = static_cast<double>(limits::kUtcUs);
  complaint.Within("utime_us", static_cast<double>(mark.utc.ns) * 1e-3, -kUtc, kUtc);
  complaint.Within("md_m", mark.md, -limits::kMd, limits::kMd);
  complaint.Within("speed_mps", mark.speed.value_or(0), -limits::kSpeed, limits::kSpeed);
  complaint.Within("sigma_m", mark.sigma.value_or(0), 0, limits::kSigma);
  return LeftOut("a depth mark", std::move(complaint).text());
}

std::string WhyImplausible(const ToolInfo& info) {
  Complaint complaint;
  complaint.Within("sensor_below_reference_m", info.sensor_below_reference,
                   -limits::kSensorBelowReference, limits::kSensorBelowReference);
  complaint.Short("asset_serial", info.asset_serial);
  complaint.Short("sensor_serials", info.sensor_serials);
  complaint.Short("firmware", info.firmware);
  complaint.Short("calibration_sha256", info.calibration_sha256);
  return LeftOut("a description of a tool", std::move(complaint).text());
}

std::string WhyImplausible(const Command& command) {
  Complaint complaint;
  complaint.Within("duration_s", command.duration.value_or(0), 0, limits::kDuration);
  complaint.Within("md_m", command.md.value_or(0), -limits::kMd, limits::kMd);
  return LeftOut("a command", std::move(complaint).text());
}

std::string WhyImplausible(const Event& event) {
  const auto wrong = FindValueComplaint(event);
  return wrong ? LeftOut("an event", fmt::format("{}: {}", wrong->key, wrong->why)) : "";
}

}  // namespace wellgyro
