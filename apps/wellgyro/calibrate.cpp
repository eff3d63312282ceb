#include <filesystem>
#include <functional>
#include <iterator>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <system_error>
#include <tuple>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

#include "wellgyro/base/units.h"
#include "wellgyro/calibration/tool_update.h"
#include "wellgyro/fit/affine_fit.h"
#include "wellgyro/fit/gyro_fit.h"
#include "wellgyro/fit/multi_station_fit.h"
#include "wellgyro/fit/position_fit.h"
#include "wellgyro/fit/roll_test.h"
#include "wellgyro/fit/scalar_fit.h"
#include "wellgyro/fit/thermometer_fit.h"
#include "wellgyro/io/atomic_file.h"
#include "wellgyro/io/bench_data.h"
#include "wellgyro/io/calibration_file.h"
#include "wellgyro/io/sha256.h"
#include "wellgyro/io/tool_file.h"
#include "wellgyro/record/sample.h"

#include "commands.h"
#include "report.h"

namespace wellgyro::apps {
namespace {

/// What a method made of the bench's readings.
struct Outcome {
  BenchCalibration calibration;
  std::optional<OrthogonalityCheck> check;
};

/// Everything that a method's options can say; each method asks for its own.
struct Options {
  std::string data, rate_table, out, tool;
  BenchReference reference;
  std::vector<std::string> said;  ///< references as the user gave them, for the file
  ToolUpdate update;
  std::vector<std::string> axes;
  std::string date, expires;

