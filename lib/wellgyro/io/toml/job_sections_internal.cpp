#include "wellgyro/io/toml/job_sections_internal.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <Eigen/Eigenvalues>
#include <fmt/core.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/base/units.h"
#include "wellgyro/io/signature.h"
#include "wellgyro/io/words.h"

namespace wellgyro {
namespace {

constexpr double kDeg = units::kDeg;
constexpr std::int64_t kInt32 = std::numeric_limits<std::int32_t>::max();
constexpr std::int64_t kUtimeMax = std::numeric_limits<std::int64_t>::max() / 1000;  // [us]

std::optional<UtcTime> FindUtime(TomlTable& table, std::string_view key) {
  const auto us = table.FindInteger(key, 0, kUtimeMax);
  if (!us) return std::nullopt;
  return UtcTime{*us * 1000};
}

std::int32_t Small(TomlTable& table, std::string_view key, std::int64_t min, std::int32_t absent) {
  return static_cast<std::int32_t>(table.FindInteger(key, min, kInt32).value_or(absent));
}

// Three rows of (north, east, TVD) [m2].
std::optional<Eigen::Matrix3d> FindCovariance(TomlTable& table, std::string_view key) {
  if (!table.Has(key)) return std::nullopt;
  const std::vector<std::vector<double>> rows = table.FindRows(key, 3).value();
  if (rows.size() != 3) table.Refuse(key, "must have three rows: north, east, TVD");
  Eigen::Matrix3d cov;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      cov(i, j) = rows[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)];
    }
  }
  if (cov != cov.transpose()) table.Refuse(key, "must be symmetric");
  const auto eigenvalues =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(cov, Eigen::EigenvaluesOnly).eigenvalues();
  if (eigenvalues.minCoeff() < -1e-9 * cov.trace() || cov.trace() < 0) {
    table.Refuse(key, "has a direction of negative variance");
  }
  return cov;
}

GridSpec::Projection ReadProjection(TomlTable& table) {
  using Projection = GridSpec::Projection;
  return table.Need(
      "projection",
      table.FindWord<Projection>("projection",
                                 {{"transverse_mercator", Projection::kTransverseMercator},
                                  {"lambert_conformal_conic", Projection::kLambertConformalConic},
                                  {"polar_stereographic", Projection::kPolarStereographic}}));
}

GridSpec ReadExplicitGrid(TomlTable& table) {
  GridSpec grid;
  grid.projection = ReadProjection(table);
  table.Read("semi_major_m", grid.semi_major, 1, {.min = 1e6, .max = 1e8});
  table.Read("inverse_flattening", grid.inverse_flattening, 1, {.min = 100, .max = 1e6});
  table.Read("longitude_origin_deg", grid.longitude_origin, kDeg, kLongitudeDeg);
  table.Read("scale_origin", grid.scale_origin, 1, {.min = 0.5, .max = 2});
  table.Read("false_easting_m", grid.false_easting);
  table.Read("false_northing_m", grid.false_northing);
  if (grid.projection == GridSpec::Projection::kPolarStereographic) {
    grid.north_pole =
        table.Need("pole", table.FindWord<bool>("pole", {{"north", true}, {"south", false}}));
    return grid;
  }
  table.Read("latitude_origin_deg", grid.latitude_origin, kDeg, kLatitudeDeg);
  if (grid.projection == GridSpec::Projection::kLambertConformalConic) {
    const auto second = table.FindNumber("parallel_2_deg", kLatitudeDeg);
    const auto first = table.FindNumber("parallel_1_deg", kLatitudeDeg);
    grid.parallel_1 = table.Need("parallel_1_deg", first) * kDeg;
    grid.parallel_2 = second.value_or(*first) * kDeg;
  }
  return grid;
}

