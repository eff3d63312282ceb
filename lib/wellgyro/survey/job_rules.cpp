#include "wellgyro/survey/job_rules.h"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <utility>
#include <vector>

#include <Eigen/Eigenvalues>
#include <fmt/core.h>

#include "wellgyro/survey/job_keys.h"

namespace wellgyro {
namespace {

/// Keeps the first thing that is wrong with one table.
class TableRules {
 public:
  explicit TableRules(std::string_view table) : table_(table) {}

  void Number(std::string_view key, double value) { Take(key, ComplaintOf(value, RangeOf(key))); }
  void Whole(std::string_view key, std::int64_t value) {
    Take(key, ComplaintOfWhole(value, RangeOf(key)));
  }
  void Time(std::string_view key, UtcTime utc) {
    // Downwards, so that half a microsecond before 1970 is before it.
    Whole(key, utc.ns / 1000 - (utc.ns % 1000 < 0 ? 1 : 0));
  }
  void Text(std::string_view key, const std::string& text) {
    const NumberRange& bytes = RangeOf(key);
    if (!ComplaintOfWhole(static_cast<std::int64_t>(text.size()), bytes)) return;
    Refuse(key, fmt::format("has {} bytes, {} are allowed", text.size(), TextOf(bytes)));
  }
  /// An enumeration may hold any number in a program.
  template <class Word>
  void OneOf(std::string_view key, Word value, Word first, Word last) {
    if (value >= first && value <= last) return;
    Refuse(key, fmt::format("{} is none of its values", static_cast<int>(value)));
  }
  /// `depths` [m] increase from one to the next.
  void Increasing(std::string_view key, const std::vector<double>& depths) {
    for (std::size_t i = 1; i < depths.size(); ++i) {
      if (depths[i] > depths[i - 1]) continue;
      Refuse(key, fmt::format("{} after {}: depths must increase", depths[i], depths[i - 1]));
    }
  }
  void Refuse(std::string_view key, std::string why, FaultCode code = FaultCode::kRange,
              std::string_view other = "") {
    if (!first_) first_ = KeyComplaint{key, std::move(why), code, other};
  }
  void Take(std::string_view key, std::optional<std::string> why) {
    if (why) Refuse(key, *std::move(why));
  }

  std::optional<KeyComplaint> first() && { return std::move(first_); }

 private:
  const NumberRange& RangeOf(std::string_view key) const { return JobKeyOf(table_, key).range; }

