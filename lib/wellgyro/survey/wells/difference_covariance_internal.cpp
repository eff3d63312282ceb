#include "wellgyro/survey/wells/difference_covariance_internal.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <utility>

#include "wellgyro/math/rotation.h"
#include "wellgyro/survey/hole/common_courses_internal.h"
#include "wellgyro/survey/hole/listing_errors_internal.h"

namespace wellgyro {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

// Places whose covariance is joint: 600 angles, a matrix of 2.9 MB.
constexpr std::size_t kJointMax = 300;

/// Unit vectors across the hole.
struct Across {
  Vector3d high, right;
  Vector2d Of(const Vector3d& v) const { return {high.dot(v), right.dot(v)}; }
};

/// In a vertical hole high side points north.
Across AcrossOf(const Vector3d& tangent) {
  const double level = std::hypot(tangent.x(), tangent.y());
  const bool vertical = level < 1e-12;
  const double c = vertical ? 1 : tangent.x() / level, s = vertical ? 0 : tangent.y() / level;
  return {{tangent.z() * c, tangent.z() * s, -level}, {-s, c, 0}};
}

/// What makes two errors one: term, reach, group; and for what reaches no further than a tool's
/// run its model.
using SourceKey = std::tuple<std::string, Propagation, std::string, std::int64_t>;

/// One source and group of one survey.
struct GroupErrors {
  std::span<const StationError> errors;
  bool taken = false;
};

std::map<SourceKey, GroupErrors> FactorsOf(const SurveyErrors& errors, int survey, bool same_run) {
  std::map<SourceKey, GroupErrors> factors;
  const std::span<const StationError> all(errors.errors);
  for (std::size_t begin = 0, end = 0; begin < all.size(); begin = end) {
    const auto same = [&](const StationError& e) {
      return e.source == all[begin].source && e.group == all[begin].group;
    };
    while (end < all.size() && same(all[end])) ++end;
    const NamedSource& source = errors.sources[all[begin].source];
    const bool reaches =
        source.propagation == Propagation::kWell || source.propagation == Propagation::kGlobal;
    const bool systematic = source.propagation == Propagation::kSystematic;
    // Errors of one survey alone have its number in the place of the model.
    const std::string whose =
        reaches                  ? std::string()
        : systematic && same_run ? source.model + "/" + std::to_string(source.run)
                                 : std::to_string(survey) + "/" + std::to_string(all[begin].source);
    factors[{source.term, source.propagation, whose, all[begin].group}] = {
        all.subspan(begin, end - begin)};
  }
  return factors;
}

/// Variance of a station's own direction, per component across: half of a difference's local
/// variance, and the random terms of the model [rad^2].
std::vector<double> NoiseOf(const ComparedSurvey& survey, const CompareOptions& options) {
  const std::size_t n = survey.well.survey.size();
  std::vector<double> noise(n, options.local_sigma * options.local_sigma / 2);
  if (!survey.errors) return noise;
  for (const StationError& e : survey.errors->errors) {
    if (survey.errors->sources[e.source].propagation != Propagation::kRandom) continue;
    noise[e.station] += e.direction_W.squaredNorm() / 2;
  }
  return noise;
}

class Accumulator {
 public:
  Accumulator(const ComparedSurvey& first, const ComparedSurvey& second, double begin, double end,
              std::span<const double> depths, const CompareOptions& options);
  DifferenceCovariance Result() &&;

 private:
  void AddModelled();
  void AddOffSplines(int survey);
  void AddLocal();
  std::vector<double> LocalAtStations() const;
  void Add(const ListedErrors& listed, std::span<const Vector3d> position, double sign);
  void Close();
  void Own(const ComparedSurvey& survey, std::span<const ListedPlace> places);

