#include "bench_methods.h"

#include <string>
#include <utility>

#include "wellgyro/base/units.h"

#include "choice.h"

namespace wellgyro::apps {
namespace {

Result<BenchOutcome> Plain(Result<BenchCalibration> fitted) {
  if (!fitted) return fitted.fault();
  return BenchOutcome{*std::move(fitted), std::nullopt};
}

// A fit of one table against what stands around the bench.
template <auto kFit, auto kSetup>
Result<BenchOutcome> AgainstReference(const BenchTable& data, const BenchTable&, BenchOptions& o) {
  auto& setup = o.*kSetup;
  setup.reference = o.reference;
  return Plain(kFit(data, setup));
}

Result<BenchOutcome> TwentyFour(const BenchTable& data, const BenchTable&, BenchOptions& o) {
  o.twenty_four.axes = o.reference.axes;
  o.twenty_four.gravity = o.reference.gravity_mps2 / units::kStandardGravity;
  return Plain(FitTwentyFourPositions(data, o.twenty_four));
}

Result<BenchOutcome> Six(const BenchTable& data, const BenchTable&, BenchOptions& o) {
  o.six.axes = o.reference.axes;
  o.six.gravity = o.reference.gravity_mps2;
  o.six.gravity_stated = o.gravity_stated;
  return Plain(FitSixPositions(data, o.six));
}

Result<BenchOutcome> Thermometer(const BenchTable& data, const BenchTable&, BenchOptions& o) {
  return Plain(FitThermometer(data, o.thermometer));
}

Result<BenchOutcome> Orthogonality(const BenchTable& data, const BenchTable&, BenchOptions& o) {
  o.orthogonality.reference = o.reference;
  auto fitted = FitOrthogonality(data, o.orthogonality);
  if (!fitted) return fitted.fault();
  return BenchOutcome{std::move(fitted->calibration), fitted->check};
}

Result<BenchOutcome> GyrosAtRest(const BenchTable& rest, const BenchTable& table, BenchOptions& o) {
  o.gyro.reference = o.reference;
  return Plain(FitGyro(rest, table, o.gyro));
}

Result<BenchOutcome> GyrosOnTable(const BenchTable& table, const BenchTable& rest,
                                  BenchOptions& o) {
  return GyrosAtRest(rest, table, o);
}

void TwentyFourOptions(CLI::App& command, BenchOptions& o) {
  AddGravity(command, o);
  AddAxes(command, o);
  AddPositive(command, "--sigma-v", o.twenty_four.sigma, 1, "of a settled mean");
  AddPositive(command, "--settle-v", o.twenty_four.settle_tolerance, 1,
              "readings that agree within it have settled, default 1e-4");
  command
      .add_option("--max-degree", o.twenty_four.max_degree,
                  "of the polynomials in temperature, default 3")
      ->check(CLI::Range(0, 3));
  AddTool(command, o);
}

void SixOptions(CLI::App& command, BenchOptions& o) {
  AddGravity(command, o);
  AddAxes(command, o);
  command.add_flag_callback(
      "--no-k2", [&o] { o.six.second_order = false; },
      "leave the second-order term out; the bias is that of each own pair");
  AddPositive(command, "--sigma-pulses", o.six.sigma, 1, "of the pulses counted in a position");
  AddPositive(command, "--tilt-arcsec", o.six.tilt_sigma, units::kArcsec,
              "1 sigma of the fixture's tilt, each position anew; needs --sigma-pulses");
  AddTool(command, o);
}

void ThermometerOptions(CLI::App& command, BenchOptions& o) {
  command.add_option("--knee-degc", o.thermometer.knee, "where the readings bend, default 175")
      ->check(Within(-273, 1000));
  command.add_flag("--fit-knee", o.thermometer.fit_knee, "find the knee");
  AddPositive(command, "--sigma-degc", o.thermometer.sigma, 1, "of a reading");
  AddTool(command, o);
}

// Of sensors at known attitudes in gravity and the field.
void AttitudeOptions(CLI::App& command, BenchOptions& o) {
  AddGravity(command, o);
  AddField(command, o);
  AddDeclination(command, o);
  AddAxes(command, o);
  AddTool(command, o);
}

void AffineOptions(CLI::App& command, BenchOptions& o) {
  using Order = AffineSetup::Order;
  TakeOneOf<Order>(
      command.add_option("--second-order", o.affine.order,
                         "of the accelerometers: none (default), own axis, or full with products"),
      {{"none", Order::kNone}, {"own", Order::kOwn}, {"full", Order::kFull}});
  AddPositive(command, "--sigma-accel", o.affine.sigma_accel, 1, "of a reading, its unit");
  AddPositive(command, "--sigma-mag", o.affine.sigma_mag, 1, "of a reading, its unit");
  AddPositive(command, "--tilt-deg", o.affine.tilt_sigma, units::kDeg,
              "1 sigma of each attitude, about each axis; needs the sigmas");
  AttitudeOptions(command, o);
}

void OrthogonalityOptions(CLI::App& command, BenchOptions& o) {
  command.add_flag("--free-frequency", o.orthogonality.free_frequency,
                   "find the frequencies x_k2, where they differ from 1");
  AddPositive(command, "--sigma-accel", o.orthogonality.sigma_accel, 1, "of a reading");
  AddPositive(command, "--sigma-mag", o.orthogonality.sigma_mag, 1, "of a reading");
  AttitudeOptions(command, o);
}

// Of accelerometers in gravity alone.
template <auto kSetup, auto kSigma>
void GravityOptions(CLI::App& command, BenchOptions& o) {
  AddGravity(command, o);
  AddPositive(command, "--sigma-accel", (o.*kSetup).*kSigma, 1, "of a reading, its unit");
  AddAxes(command, o);
  AddTool(command, o);
}
constexpr auto kScalarOptions = GravityOptions<&BenchOptions::scalar, &ScalarSetup::sigma_accel>;

void ScalarDipOptions(CLI::App& command, BenchOptions& o) {
  AddField(command, o);
  command.add_flag("--free-dip", o.scalar.free_dip, "find the dip");
  AddPositive(command, "--sigma-mag", o.scalar.sigma_mag, 1, "of a reading, its unit");
  kScalarOptions(command, o);
}

void GyroOptions(CLI::App& command, BenchOptions& o) {
  AddLatitude(command, o);
  AddAxes(command, o);
  CLI::Option* const force = command.add_option(
      "--force", o.gyro.force,
      "what they feel of it: dual-axis (tuned rotors), full (vibrating), none (optical); by "
      "the channels' names if not given");
  TakeOneOf<GyroForceModel>(force, {{"dual-axis", GyroForceModel::kDualAxis},
                                    {"full", GyroForceModel::kFull},
                                    {"none", GyroForceModel::kNone}});
  AddPositive(command, "--sigma-deg-per-h", o.gyro.sigma, 1, "of a reading at rest");
  AddPositive(command, "--sigma-table-deg-per-h", o.gyro.sigma_table, 1,
              "of a reading on the table");
  AddTool(command, o);
}

void AtRestOptions(CLI::App& command, BenchOptions& o) {
  command.add_option("--rate-table", o.joined,
                     "readings of a rate table to join: axis,rate_deg_s and the same channels");
  command.add_flag("--fit-north", o.gyro.fit_north, "find the fixture's north offset");
  GyroOptions(command, o);
}

void OnTableOptions(CLI::App& command, BenchOptions& o) {
  command.add_option("--multi-position", o.joined,
                     "readings at rest to join: inc,az,tf,fx,fy,fz and the same channels");
  GyroOptions(command, o);
}

void StationOptions(CLI::App& command, BenchOptions& o) {
  AddGravity(command, o);
  AddField(command, o);
  AddLatitude(command, o);
  MultiStationSetup& s = o.stations;
  AddPositive(command, "--sigma-field-nt", s.sigma_field, 1, "of the field at a station");
  AddPositive(command, "--sigma-dip-deg", s.sigma_dip, units::kDeg, "of the dip at a station");
  AddPositive(command, "--sigma-rate-deg-per-h", s.sigma_rate, 1, "of the rate at a station");
  AddPositive(command, "--prior-bias", s.prior_bias, 1, "1 sigma about zero, nT or deg/h");
  AddPositive(command, "--prior-scale", s.prior_scale, 1, "1 sigma about zero");
}

constexpr const char* kField = " --field-nt 50000 --dip-deg 65";
constexpr const char* kLatitude = " --latitude-deg 60";

constexpr BenchMethod kMethods[] = {
    {"24-position", "three accelerometers in volts, each axis up and down at four rotations",
     "axis,dir,rot_deg,channel,volt and T_C where there are several temperatures", "",
     TwentyFourOptions, TwentyFour},
    {"six-position", "three accelerometers with pulse outputs, each axis up and down",
     "axis,sign,T_s,Nx,Ny,Nz and axb,ayb,azb where the fixture is not exact", "", SixOptions, Six},
    {"thermometer", "a thermometer against others", "t_m,ref1,ref2 ... in degC", "",
     ThermometerOptions, Thermometer},
    {"affine", "accelerometers and magnetometers at known attitudes",
     "inc,az,tf in deg, Gx,Gy,Gz (gravity) or fx,fy,fz or vx,vy,vz (force), Mx,My,Mz", kField,
     AffineOptions, AgainstReference<FitAffine, &BenchOptions::affine>},
    {"orthogonality",
     "three accelerometers and three fluxgates: trigonometric coefficients, and the affine model "
     "from the same readings",
     "seq,inc,az,tf,Gx,Gy,Gz,Mx,My,Mz; seq 0 verifies", kField, OrthogonalityOptions,
     Orthogonality},
    {"scalar", "accelerometers without a turntable: gravity has one length",
     "ax,ay,az or Gx,Gy,Gz (gravity), or fx,fy,fz or vx,vy,vz (force)", "", kScalarOptions,
     AgainstReference<FitScalar, &BenchOptions::scalar>},
    {"scalar-dip", "accelerometers and magnetometers together, by lengths and dip",
     "ax,ay,az,mx,my,mz", kField, ScalarDipOptions,
     AgainstReference<FitScalarDip, &BenchOptions::scalar>},
    {"roll-test", "the housing's axis in the accelerometers' frame",
     "set,fx,fy,fz, calibrated, rolled in V-blocks", "",
     GravityOptions<&BenchOptions::roll, &RollTestSetup::sigma>,
     AgainstReference<FitRollTest, &BenchOptions::roll>},
    {"gyro-multi-position", "gyros at rest against the Earth's rate",
     "inc,az,tf,fx,fy,fz,m_x1,m_y1 ... in deg, g, deg/h", kLatitude, AtRestOptions, GyrosAtRest,
     "rate_table"},
    {"gyro-rate-table", "gyros on a rate table, axis up",
     "axis,rate_deg_s,m_x1,m_y1 ... in deg/s, deg/h", kLatitude, OnTableOptions, GyrosOnTable,
     "multi_position"},
    {"multi-station", "bias of magnetometers or gyros from the stations of a run",
     "Gx,Gy,Gz and Mx,My,Mz or wx,wy or wx,wy,wz", kField, StationOptions,
     AgainstReference<FitMultiStation, &BenchOptions::stations>},
};

}  // namespace

std::span<const BenchMethod> BenchMethods() { return kMethods; }

}  // namespace wellgyro::apps