void ReadExternalAzimuth(TomlTable& table, AlignmentSpec& spec) {
  using Of = AlignmentSpec::Of;
  spec.of = table.FindWord<Of>("of", {{"axis", Of::kAxis}, {"mark", Of::kMark}}).value_or(spec.of);
  spec.azimuth = WrapTwoPi(
      kDeg * table.Need("azimuth_true_deg", table.FindNumber("azimuth_true_deg", kAzimuthDeg)));
  spec.sigma_azimuth =
      kDeg * table.Need("sigma_azimuth_deg", table.FindNumber("sigma_azimuth_deg", kPositive));
  table.Read("at_md_m", spec.at_md);
  spec.at_utc = FindUtime(table, "at_utime_us");
  if (spec.at_md && spec.at_utc) {
    table.Refuse("at_md_m", "stands beside at_utime_us; only one of them can hold",
                 FaultCode::kConflict);
  }
  table.Read("use_fixes", spec.use_fixes);
}

Cable ReadCable(TomlTable table) {
  constexpr double kPerKmKn = 1e-6;  // m per km and kN, in 1/N
  Cable cable;
  table.Read("stretch_m_per_km_kn", cable.stretch, kPerKmKn, kNotNegative);
  table.Read("weight_n_per_m", cable.weight, 1, kNotNegative);
  table.Read("tool_weight_n", cable.tool_weight, 1, kNotNegative);
  table.Read("measuring_tension_n", cable.measuring_tension, 1, kNotNegative);
  table.Read("expansion_per_degc", cable.expansion, 1, kNotNegative);
  table.Read("measuring_temperature_degc", cable.measuring_temperature);
  table.Read("surface_temperature_degc", cable.surface_temperature);
  table.Read("gradient_degc_per_km", cable.gradient, 1e-3);
  table.Read("stretch_sigma_ratio", cable.ratio_sigma, 1, {.min = 0, .max = 1});
  table.Read("mark_spacing_m", cable.mark_spacing, 1, kPositive);
  table.Read("first_mark_m", cable.first_mark);
  table.Read("mark_sigma_m", cable.sigma_mark, 1, kNotNegative);
  return cable;
}

}  // namespace

Job::Well ReadWell(TomlTable table) {
  Job::Well well;
  table.Read("name", well.name);
  const auto latitude = table.FindNumber("latitude_deg", {.min = -89.5, .max = 89.5});
  well.latitude = kDeg * table.Need("latitude_deg", latitude);
  table.Read("longitude_deg", well.longitude, kDeg, kLongitudeDeg);
  table.Read("datum_elevation_m", well.datum_elevation, 1, {.min = -12'000, .max = 10'000});
  return well;
}

GridSpec ReadGrid(TomlTable table) {
  GridSpec grid;
  if (const auto zone = table.FindString("utm_zone")) {
    if (table.Has("projection")) {
      table.Refuse("projection", "stands beside utm_zone; only one of them can hold",
                   FaultCode::kConflict);
    }
    try {
      grid = UtmGrid(*zone);
    } catch (const std::invalid_argument& error) {
      table.Refuse("utm_zone", error.what());
    }
  } else {
    grid = ReadExplicitGrid(table);
  }
  table.Read("name", grid.name);
  table.Read("convergence_deg", grid.convergence, kDeg, {.min = -180, .max = 180});
  table.Read("scale", grid.scale, 1, {.min = 0.5, .max = 2});
  table.Read("epsg", grid.epsg);
  return grid;
}

TieIn ReadTieIn(TomlTable table) {
  TieIn tie_in;
  table.Read("md_m", tie_in.md);
  table.Read("north_m", tie_in.north);
  table.Read("east_m", tie_in.east);
  table.Read("tvd_m", tie_in.tvd);
  table.Read("inclination_deg", tie_in.inclination, kDeg, kInclinationDeg);
  table.Read("azimuth_true_deg", tie_in.azimuth, kDeg, kAzimuthDeg);
  if (tie_in.azimuth) tie_in.azimuth = WrapTwoPi(*tie_in.azimuth);
  if (tie_in.inclination && !tie_in.azimuth) {
    table.RefuseAbsent("azimuth_true_deg", "is missing beside inclination_deg");
  }
  if (tie_in.azimuth && !tie_in.inclination) {
    table.RefuseAbsent("inclination_deg", "is missing beside azimuth_true_deg");
  }
  const std::string_view covariance = table.Has("covariance") ? "covariance" : "covariance_m2";
  tie_in.cov_p_WT_W = FindCovariance(table, covariance).value_or(Eigen::Matrix3d::Zero());
  return tie_in;
}