  std::string_view table_;
  std::optional<KeyComplaint> first_;
};

/// The value that an event of this kind says nothing without, and the kind's name; empty: none.
std::pair<std::string_view, std::string_view> NeededBy(Event::Kind kind) {
  switch (kind) {
    case Event::Kind::kDepthRezero:
      return {"value_m", "depth_rezero"};
    case Event::Kind::kDepthTie:
      return {"value_m", "depth_tie"};
    case Event::Kind::kForesight:
      return {"value_rad", "foresight"};
    default:
      return {};
  }
}

void CheckValues(const Event& event, TableRules& rules) {
  if (const auto [key, kind] = NeededBy(event.kind); !key.empty() && !event.has_value) {
    rules.Refuse(key, fmt::format("is missing, which {} needs", kind));
  }
  rules.Number("value_m", event.value_m);
  rules.Number("sigma_m", event.sigma_m);
  rules.Number("value_rad", event.value_rad);
  rules.Number("sigma_rad", event.sigma_rad);
  rules.Text("what", event.what);
  rules.Text("who", event.who);
  rules.Text("text", event.text);
}

}  // namespace

std::optional<KeyComplaint> FindKeyComplaint(const GridSpec& grid) {
  using Projection = GridSpec::Projection;
  TableRules rules("grid");
  rules.OneOf("projection", grid.projection, Projection::kTransverseMercator,
              Projection::kPolarStereographic);
  return std::move(rules).first();
}

std::optional<KeyComplaint> FindKeyComplaint(const TieIn& tie_in) {
  TableRules rules("tie_in");
  if (tie_in.md != 0 && !tie_in.tvd) {
    rules.Refuse("tvd_m", "is missing beside md_m: how deep the tie-in is, is not guessed");
  }
  if (tie_in.inclination && !tie_in.azimuth) {
    rules.Refuse("azimuth_true_deg", "is missing beside inclination_deg");
  }
  if (tie_in.azimuth && !tie_in.inclination) {
    rules.Refuse("inclination_deg", "is missing beside azimuth_true_deg");
  }
  return std::move(rules).first();
}

std::optional<KeyComplaint> FindKeyComplaint(const Channels& channels) {
  TableRules rules("channels");
  std::vector<const JobKey*> before;
  for (const JobKey& key : JobKeys()) {
    if (!key.channel) continue;
    const std::string& name = channels.*key.channel;
    rules.Text(key.key, name);
    for (const JobKey* const other : before) {
      if (name != channels.*other->channel) continue;
      rules.Refuse(key.key,
                   fmt::format("\"{}\" is the channel of {} and of {}", name, other->key, key.key),
                   FaultCode::kConflict, other->key);
    }
    before.push_back(&key);
  }
  return std::move(rules).first();
}

std::optional<KeyComplaint> FindKeyComplaint(const AlignmentSpec& alignment) {
  using Method = AlignmentSpec::Method;
  using Of = AlignmentSpec::Of;
  TableRules rules("alignment");
  rules.OneOf("method", alignment.method, Method::kGyrocompass, Method::kExternal);
  rules.OneOf("of", alignment.of, Of::kAxis, Of::kMark);
  if (alignment.at_utc) rules.Time("at_utime_us", *alignment.at_utc);
  if (alignment.method == Method::kExternal && alignment.at_md && alignment.at_utc) {
    rules.Refuse("at_md_m", "stands beside at_utime_us; only one of them can hold",
                 FaultCode::kConflict);
  }
  return std::move(rules).first();
}

std::optional<KeyComplaint> FindKeyComplaint(const AttitudeSpec& attitude) {
  using Order = AttitudeSpec::Order;
  TableRules rules("attitude");
  rules.OneOf("order", attitude.order, Order::kSecond, Order::kThird);
  return std::move(rules).first();
}

std::optional<KeyComplaint> FindKeyComplaint(const StationSpec& stations) {
  TableRules rules("stations");
  for (const double md : stations.at) rules.Number("at_m", md);
  rules.Increasing("at_m", stations.at);
  if (stations.every == 0 && stations.at.empty() && !stations.at_stops) {
    rules.Refuse("every_m", "asks for no station: give every_m, at_m or at_stops = true",
                 FaultCode::kRange, "at_m");
  }
  return std::move(rules).first();
}

std::optional<KeyComplaint> FindKeyComplaint(const DepthSpec& depth) {
  TableRules rules("depth");
  rules.OneOf("kind", depth.kind, DepthKind::kIndicated, DepthKind::kOther);
  const NumberRange& added = JobKeyOf("depth", "corrections").second;
  std::vector<double> depths;
  for (const auto& [md, correction] : depth.corrections) {
    rules.Number("corrections", md);
    rules.Take("corrections", ComplaintOf(correction, added));
    depths.push_back(md);
  }
  rules.Increasing("corrections", depths);
  return std::move(rules).first();
}

std::optional<KeyComplaint> FindKeyComplaint(const Event& event) {
  TableRules rules("event");
  rules.Time("utime_us", event.utc);
  rules.Whole("seq", event.seq);
  rules.Whole("session", event.session);
  rules.Whole("run", event.run);
  rules.Whole("event_id", event.event_id);
  rules.OneOf("event", event.kind, Event::Kind::kDepthZero, Event::Kind::kRemark);
  CheckValues(event, rules);
  return std::move(rules).first();
}

std::optional<KeyComplaint> FindKeyComplaint(std::span<const RunSpec> runs) {
  TableRules rules("run");
  const RunSpec& run = runs.back();
  rules.Whole("number", run.number);
  if (run.begin) rules.Time("begin_utime_us", *run.begin);
  if (run.end) rules.Time("end_utime_us", *run.end);
  if (run.begin && run.end && !(*run.end > *run.begin)) {
    rules.Refuse("end_utime_us", "must be later than begin_utime_us");
  }
  for (const RunSpec& before : runs.first(runs.size() - 1)) {
    if (before.number != run.number) continue;
    rules.Refuse("number", fmt::format("{} stands twice", run.number), FaultCode::kConflict);
  }
  return std::move(rules).first();
}

std::optional<KeyComplaint> FindValueComplaint(const Event& event) {
  TableRules rules("event");
  CheckValues(event, rules);
  return std::move(rules).first();
}

std::optional<std::string> FindCovarianceComplaint(const Eigen::Matrix3d& cov_p_WT_W) {
  // Rounding to nine digits, as survey.csv has them, moves eigenvalues by less of the trace.
  constexpr double kByDigits = 1e-8;
  const double place = JobKeyOf("tie_in", "north_m").range.max;  // [m]
  const double largest = place * place;                          // [m^2]
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      if (std::abs(cov_p_WT_W(i, j)) <= largest) continue;
      return fmt::format("{} in row {}, column {} is no covariance of a position [m^2]",
                         cov_p_WT_W(i, j), i + 1, j + 1);
    }
  }
  const double rounding = kByDigits * std::abs(cov_p_WT_W.trace());
  const Eigen::Matrix3d skew = cov_p_WT_W - cov_p_WT_W.transpose();
  if (skew.cwiseAbs().maxCoeff() > rounding) return "must be symmetric";
  const auto eigenvalues =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(cov_p_WT_W, Eigen::EigenvaluesOnly)
          .eigenvalues();
  if (eigenvalues.minCoeff() < -rounding) {
    return fmt::format("has a direction of negative variance, {:.3g} m^2", eigenvalues.minCoeff());
  }
  return std::nullopt;
}

std::optional<std::string> FindWellHeadComplaint(const Job& job) {
  if (!job.grid) return std::nullopt;
  try {
    const WellGrid probe(*job.grid,
                         {.latitude = job.well.latitude, .longitude = job.well.longitude});
  } catch (const std::exception& error) {
    return fmt::format("the well head has no place on it: {}", error.what());
  }
  return std::nullopt;
}

}  // namespace wellgyro
