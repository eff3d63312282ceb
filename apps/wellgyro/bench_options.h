#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>

#include "wellgyro/calibration/tool_update.h"
#include "wellgyro/fit/affine_fit.h"
#include "wellgyro/fit/bench_sigmas.h"
#include "wellgyro/fit/gyro_fit.h"
#include "wellgyro/fit/multi_station_fit.h"
#include "wellgyro/fit/position_fit.h"
#include "wellgyro/fit/roll_test.h"
#include "wellgyro/fit/scalar_fit.h"
#include "wellgyro/fit/thermometer_fit.h"

namespace wellgyro::apps {

/// Everything that the options of the bench methods can say; each method asks for its own.
struct BenchOptions {
  std::string data, joined, out, tool;
  BenchReference reference;
  bool gravity_stated = false;
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

/// Numbers from `low` to `high`; no other word is one.
CLI::Validator Within(double low, double high);

/// Numbers above zero, as people write them.
CLI::Validator AboveZero();

/// An option whose number above zero, in the unit of its name, is held in another.
template <class T>
CLI::Option* AddPositive(CLI::App& command, const std::string& name, T& held, double unit,
                         const std::string& help) {
  return command
      .add_option_function<double>(
          name, [&held, unit](const double& value) { held = value * unit; }, help)
      ->check(AboveZero());
}

// Options that several methods have. The command's callbacks write to `o`, which must outlive it.
void AddGravity(CLI::App& command, BenchOptions& o);
void AddField(CLI::App& command, BenchOptions& o);
void AddDeclination(CLI::App& command, BenchOptions& o);
void AddLatitude(CLI::App& command, BenchOptions& o);
void AddAxes(CLI::App& command, BenchOptions& o);
void AddTool(CLI::App& command, BenchOptions& o);

/// --NAME: a sigma of the bench, written to `setup`, which must outlive the command. The help says
/// what it is where it is not given: its default, or `otherwise`.
CLI::Option* AddSigma(CLI::App& command, const BenchSigma& sigma, ToolFitSetup& setup,
                      std::string_view otherwise);

/// Where gravity is not stated and the latitude is: normal gravity there at sea level, to 1e-3 of
/// it for 3 km of height; readings are in that.
void TakeGravity(BenchOptions& o);

/// What follows from the options together; throws std::invalid_argument where they contradict each
/// other.
void Complete(BenchOptions& o);

}  // namespace wellgyro::apps