Channels ReadChannels(TomlTable table) {
  Channels channels;
  const std::array<std::pair<std::string_view, std::string*>, 10> names{
      {{"raw", &channels.raw},
       {"imu", &channels.imu},
       {"still", &channels.still},
       {"depth", &channels.depth},
       {"mode", &channels.mode},
       {"tool", &channels.tool},
       {"event", &channels.event},
       {"command", &channels.command},
       {"station", &channels.station},
       {"status", &channels.status}}};
  for (const auto& [key, name] : names) {
    table.Read(key, *name);
    // LCM's own limit is 63 characters.
    if (name->empty() || name->size() > 63) table.Refuse(key, "must have 1 to 63 characters");
  }
  for (std::size_t i = 0; i < names.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (*names[i].second != *names[j].second) continue;
      table.Refuse(table.Has(names[i].first) ? names[i].first : names[j].first,
                   fmt::format("\"{}\" is the channel of {} and of {}", *names[i].second,
                               names[j].first, names[i].first),
                   FaultCode::kConflict);
    }
  }
  return channels;
}

AlignmentSpec ReadAlignment(TomlTable table) {
  using Method = AlignmentSpec::Method;
  AlignmentSpec spec;
  spec.method = table
                    .FindWord<Method>("method", {{"gyrocompass", Method::kGyrocompass},
                                                 {"external", Method::kExternal}})
                    .value_or(spec.method);
  if (spec.method == Method::kExternal) ReadExternalAzimuth(table, spec);
  table.Read("min_still_s", spec.min_still, 1, kPositive);
  return spec;
}

AttitudeSpec ReadAttitude(TomlTable table) {
  using Order = TrackerOptions::Order;
  AttitudeSpec spec;
  spec.order = table
                   .FindWord<Order>("order", {{"second", TrackerOptions::kSecond},
                                              {"third", TrackerOptions::kThird}})
                   .value_or(spec.order);
  return spec;
}

StationSpec ReadStations(TomlTable table) {
  StationSpec spec;
  if (auto at = table.FindNumbers("at_m", kAnyNumber)) {
    spec.at = *std::move(at);
    spec.every = 0;
  }
  table.Read("every_m", spec.every, 1, kNotNegative);
  table.Read("at_stops", spec.at_stops);
  for (std::size_t i = 1; i < spec.at.size(); ++i) {
    if (spec.at[i] > spec.at[i - 1]) continue;
    table.Refuse("at_m",
                 fmt::format("{} after {}: depths must increase", spec.at[i], spec.at[i - 1]));
  }
  if (spec.every == 0 && spec.at.empty() && !spec.at_stops) {
    table.Refuse(table.Has("every_m") ? "every_m" : "at_m",
                 "asks for no station: give every_m, at_m or at_stops = true");
  }
  return spec;
}

