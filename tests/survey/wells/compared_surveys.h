#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "wellgyro/base/angle.h"
#include "wellgyro/base/units.h"
#include "wellgyro/math/random.h"
#include "wellgyro/math/rotation.h"
#include "wellgyro/survey/wells/compare.h"
#include "wellgyro/trajectory/trajectory.h"

/// Surveys of one hole with errors drawn from their models.
namespace wellgyro::test {

inline constexpr double kComparedEnd = 1800;  // [m]

/// Arcs of 180 m, a whole number of which is between any stations of these tests, so that nothing
/// is lost between stations.
inline Trajectory TheHole() {
  std::vector<double> md, inclination, azimuth;
  for (int k = 0; k <= 10; ++k) {
    md.push_back(180.0 * k);
    inclination.push_back((30 + 20 * std::sin(md.back() / 500)) * units::kDeg);
    azimuth.push_back((40 + 30 * std::sin(md.back() / 600 + 1)) * units::kDeg);
  }
  return Trajectory(md, inclination, azimuth, Eigen::Vector3d::Zero());
}

/// A hole by metres, from how fast its direction turns to the high side and to the right [rad/m].
template <typename Bend>
Trajectory Drilled(Bend bend) {
  std::vector<double> md = {0}, inclination = {45 * units::kDeg}, azimuth = {40 * units::kDeg};
  while (md.back() < kComparedEnd + 10) {
    const auto [high, right] = bend(md.back(), inclination.back());
    const double i = inclination.back() + high;
    azimuth.push_back(azimuth.back() + right / std::sin(i));
    inclination.push_back(i);
    md.push_back(md.back() + 1);
  }
  return Trajectory(md, inclination, azimuth, Eigen::Vector3d::Zero());
}

/// An S and a turn, by no arc at all.
inline Trajectory Smooth() {
  return Drilled([](double md, double inclination) {
    return std::pair(20 * units::kDeg / 300 * std::cos(md / 300),
                     30 * units::kDeg / 350 * std::cos(md / 350 + 1) * std::sin(inclination));
  });
}

/// Curvature walks at random, held to 1.5 deg/30 m over 100 m, and the inclination about 45 deg.
inline Trajectory Wandering(Random& random) {
  double high = 0, right = 0;
  const double step = 1.5 * units::kDeg / 30 * std::sqrt(2 / 100.0);
  return Drilled([=, &random](double, double inclination) mutable {
    high += -high / 100 + step * random.Normal() - (inclination - 45 * units::kDeg) / 2e4;
    right += -right / 100 + step * random.Normal();
    return std::pair(high, right);
  });
}

/// A motor slides for 9 m somewhere in every 30 m, with 6 deg/30 m in any direction.
inline Trajectory Slid(Random& random) {
  double toolface = 0, begin = 0;
  return Drilled([=, &random](double md, double inclination) mutable {
    const double in_stand = std::fmod(md, 30);
    if (in_stand == 0) {
      begin = 21 * random.Uniform();
      toolface = 2 * kPi * random.Uniform();
      const bool out = std::cos(toolface) * (inclination - 45 * units::kDeg) > 0;
      if (std::abs(inclination - 45 * units::kDeg) > 20 * units::kDeg && out) toolface += kPi;
    }
    const double bend = in_stand >= begin && in_stand < begin + 9 ? 6 * units::kDeg / 30 : 0;
    return std::pair(bend * std::cos(toolface), bend * std::sin(toolface));
  });
}

inline std::vector<SurveyPoint> StationsIn(const Trajectory& hole, double spacing,
                                           double offset = 0) {
  std::vector<SurveyPoint> stations;
  for (double md = 0; md <= kComparedEnd; md += md == 0 && offset > 0 ? offset : spacing) {
    const TrajectoryPoint p = hole.AtMd(md);
    stations.push_back({md, p.inclination, p.azimuth, 0});
  }
  return stations;
}

inline std::vector<SurveyPoint> StationsEvery(double spacing) {
  static const Trajectory hole = TheHole();
  return StationsIn(hole, spacing);
}

inline Surroundings Somewhere() {
  Surroundings place;
  place.latitude = 60 * units::kDeg;
  place.field = 5e-5;
  place.dip = 70 * units::kDeg;
  place.declination = 0;
  return place;
}

/// A tool so good, times `scale`, that shifts of 0.3 m and 0.2 deg are seen sometimes.
inline ErrorModel GoodTool(double scale = 1) {
  ErrorModel model;
  model.name = "good";
  const auto add = [&](const char* name, const char* weight, double magnitude, Propagation reach) {
    model.terms.push_back({name, FindWeight(weight), scale * magnitude, reach});
  };
  add("AZ", "AZ", 0.05 * units::kDeg, Propagation::kSystematic);
  add("AZG", "AZ", 0.3 * units::kDeg, Propagation::kGlobal);
  add("XYM1", "XYM1", 0.03 * units::kDeg, Propagation::kSystematic);
  add("XYM2", "XYM2", 0.03 * units::kDeg, Propagation::kSystematic);
  add("DREF", "DREF", 0.1, Propagation::kSystematic);
  add("DSF", "DSF", 1e-4, Propagation::kSystematic);
  add("DRFR", "DREF", 0.02, Propagation::kRandom);
  add("AZR", "AZ", 0.03 * units::kDeg, Propagation::kRandom);
  model.max_inclination = kPi;
  model.vertical_limit = 1e-6;
  return model;
}

/// Draws of sources by name of term: those that reach beyond a run are drawn once for both.
using Draws = std::map<std::pair<std::string, std::int64_t>, double>;

/// A survey of a hole with errors drawn from the models of its legs.
inline ComparedSurvey Surveyed(std::vector<SurveyPoint> stations, const ErrorModel& model,
                               double local_sigma, Random& random, Draws& shared) {
  const ToolLeg leg{&model, 0, stations.size(), 1};
  const SurveyErrors errors = ErrorsAtStations(stations, Somewhere(), {&leg, 1});
  std::vector<Eigen::Vector3d> direction;
  for (const SurveyPoint& p : stations) direction.push_back(Tangent(p.inclination, p.azimuth));
  std::map<std::pair<std::size_t, std::int64_t>, double> own;
  for (const StationError& e : errors.errors) {
    const NamedSource& source = errors.sources[e.source];
    const bool is_shared = source.propagation == Propagation::kGlobal;
    double u = 0;
    if (is_shared) {
      const auto [at, is_new] = shared.try_emplace({source.term, e.group}, 0);
      if (is_new) at->second = random.Normal();
      u = at->second;
    } else {
      const auto [at, is_new] = own.try_emplace({e.source, e.group}, 0);
      if (is_new) at->second = random.Normal();
      u = at->second;
    }
    direction[e.station] += u * e.direction_W;
    stations[e.station].md += u * e.md;
  }
  for (std::size_t k = 1; k < stations.size(); ++k) {
    const Eigen::Vector3d local{random.Normal(), random.Normal(), random.Normal()};
    const Eigen::Vector3d t = (direction[k] + local_sigma * local).normalized();
    stations[k].inclination = std::acos(t.z());
    stations[k].azimuth = WrapTwoPi(std::atan2(t.y(), t.x()));
  }
  stations[0].md = 0;
  ComparedSurvey survey;
  survey.well = SurveyWell(stations, Eigen::Vector3d::Zero());
  const ToolLeg again{&model, 0, stations.size(), 1};
  survey.errors = ErrorsAtStations(survey.well.survey, Somewhere(), {&again, 1});
  return survey;
}

struct ComparedPair {
  ComparedSurvey first, second;
};

/// The first at wider stations, so that these are compared, and carrying all that is local.
inline ComparedPair Drawn(const ErrorModel& a, const ErrorModel& b, double local_sigma,
                          Random& random, double finer = 20) {
  Draws shared;
  ComparedPair pair{Surveyed(StationsEvery(60), a, local_sigma, random, shared),
                    Surveyed(StationsEvery(finer), b, 0, random, shared)};
  return pair;
}

inline const Check& CheckOf(const Comparison& c, const std::string& code) {
  return *std::ranges::find(c.checks, code, &Check::code);
}

}  // namespace wellgyro::test
