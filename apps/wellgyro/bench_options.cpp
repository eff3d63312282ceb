#include "bench_options.h"

#include <optional>
#include <stdexcept>
#include <utility>

#include <fmt/core.h>

#include "wellgyro/base/units.h"
#include "wellgyro/earth/earth.h"
#include "wellgyro/io/toml/tool_file.h"
#include "wellgyro/record/sample.h"

#include "choice.h"
#include "distinct.h"

namespace wellgyro::apps {
namespace {

CLI::Option* AddReference(CLI::App& command, BenchOptions& o, const std::string& name,
                          const std::string& help, const CLI::Validator& range,
                          const std::function<void(double)>& take) {
  return command
      .add_option_function<double>(
          name,
          [&o, name, take](const double& value) {
            o.said.push_back(fmt::format("{} {}", name.substr(2), value));
            take(value);
          },
          help)
      ->check(range);
}

std::optional<UtcTime> Date(const std::string& text, const char* option) {
  if (text.empty()) return std::nullopt;
  const auto date = DateOf(text);
  if (!date) {
    throw std::invalid_argument(fmt::format("{}: \"{}\" is no date, as 2026-01-31", option, text));
  }
  return date;
}

}  // namespace

CLI::Validator Within(double low, double high) {
  return {[low, high](std::string& word) -> std::string {
            double value = 0;
            if (CLI::detail::lexical_cast(word, value) && value >= low && value <= high) return {};
            return fmt::format("{} is no number from {:g} to {:g}", word, low, high);
          },
          {}};
}

CLI::Validator AboveZero() {
  constexpr double kLeast = 1e-15, kMost = 1e15;
  return Within(kLeast, kMost);
}

CLI::Option* AddSigma(CLI::App& command, const BenchSigma& sigma, ToolFitSetup& setup,
                      std::string_view otherwise) {
  const std::optional<double> standard = sigma.Of(setup);
  return command
      .add_option_function<double>(
          fmt::format("--{}", sigma.name),
          [&sigma, &setup](const double& value) { sigma.Take(value, setup); },
          standard ? fmt::format("{}, default {:.4g}", sigma.meaning, *standard)
                   : fmt::format("{}; {}", sigma.meaning, otherwise))
      ->check(AboveZero());
}

void AddGravity(CLI::App& command, BenchOptions& o) {
  BenchReference& r = o.reference;
  CLI::Option* const in_g = AddReference(command, o, "--gravity-g",
                                         "local gravity; readings are in g (default: normal at "
                                         "the latitude, without one 1)",
                                         Within(0.97, 1.03), [&r, &o](double g) {
                                           o.gravity_stated = true;
                                           r.gravity = g;
                                           r.gravity_mps2 = g * units::kStandardGravity;
                                         });
  AddReference(command, o, "--gravity-mps2", "local gravity; readings are in m/s2",
               Within(9.5, 10.1),
               [&r, &o](double g) {
                 o.gravity_stated = true;
                 r.gravity = r.gravity_mps2 = g;
               })
      ->excludes(in_g);
}

void AddField(CLI::App& command, BenchOptions& o) {
  BenchReference& r = o.reference;
  AddReference(command, o, "--field-nt", "total magnetic field", Within(1e3, 2e5),
               [&r](double v) { r.field = v; });
  AddReference(command, o, "--dip-deg", "of the field, downwards", Within(-90, 90),
               [&r](double v) { r.dip = v * units::kDeg; });
}

void AddDeclination(CLI::App& command, BenchOptions& o) {
  AddReference(command, o, "--declination-deg", "of the field against the table's azimuths",
               Within(-180, 180), [&o](double v) { o.reference.declination = v * units::kDeg; });
}

void AddLatitude(CLI::App& command, BenchOptions& o) {
  AddReference(command, o, "--latitude-deg", "of the bench, or the well", Within(-90, 90),
               [&o](double v) { o.reference.latitude = v * units::kDeg; });
}

void AddAxes(CLI::App& command, BenchOptions& o) {
  CLI::Option* const axes =
      command.add_option("--bench-axes", o.reference.axes,
                         "x and y of the bench: trade, toolface measured to y (default), or tool, "
                         "toolface measured to x as in jobs");
  TakeOneOf<BenchAxes>(axes, {{"trade", BenchAxes::kTrade}, {"tool", BenchAxes::kTool}});
}

void AddTool(CLI::App& command, BenchOptions& o) {
  const std::string group = "Tool file";
  CLI::Option* const tool =
      command.add_option("--tool", o.tool, "tool file (TOML) to make or bring up to date");
  tool->group(group);
  const auto add = [&](CLI::Option* option) { option->group(group)->needs(tool); };
  add(command
          .add_option("--channels", o.update.channels,
                      "places of the channels in raw_batch_t, as 3,4,5")
          ->delimiter(','));
  add(command
          .add_option("--unit-per-count", o.update.unit_per_count,
                      "the readings' unit in one count, one number or one a channel")
          ->delimiter(','));
  add(command
          .add_option("--axes", o.axes,
                      "axes of the sensors along x, y, z of the tool, as +y,-x,+z, in place of "
                      "the bench's")
          ->delimiter(','));
  add(command.add_option("--thermometer", o.update.thermometer, "number of it in the tool file")
          ->check(CLI::Range(0, RawSample::kTemperaturesMax - 1)));
  add(command
          .add_option("--thermometer-channel", o.update.thermometer_channel,
                      "its place in raw_batch_t")
          ->check(CLI::Range(0, RawSample::kTemperaturesMax - 1)));
  add(command.add_option("--asset-serial", o.update.asset_serial, "of the tool"));
  add(command.add_option("--sensor-serials", o.update.sensor_serials, "separated by ;"));
  add(command.add_option("--date", o.date, "of the calibration, as 2026-01-31"));
  add(command.add_option("--expires", o.expires, "when it does, as 2026-07-31"));
}

void TakeGravity(BenchOptions& o) {
  if (o.gravity_stated || !o.reference.latitude) return;
  o.reference.gravity_mps2 = SiteAt(*o.reference.latitude, 0).gravity;
}

void Complete(BenchOptions& o) {
  TakeGravity(o);
  const NamedFile files[] = {
      {"--data", o.data}, {"the readings to join", o.joined}, {"--out", o.out}, {"--tool", o.tool}};
  RequireDistinct(files);
  o.update.axes = o.reference.axes;
  o.update.calibrated = Date(o.date, "--date");
  o.update.expires = Date(o.expires, "--expires");
  if (o.update.calibrated && o.update.expires && !(*o.update.calibrated < *o.update.expires)) {
    throw std::invalid_argument("--expires must come after --date");
  }
  if (o.axes.empty()) return;
  o.update.R_TS = AxesOf(o.axes);
  if (!o.update.R_TS) {
    throw std::invalid_argument("--axes takes three axes at right angles, as +y,-x,+z");
  }
}

}  // namespace wellgyro::apps
