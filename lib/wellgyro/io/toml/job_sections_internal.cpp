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
#include "wellgyro/io/signature.h"
#include "wellgyro/io/toml/job_numbers_internal.h"
#include "wellgyro/io/words.h"
#include "wellgyro/survey/job_keys.h"

namespace wellgyro {
namespace {

constexpr std::int64_t kUtimeMax = std::numeric_limits<std::int64_t>::max() / 1000;  // [us]

std::optional<UtcTime> FindUtime(TomlTable& table, std::string_view key) {
  const auto us = table.FindInteger(key, 0, kUtimeMax);
  if (!us) return std::nullopt;
  return UtcTime{*us * 1000};
}

std::int32_t Small(TomlTable& table, std::string_view key, std::int64_t min, std::int32_t absent) {
  return static_cast<std::int32_t>(table.FindInteger(key, min, kInt32Most).value_or(absent));
}

// Three rows of (north, east, TVD) [m2].
std::optional<Eigen::Matrix3d> FindCovariance(TomlTable& table, std::string_view key) {
  const auto found = table.FindRows(key, 3);
  if (!found) return std::nullopt;
  const std::vector<std::vector<double>>& rows = *found;
  if (rows.size() != 3) table.Refuse(key, "must have three rows: north, east, TVD");
  Eigen::Matrix3d cov;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      cov(i, j) = rows[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)];
    }
  }
  if (const auto complaint = FindCovarianceComplaint(cov)) table.Refuse(key, *complaint);
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

void ReadExplicitGrid(TomlTable& table, Job& job) {
  GridSpec& grid = *job.grid;
  grid.projection = ReadProjection(table);
  for (const char* key : {"semi_major_m", "inverse_flattening", "longitude_origin_deg",
                          "scale_origin", "false_easting_m", "false_northing_m"}) {
    ReadNumber(table, "grid", key, job);
  }
  if (grid.projection == GridSpec::Projection::kPolarStereographic) {
    grid.north_pole =
        table.Need("pole", table.FindWord<bool>("pole", {{"north", true}, {"south", false}}));
    return;
  }
  ReadNumber(table, "grid", "latitude_origin_deg", job);
  if (grid.projection == GridSpec::Projection::kLambertConformalConic) {
    NeedNumber(table, "grid", "parallel_1_deg", job);
    grid.parallel_2 = grid.parallel_1;
    ReadNumber(table, "grid", "parallel_2_deg", job);
  }
}

void ReadExternalAzimuth(TomlTable& table, Job& job) {
  using Of = AlignmentSpec::Of;
  AlignmentSpec& spec = job.alignment;
  spec.of = table.FindWord<Of>("of", {{"axis", Of::kAxis}, {"mark", Of::kMark}}).value_or(spec.of);
  NeedNumber(table, "alignment", "azimuth_true_deg", job);
  spec.azimuth = WrapTwoPi(spec.azimuth);
  NeedNumber(table, "alignment", "sigma_azimuth_deg", job);
  ReadNumber(table, "alignment", "at_md_m", job);
  spec.at_utc = FindUtime(table, "at_utime_us");
  if (spec.at_md && spec.at_utc) {
    table.Refuse("at_md_m", "stands beside at_utime_us; only one of them can hold",
                 FaultCode::kConflict);
  }
  table.Read("use_fixes", spec.use_fixes);
}

}  // namespace

void ReadWell(TomlTable table, Job& job) {
  table.Read("name", job.well.name);
  NeedNumber(table, "well", "latitude_deg", job);
  ReadNumbers(table, "well", job);
}

void ReadGrid(TomlTable table, Job& job) {
  GridSpec& grid = job.grid.emplace();
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
    ReadExplicitGrid(table, job);
  }
  table.Read("name", grid.name);
  ReadNumber(table, "grid", "convergence_deg", job);
  ReadNumber(table, "grid", "scale", job);
  table.Read("epsg", grid.epsg);
}