DepthSpec ReadDepth(TomlTable table) {
  DepthSpec spec;
  if (const auto kind = table.FindString("kind")) {
    const std::optional<DepthKind> known = DepthKindOf(*kind);
    if (!known) {
      table.Refuse(
          "kind",
          fmt::format("\"{}\" is none of indicated, wireline, drill_pipe, tubing, other", *kind));
    }
    spec.kind = *known;
  }
  table.Read("latency_s", spec.latency, 1, {.min = 0, .max = 86'400});
  if (auto cable = table.FindTable("cable")) spec.cable = ReadCable(*std::move(cable));
  table.Read("max_gap_s", spec.max_gap, 1, {.min = 0.1, .max = 600});
  for (const auto& row :
       table.FindRows("corrections", 2).value_or(std::vector<std::vector<double>>())) {
    if (!spec.corrections.empty() && !(row[0] > spec.corrections.back().first)) {
      table.Refuse("corrections", fmt::format("depth {} after {}: depths must increase", row[0],
                                              spec.corrections.back().first));
    }
    spec.corrections.emplace_back(row[0], row[1]);
  }
  return spec;
}

StringSpec ReadString(TomlTable table) {
  StringSpec spec;
  constexpr TomlRange kTilt{.min = -90, .max = 90};
  table.Read("sensor_below_reference_m", spec.sensor_below_reference);
  table.Read("sag_deg", spec.sag, kDeg, kTilt);
  table.Read("sag_sigma_deg", spec.sigma_sag, kDeg, kNotNegative);
  table.Read("misalignment_x_deg", spec.misalignment_x, kDeg, kTilt);
  table.Read("misalignment_y_deg", spec.misalignment_y, kDeg, kTilt);
  table.Read("misalignment_sigma_deg", spec.sigma_misalignment, kDeg, kNotNegative);
  return spec;
}

MagneticSpec ReadMagnetic(TomlTable table) {
  MagneticSpec spec;
  constexpr TomlRange kSigmaDeg{.min = 1e-6, .max = 179};
  const auto declination = table.FindNumber("declination_deg", {.min = -180, .max = 180});
  spec.declination = kDeg * table.Need("declination_deg", declination);
  spec.sigma = kDeg * table.Need("sigma_deg", table.FindNumber("sigma_deg", kSigmaDeg));
  table.Read("tie", spec.tie);
  return spec;
}

Acceptance ReadAcceptance(TomlTable table) {
  Acceptance limits;
  table.Read("gravity_mps2", limits.gravity, 1, kPositive);
  table.Read("earth_rate_deg_per_h", limits.earth_rate, units::kDegPerHour, kPositive);
  table.Read("inclination_difference_deg", limits.inclination_difference, kDeg, kPositive);
  table.Read("azimuth_difference_deg", limits.azimuth_difference, kDeg, kPositive);
  table.Read("foresight_deg", limits.foresight, kDeg, kPositive);
  table.Read("depth_closure_m", limits.depth_closure, 1, kPositive);
  return limits;
}

OperationSpec ReadOperations(TomlTable& root) {
  OperationSpec spec;
  if (auto table = root.FindTable("operations")) {
    spec.unsigned_tool = table->FindBool("unsigned_tool").value_or(false);
  }
  for (TomlTable& table : root.FindTables("operator")) {
    OperatorKey& key = spec.keys.emplace_back();
    key.name = table.Need("name", table.FindString("name"));
    const auto bytes = BytesOfHex(table.Need("public_key", table.FindString("public_key")));
    if (!bytes || bytes->size() != kPublicKeySize) {
      table.Refuse("public_key", "must be the 64 hexadecimal digits of an Ed25519 public key");
    }
    key.key = *bytes;
  }
  return spec;
}

RunSpec ReadRun(TomlTable table) {
  RunSpec run;
  run.number =
      static_cast<std::int32_t>(table.Need("number", table.FindInteger("number", 1, kInt32)));
  run.begin = FindUtime(table, "begin_utime_us");
  run.end = FindUtime(table, "end_utime_us");
  if (run.begin && run.end && !(*run.end > *run.begin)) {
    table.Refuse("end_utime_us", "must be later than begin_utime_us");
  }
  run.misrun = table.FindWord<bool>("verdict", {{"ok", false}, {"misrun", true}}).value_or(false);
  table.Read("remark", run.remark);
  return run;
}

Event ReadEvent(TomlTable table) {
  Event event;
  event.utc = table.Need("utime_us", FindUtime(table, "utime_us"));
  event.seq = table.FindInteger("seq", 0, std::numeric_limits<std::int64_t>::max()).value_or(0);
  event.session = Small(table, "session", 0, 0);
  event.run = Small(table, "run", 0, 0);
  event.event_id = Small(table, "event_id", 0, 0);
  const std::string word = table.Need("event", table.FindString("event"));
  const std::optional<Event::Kind> kind = EventKindOf(word);
  if (!kind) {
    table.Refuse(
        "event",
        fmt::format("\"{}\" is none of depth_zero, depth_rezero, depth_tie, "
                    "return_to_zero, foresight, run_begin, run_end, accept, reject, remark",
                    word));
  }
  event.kind = *kind;
  table.Read("value_m", event.value_m);
  table.Read("sigma_m", event.sigma_m, 1, kNotNegative);
  table.Read("value_rad", event.value_rad);
  table.Read("sigma_rad", event.sigma_rad, 1, kNotNegative);
  event.has_value = table.Has("value_m") || table.Has("value_rad");
  table.Read("what", event.what);
  table.Read("who", event.who);
  table.Read("text", event.text);
  return event;
}

}  // namespace wellgyro
