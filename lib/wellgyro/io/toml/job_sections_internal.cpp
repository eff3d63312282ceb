#include "wellgyro/io/toml/job_sections_internal.h"

#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/io/signature.h"
#include "wellgyro/io/toml/job_numbers_internal.h"
#include "wellgyro/survey/job_keys.h"
#include "wellgyro/survey/job_rules.h"

namespace wellgyro {
namespace {

std::optional<UtcTime> FindUtime(TomlTable& table, std::string_view section, std::string_view key) {
  const auto us = FindWhole(table, section, key);
  if (!us) return std::nullopt;
  return UtcTime{*us * 1000};
}

void ReadSmall(TomlTable& table, std::string_view section, std::string_view key,
               std::int32_t& value) {
  if (const auto found = FindWhole(table, section, key)) value = static_cast<std::int32_t>(*found);
}

// Lines are those of the key at fault, or of the one that it goes against.
void RefuseWrong(const TomlTable& table, const std::optional<KeyComplaint>& wrong) {
  if (!wrong) return;
  const bool here = table.Has(wrong->key) || !table.Has(wrong->other);
  const std::string_view key = here ? wrong->key : wrong->other;
  if (!table.Has(key)) table.RefuseAbsent(key, wrong->why);
  table.Refuse(key, wrong->why, wrong->code);
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

void ReadExplicitGrid(TomlTable& table, Job& job) {
  GridSpec& grid = *job.grid;
  grid.projection =
      table.Need("projection", FindChoice<GridSpec::Projection>(table, "grid", "projection"));
  for (const char* key : {"semi_major_m", "inverse_flattening", "longitude_origin_deg",
                          "scale_origin", "false_easting_m", "false_northing_m"}) {
    ReadNumber(table, "grid", key, job);
  }
  if (grid.projection == GridSpec::Projection::kPolarStereographic) {
    grid.north_pole = table.Need("pole", FindChoice<bool>(table, "grid", "pole"));
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
  AlignmentSpec& spec = job.alignment;
  spec.of = FindChoice<AlignmentSpec::Of>(table, "alignment", "of").value_or(spec.of);
  NeedNumber(table, "alignment", "azimuth_true_deg", job);
  spec.azimuth = WrapTwoPi(spec.azimuth);
  NeedNumber(table, "alignment", "sigma_azimuth_deg", job);
  ReadNumber(table, "alignment", "at_md_m", job);
  spec.at_utc = FindUtime(table, "alignment", "at_utime_us");
  RefuseWrong(table, FindKeyComplaint(spec));
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
  RefuseWrong(table, FindKeyComplaint(tie_in));
  tie_in.place_stated = table.Has("north_m") && table.Has("east_m");
  if (tie_in.azimuth) tie_in.azimuth = WrapTwoPi(*tie_in.azimuth);
  const std::string_view covariance = table.Has("covariance") ? "covariance" : "covariance_m2";
  tie_in.cov_p_WT_W = FindCovariance(table, covariance).value_or(Eigen::Matrix3d::Zero());
}

Channels ReadChannels(TomlTable table) {
  Channels channels;
  for (const JobKey& key : JobKeys()) {
    if (key.channel) table.Read(key.key, channels.*key.channel);
  }
  RefuseWrong(table, FindKeyComplaint(channels));
  return channels;
}

void ReadAlignment(TomlTable table, Job& job) {
  using Method = AlignmentSpec::Method;
  AlignmentSpec& spec = job.alignment;
  spec.method = FindChoice<Method>(table, "alignment", "method").value_or(spec.method);
  if (spec.method == Method::kExternal) ReadExternalAzimuth(table, job);
  ReadNumber(table, "alignment", "min_still_s", job);
}

AttitudeSpec ReadAttitude(TomlTable table) {
  AttitudeSpec spec;
  spec.order = FindChoice<AttitudeSpec::Order>(table, "attitude", "order").value_or(spec.order);
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
  RefuseWrong(table, FindKeyComplaint(spec));
}

void ReadDepth(TomlTable table, Job& job) {
  DepthSpec& spec = job.depth;
  spec.kind = FindChoice<DepthKind>(table, "depth", "kind").value_or(spec.kind);
  ReadNumbers(table, "depth", job);
  if (auto cable = table.FindTable("cable")) ReadNumbers(*cable, "depth.cable", job);
  if (const auto rows = table.FindRows("corrections", 2)) {
    for (const auto& row : *rows) spec.corrections.emplace_back(row[0], row[1]);
  }
  RefuseWrong(table, FindKeyComplaint(spec));
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

void ReadRun(TomlTable table, std::vector<RunSpec>& runs) {
  RunSpec& run = runs.emplace_back();
  if (!table.Has("number")) table.RefuseAbsent("number", "is missing");
  ReadSmall(table, "run", "number", run.number);
  run.begin = FindUtime(table, "run", "begin_utime_us");
  run.end = FindUtime(table, "run", "end_utime_us");
  run.misrun = FindChoice<bool>(table, "run", "verdict").value_or(false);
  table.Read("remark", run.remark);
  RefuseWrong(table, FindKeyComplaint(runs));
}

Event ReadEvent(TomlTable table) {
  Event event;
  event.utc = table.Need("utime_us", FindUtime(table, "event", "utime_us"));
  event.seq = FindWhole(table, "event", "seq").value_or(event.seq);
  ReadSmall(table, "event", "session", event.session);
  ReadSmall(table, "event", "run", event.run);
  ReadSmall(table, "event", "event_id", event.event_id);
  event.kind = table.Need("event", FindChoice<Event::Kind>(table, "event", "event"));
  event.value_m = FindListed(table, "event", "value_m").value_or(event.value_m);
  event.sigma_m = FindListed(table, "event", "sigma_m").value_or(event.sigma_m);
  event.value_rad = FindListed(table, "event", "value_rad").value_or(event.value_rad);
  event.sigma_rad = FindListed(table, "event", "sigma_rad").value_or(event.sigma_rad);
  event.has_value = table.Has(event.kind == Event::Kind::kForesight ? "value_rad" : "value_m");
  table.Read("what", event.what);
  table.Read("who", event.who);
  table.Read("text", event.text);
  RefuseWrong(table, FindKeyComplaint(event));
  return event;
}

}  // namespace wellgyro