  ThermometerFitSetup thermometer;
  TwentyFourPositionSetup twenty_four;
  SixPositionSetup six;
  AffineSetup affine;
  OrthogonalitySetup orthogonality;
  ScalarSetup scalar;
  RollTestSetup roll;
  GyroFitSetup gyro;
  MultiStationSetup stations;
};

using Fit =
    std::function<Result<Outcome>(const BenchTable& data, const BenchTable& more, Options&)>;

Result<Outcome> Plain(Result<BenchCalibration> fitted) {
  if (!fitted) return fitted.fault();
  return Outcome{*std::move(fitted), std::nullopt};
}

/// Numbers from `low` to `high`; no other word is one.
CLI::Validator Within(double low, double high) {
  return {[low, high](std::string& word) -> std::string {
            double value = 0;
            if (CLI::detail::lexical_cast(word, value) && value >= low && value <= high) return {};
            return fmt::format("{} is no number from {:g} to {:g}", word, low, high);
          },
          {}};
}
constexpr double kLeast = 1e-15, kMost = 1e15;

/// An option whose number above zero, in the unit of its name, is held in another.
template <class T>
CLI::Option* AddNumber(CLI::App& command, const std::string& name, T& held, double unit,
                       const std::string& help) {
  return command
      .add_option_function<double>(
          name, [&held, unit](const double& value) { held = value * unit; }, help)
      ->check(Within(kLeast, kMost));
}

void AddReference(CLI::App& command, Options& o, const std::string& name, const std::string& help,
                  const CLI::Validator& range, const std::function<void(double)>& take) {
  command
      .add_option_function<double>(
          name,
          [&o, name, take](const double& value) {
            o.said.push_back(fmt::format("{} {}", name.substr(2), value));
            take(value);
          },
          help)
      ->check(range);
}

void AddGravity(CLI::App& command, Options& o) {
  BenchReference& r = o.reference;
  AddReference(command, o, "--gravity-g", "local gravity; readings are in g (default 1)",
               Within(0.97, 1.03), [&r](double g) {
                 r.gravity = g;
                 r.gravity_mps2 = g * units::kStandardGravity;
               });
  AddReference(command, o, "--gravity-mps2", "local gravity; readings are in m/s2",
               Within(9.5, 10.1), [&r](double g) { r.gravity = r.gravity_mps2 = g; });
}

void AddField(CLI::App& command, Options& o) {
  BenchReference& r = o.reference;
  AddReference(command, o, "--field-nt", "total magnetic field", Within(1e3, 2e5),
               [&r](double v) { r.field = v; });
  AddReference(command, o, "--dip-deg", "of the field, downwards", Within(-90, 90),
               [&r](double v) { r.dip = v * units::kDeg; });
}

void AddLatitude(CLI::App& command, Options& o) {
  AddReference(command, o, "--latitude-deg", "of the bench, or the well", Within(-90, 90),
               [&o](double v) { o.reference.latitude = v * units::kDeg; });
}

void AddAxes(CLI::App& command, Options& o) {
  const std::map<std::string, BenchAxes> words{{"trade", BenchAxes::kTrade},
                                               {"tool", BenchAxes::kTool}};
  command
      .add_option("--bench-axes", o.reference.axes,
                  "x and y of the bench: trade, toolface measured to y (default), or tool, "
                  "toolface measured to x as in jobs")
      ->transform(CLI::CheckedTransformer(words));
}

void AddTool(CLI::App& command, Options& o) {
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

std::optional<UtcTime> Date(const std::string& text, const char* option) {
  if (text.empty()) return std::nullopt;
  const auto date = DateOf(text);
  if (!date) {
    throw std::invalid_argument(fmt::format("{}: \"{}\" is no date, as 2026-01-31", option, text));
  }
  return date;
}

// Nothing is written over what it came from, nor two files in one place.
void RequireDistinct(const Options& o) {
  const std::pair<const char*, const std::string*> all[] = {{"--data", &o.data},
                                                            {"the readings to join", &o.rate_table},
                                                            {"--out", &o.out},
                                                            {"--tool", &o.tool}};
  for (std::size_t i = 0; i < std::size(all); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      std::error_code ignored;
      if (all[i].second->empty() || all[j].second->empty()) continue;
      if (*all[i].second == *all[j].second ||
          std::filesystem::equivalent(*all[i].second, *all[j].second, ignored)) {
        throw std::invalid_argument(
            fmt::format("{} and {} must be different files", all[j].first, all[i].first));
      }
    }
  }
}

void Complete(Options& o) {
  RequireDistinct(o);
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

Result<BenchTable> Read(const std::string& name, const std::string& role,
                        std::vector<InputFile>* inputs) {
  const Result<std::string> text = ReadTextFile(name);
  if (!text) return text.fault();
  inputs->push_back({role, name, name, Sha256Hex(*text)});
  return ParseBenchTable(*text, name);
}

std::optional<Fault> WriteFile(const std::filesystem::path& path, const std::string& bytes) {
  const std::filesystem::path folder = path.has_parent_path() ? path.parent_path() : ".";
  const OutputFile file{path.filename().string(), bytes};
  if (auto fault = WriteFiles(folder, {&file, 1})) return fault;
  fmt::print("{}\n", path.string());
  return std::nullopt;
}

Result<std::string> ToolText(const Options& o, const BenchCalibration& calibration) {
  ToolCalibration tool;
  if (std::filesystem::exists(o.tool)) {
    auto known = ReadToolFile(o.tool);
    if (!known) return known.fault();
    tool = *std::move(known);
  }
  return ToolToml(Updated(std::move(tool), calibration, o.update));
}

int Run(Options& o, const Fit& fit) {
  const auto unusable = [](const Fault& fault) {
    Complain(fault);
    return kUnusable;
  };
  Complete(o);
  CalibrationFile file;
  file.program = "wellgyro " WELLGYRO_VERSION;
  file.references = o.said;
  BenchTable data, more;
  for (const auto& [name, role, table] :
       {std::tuple(&o.data, "data", &data), std::tuple(&o.rate_table, "rate_table", &more)}) {
    if (name->empty()) continue;
    Result<BenchTable> read = Read(*name, role, &file.inputs);
    if (!read) return unusable(read.fault());
    *table = *std::move(read);
  }
  Result<Outcome> outcome = fit(data, more, o);
  if (!outcome) return unusable(outcome.fault());
  file.report = outcome->calibration.report;
  file.check = outcome->check;
  // What cannot be written is told before anything is.
  std::string tool;
  if (!o.tool.empty()) {
    Result<std::string> text = ToolText(o, outcome->calibration);
    if (!text) return unusable(text.fault());
    tool = *std::move(text);
  }
  fmt::print("{}", CalibrationSummary(file));
  if (auto fault = WriteFile(o.out, CalibrationToml(file))) return unusable(*fault);
  if (o.tool.empty()) return kDone;
  if (auto fault = WriteFile(o.tool, tool)) return unusable(*fault);
  return kDone;
}

/// One method: its subcommand, with the options that all have.
CLI::App& AddMethod(CLI::App& calibrate, int& exit_code, const std::shared_ptr<Options>& o,
                    const std::string& name, const std::string& help, const std::string& columns,
                    Fit fit) {
  CLI::App* const command = calibrate.add_subcommand(name, help);
  command->add_option("--data", o->data, "readings of the bench (CSV): " + columns)->required();
  command->add_option("--out", o->out, "calibration file to write (TOML)")->required();
  command->footer(
      fmt::format("Example:\n  wellgyro calibrate {} --data bench.csv --out {}.toml", name, name));
  command->callback([o, &exit_code, fit = std::move(fit), name] {
    try {
      exit_code = Run(*o, fit);
    } catch (const std::invalid_argument& error) {
      Complain(fmt::format("{}; see wellgyro calibrate {} --help", error.what(), name));
      exit_code = kUsage;
    }
  });
  return *command;
}

using Shared = std::shared_ptr<Options>;

void AddPositions(CLI::App& calibrate, int& exit_code, const Shared& o) {
  CLI::App& twenty_four = AddMethod(
      calibrate, exit_code, o, "24-position",
      "three accelerometers in volts, each axis up and down at four rotations",
      "axis,dir,rot_deg,channel,volt and T_C where there are several temperatures",
      [](const BenchTable& data, const BenchTable&, Options& options) {
        options.twenty_four.axes = options.reference.axes;
        options.twenty_four.gravity = options.reference.gravity_mps2 / units::kStandardGravity;
        return Plain(FitTwentyFourPositions(data, options.twenty_four));
      });
  AddGravity(twenty_four, *o);
  AddAxes(twenty_four, *o);
  AddNumber(twenty_four, "--sigma-v", o->twenty_four.sigma, 1, "of a settled mean");
  AddNumber(twenty_four, "--settle-v", o->twenty_four.settle_tolerance, 1,
            "readings that agree within it have settled, default 1e-4");
  twenty_four
      .add_option("--max-degree", o->twenty_four.max_degree,
                  "of the polynomials in temperature, default 3")
      ->check(CLI::Range(0, 3));
  AddTool(twenty_four, *o);
  CLI::App& six = AddMethod(calibrate, exit_code, o, "six-position",
                            "three accelerometers with pulse outputs, each axis up and down",
                            "axis,sign,T_s,Nx,Ny,Nz and axb,ayb,azb where the fixture is not exact",
                            [](const BenchTable& data, const BenchTable&, Options& options) {
                              options.six.axes = options.reference.axes;
                              options.six.gravity = options.reference.gravity_mps2;
                              return Plain(FitSixPositions(data, options.six));
                            });
  AddGravity(six, *o);
  AddAxes(six, *o);
  six.add_flag_callback(
      "--no-k2", [o] { o->six.second_order = false; },
      "leave the second-order term out; the bias is that of each own pair");
  AddNumber(six, "--sigma-pulses", o->six.sigma, 1, "of the pulses counted in a position");
  AddNumber(six, "--tilt-arcsec", o->six.tilt_sigma, units::kArcsec,
            "1 sigma of the fixture's tilt, each position anew");
  AddTool(six, *o);
}

void AddThermometer(CLI::App& calibrate, int& exit_code, const Shared& o) {
  CLI::App& command = AddMethod(calibrate, exit_code, o, "thermometer",
                                "a thermometer against others", "t_m,ref1,ref2 ... in degC",
                                [](const BenchTable& data, const BenchTable&, Options& options) {
                                  return Plain(FitThermometer(data, options.thermometer));
                                });
  command.add_option("--knee-degc", o->thermometer.knee, "where the readings bend, default 175")
      ->check(Within(-273, 1000));
  command.add_flag("--fit-knee", o->thermometer.fit_knee, "find the knee");
  AddNumber(command, "--sigma-degc", o->thermometer.sigma, 1, "of a reading");
  AddTool(command, *o);
}

void AddAttitudes(CLI::App& calibrate, int& exit_code, const Shared& o) {
  CLI::App& affine = AddMethod(
      calibrate, exit_code, o, "affine", "accelerometers and magnetometers at known attitudes",
      "inc,az,tf in deg, Gx,Gy,Gz (gravity) or fx,fy,fz or vx,vy,vz (force), Mx,My,Mz",
      [](const BenchTable& data, const BenchTable&, Options& options) {
        options.affine.reference = options.reference;
        return Plain(FitAffine(data, options.affine));
      });
  const std::map<std::string, AffineSetup::Order> orders{{"none", AffineSetup::Order::kNone},
                                                         {"own", AffineSetup::Order::kOwn},
                                                         {"full", AffineSetup::Order::kFull}};
  affine
      .add_option("--second-order", o->affine.order,
                  "of the accelerometers: none (default), own axis, or full with products")
      ->transform(CLI::CheckedTransformer(orders));
  AddNumber(affine, "--sigma-accel", o->affine.sigma_accel, 1, "of a reading, its unit");
  AddNumber(affine, "--sigma-mag", o->affine.sigma_mag, 1, "of a reading, its unit");
  AddNumber(affine, "--tilt-deg", o->affine.tilt_sigma, units::kDeg,
            "1 sigma of each attitude, about each axis; needs the sigmas");
  CLI::App& orthogonality = AddMethod(
      calibrate, exit_code, o, "orthogonality",
      "three accelerometers and three fluxgates: trigonometric coefficients, and the affine model "
      "from the same readings",
      "seq,inc,az,tf,Gx,Gy,Gz,Mx,My,Mz; seq 0 verifies",
      [](const BenchTable& data, const BenchTable&, Options& options) -> Result<Outcome> {
        options.orthogonality.reference = options.reference;
        auto fitted = FitOrthogonality(data, options.orthogonality);
        if (!fitted) return fitted.fault();
        return Outcome{std::move(fitted->calibration), fitted->check};
      });
  orthogonality.add_flag("--free-frequency", o->orthogonality.free_frequency,
                         "find the frequencies x_k2, where they differ from 1");
  AddNumber(orthogonality, "--sigma-accel", o->orthogonality.sigma_accel, 1, "of a reading");
  AddNumber(orthogonality, "--sigma-mag", o->orthogonality.sigma_mag, 1, "of a reading");
  for (CLI::App* command : {&affine, &orthogonality}) {
    AddGravity(*command, *o);
    AddField(*command, *o);
    AddReference(*command, *o, "--declination-deg", "of the field against the table's azimuths",
                 Within(-180, 180), [o](double v) { o->reference.declination = v * units::kDeg; });
    AddAxes(*command, *o);
    AddTool(*command, *o);
  }
}

void AddScalar(CLI::App& calibrate, int& exit_code, const Shared& o) {
  CLI::App& scalar = AddMethod(calibrate, exit_code, o, "scalar",
                               "accelerometers without a turntable: gravity has one length",
                               "ax,ay,az or Gx,Gy,Gz (gravity), or fx,fy,fz or vx,vy,vz (force)",
                               [](const BenchTable& data, const BenchTable&, Options& options) {
                                 options.scalar.reference = options.reference;
                                 return Plain(FitScalar(data, options.scalar));
                               });
  CLI::App& dip = AddMethod(calibrate, exit_code, o, "scalar-dip",
                            "accelerometers and magnetometers together, by lengths and dip",
                            "ax,ay,az,mx,my,mz",
                            [](const BenchTable& data, const BenchTable&, Options& options) {
                              options.scalar.reference = options.reference;
                              return Plain(FitScalarDip(data, options.scalar));
                            });
  AddField(dip, *o);
  dip.add_flag("--free-dip", o->scalar.free_dip, "find the dip");
  AddNumber(dip, "--sigma-mag", o->scalar.sigma_mag, 1, "of a reading, its unit");
  for (CLI::App* command : {&scalar, &dip}) {
    AddGravity(*command, *o);
    AddNumber(*command, "--sigma-accel", o->scalar.sigma_accel, 1, "of a reading, its unit");
    AddAxes(*command, *o);
    AddTool(*command, *o);
  }
  CLI::App& roll = AddMethod(calibrate, exit_code, o, "roll-test",
                             "the housing's axis in the accelerometers' frame",
                             "set,fx,fy,fz, calibrated, rolled in V-blocks",
                             [](const BenchTable& data, const BenchTable&, Options& options) {
                               options.roll.reference = options.reference;
                               return Plain(FitRollTest(data, options.roll));
                             });
  AddGravity(roll, *o);
  AddNumber(roll, "--sigma-accel", o->roll.sigma, 1, "of a reading, its unit");
  AddAxes(roll, *o);
  AddTool(roll, *o);
}

void AddGyros(CLI::App& calibrate, int& exit_code, const Shared& o) {
  CLI::App& rest = AddMethod(calibrate, exit_code, o, "gyro-multi-position",
                             "gyros at rest against the Earth's rate",
                             "inc,az,tf,fx,fy,fz,m_x1,m_y1 ... in deg, g, deg/h",
                             [](const BenchTable& data, const BenchTable& more, Options& options) {
                               options.gyro.reference = options.reference;
                               return Plain(FitGyro(data, more, options.gyro));
                             });
  rest.add_option("--rate-table", o->rate_table,
                  "readings of a rate table to join: axis,rate_deg_s and the same channels");
  rest.add_flag("--fit-north", o->gyro.fit_north, "find the fixture's north offset");
  CLI::App& table =
      AddMethod(calibrate, exit_code, o, "gyro-rate-table", "gyros on a rate table, axis up",
                "axis,rate_deg_s,m_x1,m_y1 ... in deg/s, deg/h",
                [](const BenchTable& data, const BenchTable& more, Options& options) {
                  options.gyro.reference = options.reference;
                  return Plain(FitGyro(more, data, options.gyro));
                });
  table.add_option("--multi-position", o->rate_table,
                   "readings at rest to join: inc,az,tf,fx,fy,fz and the same channels");
  const std::map<std::string, GyroForceModel> models{{"dual-axis", GyroForceModel::kDualAxis},
                                                     {"full", GyroForceModel::kFull},
                                                     {"none", GyroForceModel::kNone}};
  for (CLI::App* command : {&rest, &table}) {
    AddLatitude(*command, *o);
    AddAxes(*command, *o);
    command
        ->add_option_function<std::string>(
            "--force", [o, models](const std::string& word) { o->gyro.force = models.at(word); },
            "what they feel of it: dual-axis (tuned rotors), full (vibrating), none (optical); by "
            "the channels' names if not given")
        ->check(CLI::IsMember({"dual-axis", "full", "none"}));
    AddNumber(*command, "--sigma-deg-per-h", o->gyro.sigma, 1, "of a reading at rest");
    AddNumber(*command, "--sigma-table-deg-per-h", o->gyro.sigma_table, 1,
              "of a reading on the table");
    AddTool(*command, *o);
  }
}

void AddStations(CLI::App& calibrate, int& exit_code, const Shared& o) {
  CLI::App& command = AddMethod(calibrate, exit_code, o, "multi-station",
                                "bias of magnetometers or gyros from the stations of a run",
                                "Gx,Gy,Gz and Mx,My,Mz or wx,wy or wx,wy,wz",
                                [](const BenchTable& data, const BenchTable&, Options& options) {
                                  options.stations.reference = options.reference;
                                  return Plain(FitMultiStation(data, options.stations));
                                });
  AddGravity(command, *o);
  AddField(command, *o);
  AddLatitude(command, *o);
  MultiStationSetup& s = o->stations;
  AddNumber(command, "--sigma-field-nt", s.sigma_field, 1, "of the field at a station");
  AddNumber(command, "--sigma-dip-deg", s.sigma_dip, units::kDeg, "of the dip at a station");
  AddNumber(command, "--sigma-rate-deg-per-h", s.sigma_rate, 1, "of the rate at a station");
  AddNumber(command, "--prior-bias", s.prior_bias, 1, "1 sigma about zero, nT or deg/h");
  AddNumber(command, "--prior-scale", s.prior_scale, 1, "1 sigma about zero");
}

}  // namespace

void AddCalibrate(CLI::App& app, int& exit_code) {
  CLI::App* const command =
      app.add_subcommand("calibrate", "bench data -> calibration with covariance and residuals");
  command->require_subcommand(1);
  command->footer(
      "Example:\n  wellgyro calibrate six-position --data bench.csv --out accel.toml \\\n"
      "      --gravity-mps2 9.8123 --tool tool.toml --channels 3,4,5");
  const auto options = std::make_shared<Options>();
  AddPositions(*command, exit_code, options);
  AddThermometer(*command, exit_code, options);
  AddAttitudes(*command, exit_code, options);
  AddScalar(*command, exit_code, options);
  AddGyros(*command, exit_code, options);
  AddStations(*command, exit_code, options);
}

}  // namespace wellgyro::apps