void ReadTieIn(TomlTable table, Job& job) {
  TieIn& tie_in = job.tie_in;
  ReadNumbers(table, "tie_in", job);
  if (tie_in.md != 0 && !table.Has("tvd_m")) {
    table.RefuseAbsent("tvd_m", "is missing beside md_m: how deep the tie-in is, is not guessed");
  }
  tie_in.place_stated = table.Has("north_m") && table.Has("east_m");
  if (tie_in.azimuth) tie_in.azimuth = WrapTwoPi(*tie_in.azimuth);
  if (tie_in.inclination && !tie_in.azimuth) {
    table.RefuseAbsent("azimuth_true_deg", "is missing beside inclination_deg");
  }
  if (tie_in.azimuth && !tie_in.inclination) {
    table.RefuseAbsent("inclination_deg", "is missing beside azimuth_true_deg");
  }
  const std::string_view covariance = table.Has("covariance") ? "covariance" : "covariance_m2";
  tie_in.cov_p_WT_W = FindCovariance(table, covariance).value_or(Eigen::Matrix3d::Zero());
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

void ReadAlignment(TomlTable table, Job& job) {
  using Method = AlignmentSpec::Method;
  AlignmentSpec& spec = job.alignment;
  spec.method = table
                    .FindWord<Method>("method", {{"gyrocompass", Method::kGyrocompass},
                                                 {"external", Method::kExternal}})
                    .value_or(spec.method);
  if (spec.method == Method::kExternal) ReadExternalAzimuth(table, job);
  ReadNumber(table, "alignment", "min_still_s", job);
}

AttitudeSpec ReadAttitude(TomlTable table) {
  using Order = AttitudeSpec::Order;
  AttitudeSpec spec;
  spec.order =
      table.FindWord<Order>("order", {{"second", Order::kSecond}, {"third", Order::kThird}})
          .value_or(spec.order);
  return spec;
}

void ReadStations(TomlTable table, Job& job) {
  StationSpec& spec = job.stations;
  if (auto at = table.FindNumbers("at_m", JobKeyOf("stations", "at_m").range)) {
    spec.at = *std::move(at);
    spec.every = 0;
  }
  ReadNumber(table, "stations", "every_m", job);
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
}

void ReadDepth(TomlTable table, Job& job) {
  DepthSpec& spec = job.depth;
  if (const auto kind = table.FindString("kind")) {
    const std::optional<DepthKind> known = DepthKindOf(*kind);
    if (!known) {
      table.Refuse(
          "kind",
          fmt::format("\"{}\" is none of indicated, wireline, drill_pipe, tubing, other", *kind));
    }
    spec.kind = *known;
  }
  ReadNumbers(table, "depth", job);
  if (auto cable = table.FindTable("cable")) ReadNumbers(*cable, "depth.cable", job);
  const NumberRange& range = JobKeyOf("depth", "corrections").range;
  for (const auto& row :
       table.FindRows("corrections", 2).value_or(std::vector<std::vector<double>>())) {
    if (!spec.corrections.empty() && !(row[0] > spec.corrections.back().first)) {
      table.Refuse("corrections", fmt::format("depth {} after {}: depths must increase", row[0],
                                              spec.corrections.back().first));
    }
    if (const auto complaint = ComplaintOf(row[1], range)) table.Refuse("corrections", *complaint);
    spec.corrections.emplace_back(row[0], row[1]);
  }
}

void ReadMagnetic(TomlTable table, Job& job) {
  MagneticSpec& spec = job.magnetic.emplace();
  NeedNumber(table, "magnetic", "declination_deg", job);
  NeedNumber(table, "magnetic", "sigma_deg", job);
  table.Read("tie", spec.tie);
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
      static_cast<std::int32_t>(table.Need("number", table.FindInteger("number", 1, kInt32Most)));
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
  event.value_m = FindListed(table, "event", "value_m").value_or(event.value_m);
  event.sigma_m = FindListed(table, "event", "sigma_m").value_or(event.sigma_m);
  event.value_rad = FindListed(table, "event", "value_rad").value_or(event.value_rad);
  event.sigma_rad = FindListed(table, "event", "sigma_rad").value_or(event.sigma_rad);
  event.has_value = table.Has("value_m") || table.Has("value_rad");
  table.Read("what", event.what);
  table.Read("who", event.who);
  table.Read("text", event.text);
  return event;
}

}  // namespace wellgyro
