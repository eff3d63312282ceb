#include "wellgyro/survey/verdict/verdict.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string_view>
#include <utility>

#include <fmt/core.h>

#include "wellgyro/math/statistics.h"
#include "wellgyro/record/unknown_angle.h"

namespace wellgyro {
namespace {

// So many causes of one kind say it all; the rest stand in checks.csv.
constexpr std::size_t kCausesListed = 12;
// Squares over freedom that are no fault yet: an hour's record tells white noise to some 7 %, and
// of thousands of rows chance alone would fail for less.
constexpr double kNoiseTold = 1.15;
// Least probability for which a limit is taken from the normal distribution or chi-square: further
// out in the tails real errors are neither.
constexpr double kLeastShare = 1e-7;

bool ByChance(const Check& check) {
  return check.looks > 0 && check.value && check.verdict != Verdict::kNotDone;
}

/// |value| that chance exceeds with `share`.
double LimitOf(const Check& check, double share) {
  const double p = std::clamp(share, kLeastShare, 0.5);
  if (check.freedom > 0) return ChiSquareQuantile(1 - p, check.freedom) / check.freedom;
  return -NormalQuantile(p / 2) * check.sigma.value_or(0);
}

/// The checks of one run whose limit is one of chance. Each kind has the same share of the rate, so
/// that what is looked at in many places at once does not take it from what is looked at once.
class Family {
 public:
  void Add(const Check& check) { looks_[check.code] += check.looks; }
  /// Once all are added: squares of so many rows that chance never takes them as far as
  /// kNoiseTold hold no share of the rate.
  void Count(const Check& check) {
    if (check.freedom > 0 && !(LimitOf(check, Share(looks_.size(), check)) > kNoiseTold)) return;
    failing_.insert(check.code);
  }
  void Judge(Check& check) const {
    const double warn = LimitOf(check, 10 * Share(looks_.size(), check));
    const bool fails = failing_.contains(check.code);
    const double least = check.freedom > 0 ? kNoiseTold : 0;
    check.limit = fails ? std::max(LimitOf(check, Share(failing_.size(), check)), least) : least;
    check.limit_source = fails ? WordsOf(check) : "what is known of noise, beyond all chance";
    const double size = std::abs(*check.value);
    check.verdict = !(size <= *check.limit) ? Verdict::kFail
                    : !(size <= warn)       ? Verdict::kWarn
                                            : Verdict::kPass;
  }

 private:
  double Share(std::size_t kinds, const Check& check) const {
    return kFalseAlarmRate / static_cast<double>(kinds) / looks_.at(check.code);
  }
  std::string WordsOf(const Check& check) const {
    const double looks = looks_.at(check.code);
    std::string text =
        fmt::format("{:g} % of clean runs, shared by {} kind{} of comparison",
                    100 * kFalseAlarmRate, failing_.size(), failing_.size() == 1 ? "" : "s");
    if (looks > 1) text += fmt::format(", {:.0f} of this kind", looks);
    if (check.looks > 1) text += fmt::format(", {:.0f} here", check.looks);
    return text;
  }

