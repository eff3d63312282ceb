#include "wellgyro/io/exchange/legs_internal.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "wellgyro/base/angle.h"
#include "wellgyro/base/units.h"
#include "wellgyro/math/median.h"
#include "wellgyro/math/rotation.h"
#include "wellgyro/math/sinc.h"
#include "wellgyro/trajectory/minimum_curvature.h"

namespace wellgyro::witness {
namespace {

using Complex = std::complex<double>;

Eigen::Vector3d ByRadius(double length, double i1, double a1, double i2, double a2) {
  // Means of sine and cosine over angles that change evenly with depth.
  const double turn = WrapPi(a2 - a1), bend = i2 - i1;
  const double i = (i1 + i2) / 2, a = a1 + turn / 2;
  const double across = std::sin(i) * Sinc(bend / 2) * Sinc(turn / 2);
  return length *
         Eigen::Vector3d(across * std::cos(a), across * std::sin(a), std::cos(i) * Sinc(bend / 2));
}

double WeightedMedian(std::vector<std::pair<double, double>>& values) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  double all = 0, sum = 0;
  for (const auto& [value, weight] : values) all += weight;
  for (const auto& [value, weight] : values) {
    sum += weight;
    if (2 * sum >= all) return value;
  }
  return values.back().first;
}

// Pairs (computed, given) that share a factor, but for some that are spoilt. The factor comes from
// medians first, then by least squares from those that agree with it.
struct CommonFactor {
  Complex z{1, 0};
  double sigma = 0, median = 0;
};
CommonFactor FactorOf(const std::vector<std::pair<Complex, Complex>>& pairs) {
  std::vector<std::pair<double, double>> real, imaginary;
  for (const auto& [c, g] : pairs) {
    if (std::abs(c) < 1e-9) continue;
    const Complex z = g / c;
    real.emplace_back(z.real(), std::abs(c));
    imaginary.emplace_back(z.imag(), std::abs(c));
  }
  CommonFactor fit{.z = {WeightedMedian(real), WeightedMedian(imaginary)}};
  std::vector<double> left;
  for (const auto& [c, g] : pairs) left.push_back(std::abs(g - fit.z * c));
  const double limit = 6 * Median(left) + 1e-9;
  Complex product = 0;
  double square = 0;
  for (const auto& [c, g] : pairs) {
    if (std::abs(g - fit.z * c) > limit) continue;
    product += std::conj(c) * g;
    square += std::norm(c);
  }
  if (square > 0) fit.z = product / square;
  double sum = 0;
  std::size_t used = 0;
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    left[k] = std::abs(pairs[k].second - fit.z * pairs[k].first);
    if (left[k] > limit) continue;
    sum += left[k] * left[k];
    ++used;
  }
  if (used > 1 && square > 0) fit.sigma = std::sqrt(sum / static_cast<double>(used - 1) / square);
  fit.median = Median(left);
  return fit;
}

/// The factor that the pairs of (computed, given) have in common, as it is for lengths along a
/// line.
LineFit Line(const std::vector<std::pair<Complex, Complex>>& pairs, double reach) {
  const CommonFactor common = FactorOf(pairs);
  return {.pairs = pairs.size(),
          .reach = reach,
          .factor = common.z.real(),
          .sigma = common.sigma,
          .median = common.median};
}

}  // namespace

std::string_view WordOf(Method method) {
  constexpr std::array<std::string_view, 5> kWords{"minimum curvature", "radius of curvature",
                                                   "balanced tangential", "average angle",
                                                   "tangential"};
  return kWords[static_cast<std::size_t>(method)];
}

Eigen::Vector3d Displacement(Method method, double length, double inclination1, double azimuth1,
                             double inclination2, double azimuth2) {
  const Eigen::Vector3d t1 = Tangent(inclination1, azimuth1), t2 = Tangent(inclination2, azimuth2);
  switch (method) {
    case Method::kRadiusOfCurvature:
      return ByRadius(length, inclination1, azimuth1, inclination2, azimuth2);
    case Method::kBalancedTangential:
      return length / 2 * (t1 + t2);
    case Method::kAverageAngle:
      return length *
             Tangent((inclination1 + inclination2) / 2, azimuth1 + WrapPi(azimuth2 - azimuth1) / 2);
    case Method::kTangential:
      return length * t2;
    case Method::kMinimumCurvature:
      break;
  }
  const auto leg = MinimumCurvatureLeg(length, t1, t2);
  return leg ? leg->displacement : Eigen::Vector3d(length / 2 * (t1 + t2));
}

