#include <chrono>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <variant>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

#include "wellgyro/base/units.h"
#include "wellgyro/earth/crs.h"
#include "wellgyro/earth/magnetic.h"
#include "wellgyro/io/toml/job_file.h"

#include "commands.h"
#include "place_options.h"
#include "report.h"

namespace wellgyro::apps {
namespace {

struct NorthOptions {
  std::optional<double> latitude, longitude;  // [rad]
  std::optional<double> easting, northing;    // in the system's unit
  double height = 0;                          // [m]
  std::string job, crs, date, model = "wmm2025", data;
  std::optional<double> stated_convergence, stated_declination;  // [rad]
};

double Deg(double radians) { return radians / units::kDeg; }

/// Beside the program where it is installed, else where it was built.
std::string DataFolder(const NorthOptions& o) {
  if (!o.data.empty()) return o.data;
  std::error_code error;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", error);
  const auto installed = program.parent_path().parent_path() / WELLGYRO_SHARE / "magnetic";
  if (!error && std::filesystem::exists(installed)) return installed.string();
  return WELLGYRO_SOURCE_DATA "/magnetic";
}

void PrintCheck(const char* what, double stated, double ours) {
  fmt::print("  stated {:+.4f} deg: it holds; ours differs by {:+.4f} deg\n", Deg(stated),
             Deg(ours - stated));
  if (std::abs(ours - stated) > 0.1 * units::kDeg) {
    Complain(fmt::format("the stated {} differs from ours by more than 0.1 deg", what));
  }
}

int PrintGrid(const NorthOptions& o, const GeodeticPoint& place) {
  const auto grid = ProjectToCrs(o.crs, place);
  if (!grid) return Unusable(grid.fault());
  fmt::print("grid {} ({})\n  easting {:.4f} m, northing {:.4f} m", o.crs, grid->name,
             grid->point.easting, grid->point.northing);
  if (grid->unit != 1) {
    fmt::print("; {:.4f}, {:.4f} {}", grid->point.easting / grid->unit,
               grid->point.northing / grid->unit, grid->unit_name);
  }
  fmt::print("\n  convergence {:+.6f} deg (true less grid azimuth), scale {:.8f}\n",
             Deg(grid->point.convergence), grid->point.scale);
  fmt::print("  from WGS 84 by: {}", grid->operation);
  if (grid->accuracy) fmt::print(", good to {:g} m by the registry", *grid->accuracy);
  fmt::print("\n");
  if (!grid->outside.empty()) {
    Complain(fmt::format("the place is outside the area of {}, {}", o.crs, grid->outside));
  }
  if (o.stated_convergence) {
    PrintCheck("convergence", *o.stated_convergence, grid->point.convergence);
  }
  return kDone;
}

int PrintMagnetic(const NorthOptions& o, const GeodeticPoint& place) {
  const auto year = DecimalYear(o.date);
  if (!year) {
    Fault fault = year.fault();
    fault.source = "--date";
    return Misused(fault);
  }
  const bool known = o.model == "wmm2025" || o.model == "wmm2020" || o.model == "igrf14";
  if (!known && o.data.empty()) {
    return Misused("--magnetic-model " + o.model +
                   ": there are wmm2025, wmm2020 and igrf14, and others by --magnetic-data");
  }
  const auto found = MagneticFieldAt(o.model, DataFolder(o), place, o.height, *year);
  if (!found) {
    Fault fault = found.fault();
    if (o.data.empty() && fault.text.find("holds from") != std::string::npos) {
      fault.text += "; --magnetic-model igrf14 holds from 1900 to 2030, wmm2020 from 2020 to 2025";
    }
    return Unusable(fault);
  }
  const MagneticField& f = *found;
  fmt::print("magnetic, {} on {} ({:.4f})\n", o.model, o.date, *year);
  fmt::print("  declination {:+.4f} deg +- {:.2f} (true less magnetic azimuth)\n",
             Deg(f.declination), Deg(f.sigma_declination));
  fmt::print("  dip {:+.4f} deg +- {:.2f}, field {:.1f} nT +- {:.0f}, 1 sigma\n", Deg(f.dip),
             Deg(f.sigma_dip), f.field / units::kNanotesla, f.sigma_field / units::kNanotesla);
  if (o.stated_declination) PrintCheck("declination", *o.stated_declination, f.declination);
  return kDone;
}

std::string DateOf(UtcTime time) {
  namespace ch = std::chrono;
  const ch::sys_time<ch::nanoseconds> instant{ch::nanoseconds(time.ns)};
  const ch::year_month_day day{ch::floor<ch::days>(instant)};
  return fmt::format("{:04}-{:02}-{:02}", static_cast<int>(day.year()),
                     static_cast<unsigned>(day.month()), static_cast<unsigned>(day.day()));
}

/// What the job says of place, grid, date and norths, where no option does.
std::optional<Fault> TakeJob(NorthOptions& o) {
  const Result<JobFile> file = ReadJob(o.job);
  if (!file) return file.fault();
  const Job& job = file->job;
  if (!o.latitude && !o.easting) {
    o.latitude = job.well.latitude;
    o.longitude = job.well.longitude;
    if (job.well.longitude == 0) Complain("note: longitude 0, unless the job says another");
  }
  if (job.grid && o.crs.empty()) o.crs = job.grid->epsg;
  if (o.crs.find_first_not_of("0123456789") == std::string::npos && !o.crs.empty()) {
    o.crs = "EPSG:" + o.crs;
  }
  if (job.grid && !o.stated_convergence) o.stated_convergence = job.grid->convergence;
  if (job.magnetic && !o.stated_declination) o.stated_declination = job.magnetic->declination;
  for (const RunSpec& run : job.runs) {
    if (o.date.empty() && run.begin) o.date = DateOf(*run.begin);
  }
  return std::nullopt;
}

/// What of the command line would be passed over, in words; empty where nothing would.
std::string Unused(const NorthOptions& o) {
  if (o.easting.has_value() != o.northing.has_value())
    return "--easting and --northing go together";
  if (o.latitude.has_value() != o.longitude.has_value()) {
    return "--latitude-deg and --longitude-deg go together";
  }
  if (o.easting && o.latitude) {
    return "one place: --latitude-deg and --longitude-deg, or --easting and --northing";
  }
  if (o.easting && o.crs.empty()) return "--easting and --northing need their system: --crs";
  if (o.stated_convergence && o.crs.empty()) {
    return "--convergence-deg is held against a map system's: say which by --crs";
  }
  if (o.stated_declination && o.date.empty()) {
    return "--declination-deg is held against a magnetic model's: say of which day by --date";
  }
  return {};
}

/// By map coordinates or by latitude and longitude; else an exit code.
std::variant<GeodeticPoint, int> PlaceOf(const NorthOptions& o) {
  if (o.easting && o.northing && !o.crs.empty()) {
    const auto found = GeodeticOfCrs(o.crs, {*o.easting, *o.northing, 0});
    if (!found) return Unusable(found.fault());
    return *found;
  }
  if (o.latitude && o.longitude) return GeodeticPoint{*o.latitude, *o.longitude};
  return Misused(
      "a place is needed: --latitude-deg and --longitude-deg, or --crs with --easting and "
      "--northing");
}

int RunNorth(NorthOptions& o) {
  if (!o.crs.empty() && o.crs.find_first_not_of("0123456789") == std::string::npos) {
    o.crs = "EPSG:" + o.crs;
  }
  if (!o.job.empty()) {
    if (const auto fault = TakeJob(o)) return Unusable(*fault);
  } else if (const std::string why = Unused(o); !why.empty()) {
    return Misused(why);
  }
  const std::variant<GeodeticPoint, int> found = PlaceOf(o);
  if (const int* const code = std::get_if<int>(&found)) return *code;
  const GeodeticPoint& place = std::get<GeodeticPoint>(found);
  fmt::print("place on WGS 84: latitude {:.9f} deg, longitude {:.9f} deg\n", Deg(place.latitude),
             Deg(place.longitude));
  fmt::print("true north: 0\n");
  int code = o.crs.empty() ? kDone : PrintGrid(o, place);
  if (code == kDone && !o.date.empty()) code = PrintMagnetic(o, place);
  return code;
}

}  // namespace

void AddNorth(CLI::App& app, int& exit_code) {
  CLI::App* const command = app.add_subcommand(
      "north", "Says where true, grid and magnetic north are at a place and date");
  const auto o = std::make_shared<NorthOptions>();
  command->add_option("--job", o->job,
                      "job whose place, EPSG code, first run's date and stated norths are taken "
                      "where no option says them");
  AddNumber(*command, "--latitude-deg", o->latitude, units::kDeg, "WGS 84")
      ->check(CLI::Range(-90.0, 90.0));
  AddNumber(*command, "--longitude-deg", o->longitude, units::kDeg, "WGS 84, east positive")
      ->check(CLI::Range(-180.0, 360.0));
  AddNumber(*command, "--height-m", o->height, 1, "above the ellipsoid, for the field");
  command->add_option("--crs", o->crs, "projected system of the EPSG registry, as EPSG:23031");
  AddNumber(*command, "--easting", o->easting, 1, "of the place [unit of --crs, as a rule m]");
  AddNumber(*command, "--northing", o->northing, 1, "of the place [unit of --crs, as a rule m]");
  command->add_option("--date", o->date, "YYYY-MM-DD, of the magnetic field");
  command->add_option("--magnetic-model", o->model, "wmm2025 (default), wmm2020 or igrf14");
  command->add_option("--magnetic-data", o->data, "folder of the models, if others");
  AddNumber(*command, "--convergence-deg", o->stated_convergence, units::kDeg,
            "the operator's: it holds, ours is the check");
  AddNumber(*command, "--declination-deg", o->stated_declination, units::kDeg, "likewise");
  command->footer(
      "Example:\n  wellgyro north --latitude-deg 58.44 --longitude-deg 1.93 --crs EPSG:23031 \\\n"
      "      --date 2026-11-22");
  command->callback([o, &exit_code] { exit_code = RunNorth(*o); });
}

}  // namespace wellgyro::apps