  std::map<std::string, double> looks_;  ///< comparisons of each kind
  std::set<std::string> failing_;        ///< kinds that chance can fail
};

struct CodeWords {
  std::string_view code, words;
};

// What a check that fails says, by the begin of its code; the longest that fits holds.
constexpr CodeWords kCodeWords[] = {
    {"accel_bias", "an accelerometer's bias is beyond its prior"},
    {"accel_dead", "an accelerometer axis does not answer"},
    {"accel_saturated", "accelerometers reached full scale"},
    {"accel_spikes", "single accelerometer samples are impossible beside their neighbours"},
    {"accel_truncated", "the accelerometers' numbers are cut towards zero"},
    {"accel_unit", "the accelerometers' unit or scale is wrong"},
    {"accel_stuck", "an accelerometer axis repeats one value"},
    {"azimuth_closure", "the run's azimuth and the north of a stop differ"},
    {"azimuth_in_out", "azimuths on the way in and out differ"},
    {"azimuth_tie", "the azimuth from outside is not the gyros' own where it holds"},
    {"azimuth_repeat", "azimuths of the repeat section differ"},
    {"azimuth_runs", "azimuths of this run and of one before it differ"},
    {"axes", "axes of the tool are swapped or inverted"},
    {"axes_change", "axes of the tool are swapped or inverted for a while"},
    {"bias_repeatability", "the gyros' bias changed between stops"},
    {"calibration_date", "the tool's calibration has expired"},
    {"calibration_date_ahead", "the tool was calibrated after the run"},
    {"clock_jumps", "the tool's clock jumps"},
    {"clock_unsynced", "UTC of samples is doubtful"},
    {"compare_azimuth", "azimuths differ by more than the errors of both surveys"},
    {"compare_azimuth_offset", "the azimuths of one survey are turned against the other's"},
    {"compare_depth_offset", "the depths of one survey are shifted against the other's"},
    {"compare_depth_stretch", "the depths of one survey are stretched against the other's"},
    {"compare_extent", "most of what both surveys have was not compared"},
    {"compare_inclination", "inclinations differ by more than the errors of both surveys"},
    {"compare_position", "places differ by more than the errors of both surveys"},
    {"depth_closure", "depth does not return to zero"},
    {"depth_lag", "depth comes late or early against the motion that the accelerometers feel"},
    {"depth_jump", "depth jumps where the accelerometers feel no motion"},
    {"depth_refused", "depth marks were left out"},
    {"depth_reversed", "depth grows where the tool goes up, or has the other sign"},
    {"depth_scale", "the scale of depth is unverified"},
    {"depth_scale_felt", "depth and the way that the accelerometers feel differ in scale"},
    {"depth_slip", "depth slips on the way"},
    {"depth_slippage", "depth does not return to zero as practice asks"},
    {"depth_unit", "the unit or scale of depth is wrong"},
    {"depth_unknown", "depth is missing"},
    {"depth_unsure", "depth between marks is not known well enough"},
    {"depth_without_station", "hole that was passed has no station"},
    {"diagnosis", "the run shows a fault"},
    {"drift_closure", "the run does not close on the north of its last stop"},
    {"earth_rate", "the gyros at rest do not read the Earth's rate"},
    {"fit", "the run as a whole does not fit together"},
    {"fit_azimuth", "azimuths given from outside do not fit the run"},
    {"fit_force", "accelerometers and gravity disagree on the way"},
    {"fit_inclination", "gyros and accelerometers disagree on the way"},
    {"fit_rest", "the gyros at rest and on the way disagree"},
    {"foresight", "the run and the foresight differ"},
    {"gravity", "the accelerometers at rest do not read gravity"},
    {"grid", "the job's grid figures are not the projection's"},
    {"gyro_bias", "a gyro's bias is beyond its prior"},
    {"gyro_dead", "a gyro axis does not answer"},
    {"gyro_misalignment", "a gyro's misalignment is beyond its prior"},
    {"gyro_saturated", "gyros reached full scale"},
    {"gyro_scale", "a gyro's scale is beyond its prior"},
    {"gyro_spikes", "single gyro samples are impossible beside their neighbours"},
    {"gyro_stuck", "a gyro axis repeats one value"},
    {"gyro_truncated", "the gyros' numbers are cut towards zero"},
    {"gyro_unit", "the gyros' unit or scale is wrong"},
    {"hidden_roll",
     "the tool rolls too fast where gravity does not show it: slow down, or use a "
     "third gyro axis"},
    {"inclination_in_out", "inclinations on the way in and out differ"},
    {"inclination_repeat", "inclinations of the repeat section differ"},
    {"inclination_runs", "inclinations of this run and of one before it differ"},
    {"latitude", "the gyros at rest tell another latitude than the job"},
    {"magnetic_azimuth", "gyro and magnetic azimuth differ"},
    {"magnetic_marks", "the cable slips between magnetic marks"},
    {"mass_unbalance", "the gyros' mass unbalance is beyond its prior"},
    {"noise_stated", "the job states no [noise]"},
    {"quadrature", "the gyros' quadrature is beyond its prior"},
    {"rest_motion", "the tool moved at a stop"},
    {"roll_at_rest", "the tool turned at a stop"},
    {"samples_aliased", "rotation too fast for the sampling"},
    {"samples_lost", "samples are missing"},
    {"samples_refused", "samples were left out"},
    {"stated_unmet", "the samples do not meet what the job states"},
    {"stations_asked", "stations asked for are missing"},
    {"stations_without_azimuth", "stations have no azimuth"},
    {"temperature_outside", "temperature outside the calibrated range"},
    {"tie_in", "the tie-in and the run disagree where they meet"},
    {"tie_in_place", "the place of the tie-in is not stated, or none that the hole reaches"},
    {"tie_in_way", "the tie-in is not where the run's own way from the well head leads"},
    {"time_skew", "the clocks of gyros and accelerometers differ beyond the prior"},
    {"tool_upside_down",
     "the tool is upside down, or its accelerometers read gravity with the other sign"},
    {"toolface_offset", "gyros and accelerometers are turned against each other beyond the prior"},
};

std::string_view WordsFor(std::string_view code) {
  std::string_view words, longest;
  for (const CodeWords& entry : kCodeWords) {
    if (!code.starts_with(entry.code) || entry.code.size() < longest.size()) continue;
    longest = entry.code;
    words = entry.words;
  }
  return words;
}

bool IsOf(const Check& check, std::int32_t run) { return check.run == run || check.run == 0; }

/// Causes of what `take` takes, failing ones first.
template <class Take>
RunVerdict VerdictOf(std::span<const Check> checks, Take take) {
  RunVerdict verdict;
  for (const Verdict wanted : {Verdict::kFail, Verdict::kWarn}) {
    std::map<std::string, std::size_t> told;  // how many of each code
    for (const Check& check : checks) {
      if (check.verdict != wanted || !take(check)) continue;
      if (verdict.verdict == Verdict::kPass) verdict.verdict = wanted;
      if (++told[check.code] > 1 || verdict.causes.size() >= kCausesListed) continue;
      verdict.causes.push_back(CauseOf(check));
    }
  }
  return verdict;
}

}  // namespace

void ShareFalseAlarms(std::vector<Check>& checks) {
  std::map<std::int32_t, Family> families;
  for (const Check& check : checks) {
    if (ByChance(check)) families[check.run].Add(check);
  }
  for (const Check& check : checks) {
    if (ByChance(check)) families[check.run].Count(check);
  }
  for (Check& check : checks) {
    if (ByChance(check)) families[check.run].Judge(check);
  }
}

RunVerdict VerdictOfRun(std::span<const Check> checks, std::int32_t run) {
  return VerdictOf(checks, [run](const Check& check) { return IsOf(check, run); });
}

void MakeUnfit(const Station& tie_in, Station& station) {
  const double way = station.md - tie_in.md;
  station.quality |= Quality::kUnfit;
  station.cov_p_WT_W = tie_in.cov_p_WT_W + way * way * Eigen::Matrix3d::Identity();
  station.cov_md_inc_azi =
      Eigen::Vector3d(way * way, kUnknownAngleVariance, kUnknownAngleVariance).asDiagonal();
  station.cov_tangent_L = kUnknownAngleVariance * Eigen::Matrix3d::Identity();
}

void GiveVerdict(Survey& survey) {
  std::set<std::int32_t> failed, chosen;
  for (RunSummary& run : survey.runs) {
    run.verdict = VerdictOfRun(survey.checks, run.run);
    if (run.verdict.verdict == Verdict::kFail) failed.insert(run.run);
  }
  Station tie_in;
  if (!survey.chosen.empty() && survey.chosen.front().kind == StationKind::kTieIn) {
    tie_in = survey.chosen.front();
  }
  for (std::vector<Station>* stations : {&survey.chosen, &survey.passes}) {
    for (Station& s : *stations) {
      if (s.kind == StationKind::kTieIn) continue;
      if (stations == &survey.chosen) chosen.insert(s.run);
      if (failed.contains(s.run)) MakeUnfit(tie_in, s);
    }
  }
  survey.verdict = VerdictOf(std::span<const Check>(survey.checks), [&](const Check& check) {
    return check.run == 0 || chosen.contains(check.run);
  });
}

std::string CauseOf(const Check& check) {
  std::string place = check.code;
  if (check.run > 0) place += fmt::format(", run {}", check.run);
  if (check.md) place += fmt::format(", MD {:.2f} m", *check.md);
  const std::string unit = check.unit == "1" || check.unit.empty() ? "" : " " + check.unit;
  if (check.value && check.limit) {
    // A warning of chance is told below the limit at which it fails.
    const bool below = check.verdict == Verdict::kWarn && std::abs(*check.value) < *check.limit;
    place += fmt::format(": {}{}, {} {}", ShortNumber(*check.value, 3), unit,
                         below ? "fails beyond" : "limit", ShortNumber(*check.limit, 3));
  } else if (!check.limit_source.empty()) {
    place += ": " + check.limit_source;
  }
  const std::string_view words = WordsFor(check.code);
  return words.empty() ? place : fmt::format("{} ({})", words, place);
}

std::string ShortNumber(double value, int digits) {
  const double size = std::abs(value);
  const bool whole = size >= std::pow(10, digits) && size < 1e9;
  return whole ? fmt::format("{:.0f}", value) : fmt::format("{:.{}g}", value, digits);
}

}  // namespace wellgyro