std::vector<Stretch> StretchesOf(const SurveyTable& table, Method method, std::size_t most) {
  const std::size_t legs = std::max<std::size_t>(table.rows(), 1);
  const std::size_t each = (legs + most - 1) / most;
  std::vector<Stretch> stretches;
  std::optional<std::size_t> last;
  Stretch open;
  std::size_t in_it = 0;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    if (table.status(row) == RowStatus::kUnused) continue;
    if (last) {
      open.moved_W +=
          Displacement(method, table.md(row) - table.md(*last), table.inclination(*last),
                       table.azimuth(*last), table.inclination(row), table.azimuth(row));
      open.end = row;
      if (++in_it == each) {
        stretches.push_back(open);
        open = {.begin = row, .end = row};
        in_it = 0;
      }
    } else {
      open.begin = row;
    }
    last = row;
  }
  if (in_it > 0) stretches.push_back(open);
  return stretches;
}

LineFit FitVertical(const SurveyTable& table, const std::vector<Stretch>& stretches,
                    Column column) {
  std::vector<std::pair<Complex, Complex>> pairs;
  double reach = 0;
  for (const Stretch& s : stretches) {
    const auto a = table.Get(column, s.begin), b = table.Get(column, s.end);
    if (!a || !b) continue;
    pairs.emplace_back(s.moved_W.z(), *b - *a);
    reach += std::abs(s.moved_W.z());
  }
  return Line(pairs, reach);
}

PlaneFit FitPlane(const SurveyTable& table, const std::vector<Stretch>& stretches, Column north,
                  Column east) {
  std::vector<std::pair<Complex, Complex>> pairs;
  PlaneFit fit;
  for (const Stretch& s : stretches) {
    const auto n1 = table.Get(north, s.begin), n2 = table.Get(north, s.end);
    const auto e1 = table.Get(east, s.begin), e2 = table.Get(east, s.end);
    if (!n1 || !n2 || !e1 || !e2) continue;
    pairs.emplace_back(Complex(s.moved_W.x(), s.moved_W.y()), Complex(*n2 - *n1, *e2 - *e1));
    fit.reach += std::hypot(s.moved_W.x(), s.moved_W.y());
  }
  const CommonFactor common = FactorOf(pairs);
  fit.pairs = pairs.size();
  fit.z = common.z;
  fit.sigma = common.sigma;
  fit.median = common.median;
  for (auto& [computed, given] : pairs) computed = std::conj(computed);
  const CommonFactor mirrored = FactorOf(pairs);
  fit.mirrored = mirrored.z;
  fit.mirrored_sigma = mirrored.sigma;
  fit.mirrored_median = mirrored.median;
  return fit;
}

LineFit FitCurvature(const SurveyTable& table) {
  // Severities are listed to 0.01 deg/30 m: rounding (1 sigma) is 1.4 % of it, less of what is
  // more.
  constexpr double kEnough = 0.2 * units::kDegPer30m;
  std::vector<std::pair<Complex, Complex>> pairs;
  double reach = 0;
  // Some thousand legs tell as much as all of them.
  const std::size_t step = table.rows() / 4096 + 1;
  for (std::size_t row = 1; row < table.rows(); row += step) {
    const auto given = table.Get(Column::kDogleg, row);
    const double length = table.md(row) - table.md(row - 1);
    if (!given || !(length > 0) || table.status(row) == RowStatus::kUnused ||
        table.status(row - 1) == RowStatus::kUnused) {
      continue;
    }
    const Eigen::Vector3d a = Tangent(table.inclination(row - 1), table.azimuth(row - 1));
    const Eigen::Vector3d b = Tangent(table.inclination(row), table.azimuth(row));
    const double severity = 2 * std::atan2((b - a).norm(), (b + a).norm()) / length;
    if (severity < kEnough) continue;
    pairs.emplace_back(severity, *given);
    reach += severity * length;
  }
  return Line(pairs, reach);
}

}  // namespace wellgyro::witness
