#include "wellgyro/calibration/field_checks.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "wellgyro/base/units.h"
#include "wellgyro/earth/earth.h"
#include "wellgyro/record/force_errors.h"

namespace wellgyro {
namespace {

class Checks {
 public:
  Checks(const StillWindow& window, const FieldCheckSetup& setup)
      : window_(window), setup_(setup) {}

  void Add(std::string code, std::string unit, double value, double sigma, double per_unit) {
    Check check = New(std::move(code), std::move(unit));
    check.value = value / per_unit;
    check.sigma = sigma / per_unit;
    check.limit = setup_.fail * *check.sigma;
    check.limit_source = "own sigma";
    check.looks = 1;
    const double size = std::abs(value);
    check.verdict = size <= setup_.warn * sigma   ? Verdict::kPass
                    : size <= setup_.fail * sigma ? Verdict::kWarn
                                                  : Verdict::kFail;
    checks_.push_back(std::move(check));
  }
  void NotDone(std::string code, std::string unit) {
    checks_.push_back(New(std::move(code), std::move(unit)));
  }
  std::vector<Check> Take() { return std::move(checks_); }

 private:
  Check New(std::string code, std::string unit) const {
    Check check;
    check.code = std::move(code);
    check.run = window_.run;
    check.md = window_.md;
    check.unit = std::move(unit);
    return check;
  }
  const StillWindow& window_;
  const FieldCheckSetup& setup_;
  std::vector<Check> checks_;
};

// Covariance of the mean rate: noise of the window, drift that it does not average, priors.
Eigen::Matrix3d RateCovariance(const StillWindow& window, const FieldCheckSetup& setup) {
  const ErrorPriors& e = setup.errors;
  const double seconds = window.seconds();
  Eigen::Vector3d variance = window.sigma_w_IT_T.cwiseAbs2();
  if (window.sigma_w_IT_T.isZero(0) && seconds > 0) {
    variance.setConstant(setup.gyro.angle_random_walk * setup.gyro.angle_random_walk / seconds);
  }
  const double across = std::hypot(window.f_T.x(), window.f_T.y());
  variance.array() += e.gyro_bias_sigma * e.gyro_bias_sigma +
                      setup.gyro.bias_instability * setup.gyro.bias_instability +
                      std::pow(e.gyro_scale_sigma * kEarthRate, 2) +
                      std::pow(e.gyro_misalignment_sigma * kEarthRate, 2);
  variance.head<2>().array() +=
      std::pow(e.mass_unbalance_sigma * across, 2) + std::pow(e.quadrature_sigma * across, 2);
  return variance.asDiagonal();
}

Eigen::Matrix3d ForceCovariance(const StillWindow& window, const FieldCheckSetup& setup) {
  Eigen::Vector3d variance = window.sigma_f_T.cwiseAbs2();
  const double seconds = window.seconds();
  if (window.sigma_f_T.isZero(0) && seconds > 0) {
    variance.setConstant(setup.errors.accel_noise * setup.errors.accel_noise / seconds);
  }
  const auto by = ForceErrors(setup.errors, window.f_T);
  return Eigen::Matrix3d(variance.asDiagonal()) + by * by.transpose();
}

double Root(const Eigen::VectorXd& gradient, const Eigen::MatrixXd& cov, double more) {
  return std::sqrt(gradient.dot(cov * gradient) + more * more);
}

// Nearest point of the ellipse (a cos t, b sin t) to (x, y), by its angle t.
double NearestAngle(double a, double b, double x, double y) {
  double best = 0, least = -1;
  for (int start = 0; start < 8; ++start) {
    double t = start * kPi / 4;
    for (int turn = 0; turn < 50; ++turn) {
      const double c = std::cos(t), s = std::sin(t);
      const double slope = (x - a * c) * a * s - (y - b * s) * b * c;
      const double bend = a * a * s * s + b * b * c * c + (x - a * c) * a * c + (y - b * s) * b * s;
      const double step = bend > 0 ? -slope / bend : (slope > 0 ? -0.1 : 0.1);
      t += std::clamp(step, -0.5, 0.5);
      if (std::abs(step) < 1e-14) break;
    }
    const double distance = std::hypot(x - a * std::cos(t), y - b * std::sin(t));
    if (least >= 0 && distance >= least) continue;
    least = distance;
    best = t;
  }
  return best;
}

void CheckTwoAxes(const StillWindow& window, const FieldCheckSetup& setup, Checks& checks) {
  const Eigen::Vector3d f = window.f_T.normalized();
  const double sine_inc = std::hypot(f.x(), f.y()), cosine_inc = -f.z();
  // High side and right side in the tool's cross-section; any will do where it is vertical.
  const Eigen::Vector2d high =
      sine_inc > 0 ? Eigen::Vector2d(f.x(), f.y()) / sine_inc : Eigen::Vector2d(1, 0);
  const Eigen::Vector2d right(-high.y(), high.x());
  const double latitude = setup.reference.latitude;
  const double centre = kEarthRate * std::sin(latitude) * sine_inc;
  const double level = kEarthRate * std::cos(latitude);
  const Eigen::Vector2d w = window.w_IT_T.head<2>();
  const double x = w.dot(high) - centre, y = w.dot(right);
  const double a = level * std::abs(cosine_inc), b = level;
  const double t = NearestAngle(a, b, x, y);
  const Eigen::Vector2d nearest(a * std::cos(t), b * std::sin(t));
  // Outward normal; of a flat ellipse, that along its short axis.
  Eigen::Vector2d normal(b * std::cos(t), a * std::sin(t));
  if (normal.norm() < 1e-3 * b) normal = Eigen::Vector2d(x >= 0 ? 1 : -1, 0);
  normal.normalize();
  const double value = normal.dot(Eigen::Vector2d(x, y) - nearest);
  const Eigen::Vector2d in_tool = normal.x() * high + normal.y() * right;
  const Eigen::Matrix2d cov = RateCovariance(window, setup).topLeftCorner<2, 2>();
  const double by_latitude =
      kEarthRate * (normal.x() * (std::cos(latitude) * sine_inc -
                                  std::sin(latitude) * std::abs(cosine_inc) * std::cos(t)) -
                    normal.y() * std::sin(latitude) * std::sin(t));
  checks.Add("earth_rate", "deg/h", value,
             Root(in_tool, cov, by_latitude * setup.errors.latitude_sigma), units::kDegPerHour);
}

void CheckThreeAxes(const StillWindow& window, const FieldCheckSetup& setup, Checks& checks) {
  const Eigen::Matrix3d cov = RateCovariance(window, setup);
  const double rate = window.w_IT_T.norm();
  checks.Add("earth_rate", "deg/h", rate - kEarthRate,
             Root(window.w_IT_T / std::max(rate, 1e-12), cov, 0), units::kDegPerHour);
  const double force = window.f_T.norm();
  const Eigen::Vector3d up = window.f_T / force;
  const Eigen::Vector3d by_force = (window.w_IT_T - window.w_IT_T.dot(up) * up) / force;
  const double tilt = Root(by_force, ForceCovariance(window, setup), 0);
  const double latitude = setup.reference.latitude, by_latitude = setup.errors.latitude_sigma;
  const double vertical = kEarthRate * std::sin(latitude);
  const double horizontal = kEarthRate * std::cos(latitude);
  checks.Add("earth_rate_vertical", "deg/h", window.w_IT_T.dot(up) - vertical,
             Root(up, cov, std::hypot(tilt, horizontal * by_latitude)), units::kDegPerHour);
  const Eigen::Vector3d level = window.w_IT_T - window.w_IT_T.dot(up) * up;
  // Tilted towards north by d, gravity leaves the vertical rate times d in the level.
  const double tilted = vertical / std::max(horizontal, 1e-12) * tilt;
  checks.Add(
      "earth_rate_horizontal", "deg/h", level.norm() - horizontal,
      Root(level / std::max(level.norm(), 1e-12), cov, std::hypot(tilted, vertical * by_latitude)),
      units::kDegPerHour);
}

void CheckField(const StillWindow& window, const FieldCheckSetup& setup, Checks& checks) {
  const FieldReference& reference = setup.reference;
  const double length = window.b_T.norm();
  if (!window.has_mag || !(length > 0) || !reference.field) {
    checks.NotDone("field", "nT");
  } else {
    checks.Add("field", "nT", length - *reference.field,
               std::hypot(setup.sigma_mag, reference.sigma_field), units::kNanotesla);
  }
  if (!window.has_mag || !(length > 0) || !reference.dip) {
    checks.NotDone("dip", "deg");
    return;
  }
  const Eigen::Vector3d down = -window.f_T.normalized(), m = window.b_T / length;
  const double dip = std::atan2(m.dot(down), (m - m.dot(down) * down).norm());
  const Eigen::Matrix3d cov = ForceCovariance(window, setup) / window.f_T.squaredNorm();
  const double by_force = std::sqrt(cov.diagonal().maxCoeff());
  checks.Add("dip", "deg", dip - *reference.dip,
             std::hypot(setup.sigma_mag / length, by_force, reference.sigma_dip), units::kDeg);
}

}  // namespace

std::vector<Check> CheckWindow(const StillWindow& window, const FieldCheckSetup& setup) {
  Checks checks(window, setup);
  const double force = window.f_T.norm();
  if (!(force > 0)) {
    for (const auto& [code, unit] : {std::pair("gravity", "m/s2"), std::pair("earth_rate", "deg/h"),
                                     std::pair("field", "nT"), std::pair("dip", "deg")}) {
      checks.NotDone(code, unit);
    }
    return checks.Take();
  }
  checks.Add(
      "gravity", "m/s2", force - setup.reference.gravity,
      Root(window.f_T / force, ForceCovariance(window, setup), setup.reference.sigma_gravity), 1);
  if (window.has_gz) {
    CheckThreeAxes(window, setup, checks);
  } else {
    CheckTwoAxes(window, setup, checks);
  }
  CheckField(window, setup, checks);
  if (setup.parity) {
    checks.Add("parity", "deg/h", setup.parity->value, setup.parity->sigma, 1);
  } else {
    checks.NotDone("parity", "deg/h");
  }
  return checks.Take();
}

Check CheckCalibrationDate(const ToolCalibration& tool, UtcTime data) {
  Check check;
  check.code = "calibration_date";
  check.unit = "d";
  check.limit_source = "tool file";
  if (tool.expires) {
    check.value = (*tool.expires - data).seconds() / units::kDay;
    check.limit = 0;
    check.verdict = *check.value > 0 ? Verdict::kPass : Verdict::kFail;
  }
  if (tool.calibrated && data < *tool.calibrated && check.verdict != Verdict::kFail) {
    check.code = "calibration_date_ahead";
    check.value = (data - *tool.calibrated).seconds() / units::kDay;
    check.limit = 0;
    check.verdict = Verdict::kWarn;
  }
  return check;
}

}  // namespace wellgyro
