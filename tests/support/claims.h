#pragma once

#include <cmath>
#include <cstdio>
#include <string>

#include <gtest/gtest.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/math/statistics.h"

#include "support/testing.h"

namespace wellgyro::testing {

/// Errors of many runs against the variances that were claimed for them.
struct Claims {
  double normalised = 0;  ///< sum of squared errors over their variances
  double squares = 0;     ///< of the errors alone
  double variance = 0;    ///< sum of the claims
  int count = 0;          ///< of runs
  int dof = 1;            ///< numbers in an error; one: an angle [rad], three: a place [m]

  void Add(double error, double var) { Add(error * error / var, error * error, var); }
  void Add(double normalised_square, double square, double var) {
    normalised += normalised_square;
    squares += square;
    variance += var;
    ++count;
  }
  void Add(const Claims& others) {
    normalised += others.normalised;
    squares += others.squares;
    variance += others.variance;
    count += others.count;
  }
  double sigma_deg() const { return ToDegrees(std::sqrt(variance / count)); }
  double rms_deg() const { return ToDegrees(std::sqrt(squares / count)); }
  double mean() const { return normalised / (count * dof); }

  /// Inside the chi-square band that holds with 1 - `risk`; sigmas may be `timid` times too large.
  void ExpectTrue(const std::string& what, double risk = 2e-4, double timid = 1) const {
    const double unit = dof == 1 ? ToDegrees(1) : 1;
    std::printf("%-44s rms %.4g, predicted %.4g %s, mean square %.3f of %d\n", what.c_str(),
                unit * std::sqrt(squares / count), unit * std::sqrt(variance / count),
                dof == 1 ? "deg" : "m", mean(), count);
    const double least = ChiSquareQuantile(risk / 2, count * dof) / (timid * timid);
    EXPECT_GT(normalised, least) << what << ": " << mean();
    EXPECT_LT(normalised, ChiSquareQuantile(1 - risk / 2, count * dof)) << what << ": " << mean();
  }
};

}  // namespace wellgyro::testing
