#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "wellgyro/attitude/filter.h"
#include "wellgyro/earth/earth.h"
#include "wellgyro/math/random.h"
#include "wellgyro/record/knot.h"

/// Knots of a tool with known motion and drawn errors, made without the tracker and without any
/// formula of the filter: rates come from the rotation matrices, errors are drawn step by step.
namespace wellgyro::filter_truth {

struct Pose {
  double inclination = 0, azimuth = 0, toolface = 0, md = 0;
};
using Motion = std::function<Pose(double)>;

struct Plan {
  Motion motion;
  double seconds = 0;
  double knot_seconds = 10;
  int steps_per_knot = 20;
  std::function<bool(double)> still = [](double) { return false; };  // at the middle of a knot
};

struct Truth {
  std::vector<Knot> knots;
  std::vector<Pose> poses;  // at the end of each knot
  Pose start;
};

/// Errors drawn from `setup` by `seed`; seed 0: none.
Truth MakeKnots(const Plan& plan, const FilterSetup& setup, std::uint64_t seed);

/// What a gyrocompass would make of the still knots in [begin, end): least squares on their mean
/// rates, their errors left as they are; `near` picks the branch.
NorthFix FixOf(const std::vector<Knot>& knots, std::size_t begin, std::size_t end,
               const FilterSetup& setup, double near);

/// Gives the azimuth `azimuth` + sigma x normal at knot `at`, from outside.
NorthFix ExternalFix(const Knot& at, double azimuth, double sigma);

FilterSetup SetupAt(double latitude);

}  // namespace wellgyro::filter_truth