  const ComparedSurvey* surveys_[2];
  const CompareOptions& options_;
  std::span<const double> depths_;
  std::vector<ListedPlace> places_[2];
  std::vector<double> common_;  ///< depths of the stations that places are summed over
  std::vector<CommonCourses> courses_;
  std::vector<Across> across_;
  std::vector<Eigen::Index> joint_row_;  ///< of each depth, or -1
  DifferenceCovariance result_;
  std::vector<Vector2d> variance_;
  // Effects of the error source at hand, over the rows [begin_, end_).
  std::vector<Vector2d> direction_;
  std::vector<Vector3d> position_;
  std::size_t begin_ = 0, end_ = 0;
};

Accumulator::Accumulator(const ComparedSurvey& first, const ComparedSurvey& second, double begin,
                         double end, std::span<const double> depths, const CompareOptions& options)
    : surveys_{&first, &second},
      options_(options),
      depths_(depths),
      places_{PlacesIn(first.well, depths), PlacesIn(second.well, depths)},
      common_(CommonStations(first.well, second.well, begin, end)),
      courses_{{first.well, common_, depths}, {second.well, common_, depths}} {
  const RoughListing listings[] = {{&first.well, NoiseOf(first, options)},
                                   {&second.well, NoiseOf(second, options)}};
  result_.roughness = RoughnessOf(listings, begin, end);
  const std::size_t rows = depths.size();
  for (std::size_t row = 0; row < rows; ++row) {
    const Vector3d &a = places_[0][row].smooth_W, &b = places_[1][row].smooth_W;
    const Across across = AcrossOf((a + b).normalized());
    across_.push_back(across);
    result_.difference.push_back(across.Of(b - a));
    result_.bend.push_back(across.Of(places_[0][row].bend_W + places_[1][row].bend_W) / 2);
    result_.summed_alike_W.push_back(courses_[1].Position(row) - courses_[0].Position(row));
  }
  const double local = options.local_sigma * options.local_sigma;
  variance_.assign(rows, Vector2d::Constant(local));
  direction_.assign(rows, Vector2d::Zero());
  position_.assign(rows, Vector3d::Zero());
  result_.cov_p_W.assign(rows, first.cov_tie_in_W + second.cov_tie_in_W);
  joint_row_.assign(rows, -1);
  if (!first.errors || !second.errors) return;
  const std::size_t joint = std::min(rows, kJointMax);
  for (std::size_t j = 0; j < joint; ++j) {
    const std::size_t row = joint > 1 ? j * (rows - 1) / (joint - 1) : 0;
    joint_row_[row] = static_cast<Eigen::Index>(j);
    result_.joint.push_back(row);
  }
  const auto n = static_cast<Eigen::Index>(joint);
  result_.cov_direction = local * Eigen::MatrixXd::Identity(2 * n, 2 * n);
}

void Accumulator::Add(const ListedErrors& listed, std::span<const Vector3d> position, double sign) {
  begin_ = std::min(begin_, listed.first);
  end_ = std::max(end_, listed.last);
  for (std::size_t row = listed.first; row < listed.last; ++row) {
    direction_[row] += sign * across_[row].Of(listed.direction_W[row]);
  }
  for (std::size_t row = 0; row < position.size(); ++row) position_[row] += sign * position[row];
}

/// Adds the outer product of the source's effects to the covariances, and clears them.
void Accumulator::Close() {
  const auto n = static_cast<Eigen::Index>(result_.joint.size());
  for (std::size_t row = begin_; row < end_; ++row) {
    variance_[row] += direction_[row].cwiseAbs2();
    const Eigen::Index i = joint_row_[row];
    if (i < 0) continue;
    for (std::size_t with = begin_; with < end_; ++with) {
      const Eigen::Index j = joint_row_[with];
      if (j < 0) continue;
      const Vector2d &a = direction_[row], &b = direction_[with];
      result_.cov_direction(i, j) += a.x() * b.x();
      result_.cov_direction(i, n + j) += a.x() * b.y();
      result_.cov_direction(n + i, j) += a.y() * b.x();
      result_.cov_direction(n + i, n + j) += a.y() * b.y();
    }
  }
  for (std::size_t row = 0; row < depths_.size(); ++row) {
    result_.cov_p_W[row] += position_[row] * position_[row].transpose();
    direction_[row].setZero();
    position_[row].setZero();
  }
}

/// Adds the interpolation error: how far the hole is from a survey's spline between its stations.
void Accumulator::AddOffSplines(int survey) {
  const auto& stations = surveys_[survey]->well.survey;
  const auto& places = places_[survey];
  const auto n = static_cast<Eigen::Index>(result_.joint.size());
  for (std::size_t row = 0; row < places.size(); ++row) {
    const ListedPlace& p = places[row];
    const double length = stations[p.below].md - stations[p.below - 1].md;
    variance_[row].array() += result_.roughness.OffSpline(length, p.fraction, p.fraction);
    const Eigen::Index i = joint_row_[row];
    if (i < 0) continue;
    for (std::size_t with = row; with < places.size() && places[with].below == p.below; ++with) {
      const Eigen::Index j = joint_row_[with];
      if (j < 0) continue;
      const double cov = result_.roughness.OffSpline(length, p.fraction, places[with].fraction);
      for (const Eigen::Index part : {Eigen::Index{0}, n}) {
        result_.cov_direction(part + i, part + j) += cov;
        if (i != j) result_.cov_direction(part + j, part + i) += cov;
      }
    }
  }
}

/// Variance of the differences' local errors at the common stations, per component across: what is
/// beyond the models (none at the first station), and the interpolation errors of either survey.
std::vector<double> Accumulator::LocalAtStations() const {
  std::vector<double> variance(common_.size(), options_.local_sigma * options_.local_sigma);
  variance.front() = 0;
  for (const ComparedSurvey* survey : surveys_) {
    const std::vector<ListedPlace> places = PlacesIn(survey->well, common_);
    for (std::size_t k = 0; k < places.size(); ++k) {
      const auto below = survey->well.survey.begin() + static_cast<std::ptrdiff_t>(places[k].below);
      const double length = below->md - std::prev(below)->md, f = places[k].fraction;
      variance[k] += result_.roughness.OffSpline(length, f, f);
    }
  }
  return variance;
}

/// Adds the local errors to the covariances of places: independent from common station to station,
/// linear between them.
void Accumulator::AddLocal() {
  const std::vector<double> local = LocalAtStations();
  const std::size_t first = courses_[0].first_common();
  const auto tangent = [&](std::size_t k) -> Vector3d {
    Vector3d sum = Vector3d::Zero();
    for (const CommonCourses& c : courses_) {
      const SurveyPoint& p = c.well().survey[c.first_common() + k];
      sum += Tangent(p.inclination, p.azimuth);
    }
    return sum.normalized();
  };
  const auto across = [&](std::size_t k, double length) -> Matrix3d {
    const Vector3d t = tangent(k);
    return local[k] * length * length * (Matrix3d::Identity() - t * t.transpose());
  };
  const auto course = [&](std::size_t k) { return k > 0 ? common_[k] - common_[k - 1] : 0; };
  Matrix3d sum = Matrix3d::Zero();  // of stations above the one that opens the leg
  std::size_t opens = 0;
  for (std::size_t row = 0; row < depths_.size(); ++row) {
    const ListedPlace& p = courses_[0].places()[row];
    const std::size_t below = p.below - first;
    for (; opens + 1 < below; ++opens) {
      sum += across(opens, (course(opens) + course(opens + 1)) / 2);
    }
    const double f = p.fraction, length = course(below);
    result_.cov_p_W[row] += sum + across(opens, course(opens) / 2 + length * f * (1 - f / 2)) +
                            across(below, length * f * f / 2);
  }
}

void Accumulator::AddModelled() {
  std::map<SourceKey, GroupErrors> factors[2];
  for (int i = 0; i < 2; ++i) {
    if (surveys_[i]->errors) {
      factors[i] = FactorsOf(*surveys_[i]->errors, i, options_.same_run);
    }
  }
  std::optional<ListingErrors> listings[2], at_stations[2];
  for (int i = 0; i < 2; ++i) {
    if (!surveys_[i]->errors) continue;
    listings[i].emplace(surveys_[i]->well, *surveys_[i]->errors, depths_);
    at_stations[i].emplace(surveys_[i]->well, *surveys_[i]->errors, courses_[i].stations());
  }
  ListedErrors listed, summed;
  const auto add = [&](int i, const GroupErrors& factor) {
    listings[i]->Carry(factor.errors, listed);
    at_stations[i]->Carry(factor.errors, summed);
    Add(listed, courses_[i].Displaced(summed), i == 0 ? -1 : 1);
  };
  for (int i = 0; i < 2; ++i) {
    for (const auto& [key, factor] : factors[i]) {
      if (factor.taken) continue;
      begin_ = depths_.size(), end_ = 0;
      add(i, factor);
      const auto other = i == 0 ? factors[1].find(key) : factors[1].end();
      if (other != factors[1].end()) add(1, other->second), other->second.taken = true;
      Close();
    }
  }
}

/// Adds the sigmas that a survey states itself, linear between its stations.
void Accumulator::Own(const ComparedSurvey& survey, std::span<const ListedPlace> places) {
  for (std::size_t row = 0; row < depths_.size(); ++row) {
    const ListedPlace& p = places[row];
    const StationSigmas &a = survey.own[p.below - 1], &b = survey.own[p.below];
    const double f = p.fraction;
    const double level = std::hypot(p.tangent_W.x(), p.tangent_W.y());
    const double inclination = (1 - f) * a.inclination + f * b.inclination;
    const double azimuth = (1 - f) * a.azimuth + f * b.azimuth;
    variance_[row] += Vector2d(inclination, level * azimuth).cwiseAbs2();
    result_.cov_p_W[row] += (1 - f) * a.cov_p_W + f * b.cov_p_W;
  }
}

DifferenceCovariance Accumulator::Result() && {
  AddLocal();
  AddModelled();
  for (int i = 0; i < 2; ++i) {
    AddOffSplines(i);
    if (!surveys_[i]->errors) Own(*surveys_[i], places_[i]);
  }
  for (const Vector2d& v : variance_) result_.sigma.push_back(v.cwiseSqrt());
  return std::move(result_);
}

}  // namespace

DifferenceCovariance CovarianceOfDifference(const ComparedSurvey& first,
                                            const ComparedSurvey& second, double begin, double end,
                                            std::span<const double> depths,
                                            const CompareOptions& options) {
  return Accumulator(first, second, begin, end, depths, options).Result();
}

}  // namespace wellgyro
