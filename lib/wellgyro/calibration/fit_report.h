#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/calibration/uncertainty_budget.h"
#include "wellgyro/record/tool_calibration.h"

namespace wellgyro {

/// One quantity of a method's result, under the name and in the unit of its file.
struct FitQuantity {
  enum class Shape { kNumber, kVector, kMatrix };
  std::string name;
  Shape shape = Shape::kNumber;
  Eigen::MatrixXd value;  ///< a vector stands in one column
  Eigen::MatrixXd sigma;  ///< 1-sigma; empty where none can be stated
};

/// One reading against the fit.
struct FitResidual {
  int line = 0;  ///< of the data
  std::string channel;
  double value = 0;        ///< measured less fitted, in the data's unit
  double studentised = 0;  ///< over its own sigma; 0 where that is zero
  double leverage = 0;     ///< 1: the fit must pass through it, it cannot be checked
};

/// What a least-squares fit says about itself.
struct FitReport {
  std::string method;
  std::vector<FitQuantity> result;

  std::vector<std::string> parameters;  ///< as bias[0] or sensitivity[2,1], named as in `result`
  Eigen::VectorXd values;
  Eigen::MatrixXd cov;       ///< of `values`; empty where there is no redundancy and no given sigma
  UncertaintyBudget budget;  ///< of `cov`; without sources where the readings are the only one

  int readings = 0;                  ///< used, outliers left out
  int dof = 0;                       ///< readings and priors less estimated parameters
  bool sigma_given = false;          ///< else the scatter itself gave it
  double chi_square = 0;             ///< of the residuals over their given or relative sigmas
  double chi_low = 0, chi_high = 0;  ///< 95 % of chi-square with `dof`
  double scatter = 0;  ///< sqrt(chi_square / dof); where no sigma is given, one in the data's unit
  double half_square_sum = 0;  ///< of the residuals in the data's unit: the cost of other solvers
  double condition = 1;        ///< of the design, columns scaled to unit length
  std::vector<FitResidual> residuals;
  double studentised_limit = 0;    ///< passed by the largest of so many once in a hundred fits
  std::vector<int> outlier_lines;  ///< left out
  std::vector<std::string> correlations;  ///< above 0.95, in words
  std::vector<std::string> remarks;       ///< what a person should know, in sentences
};

/// What a bench method gives: its report and what it says of the tool.
struct BenchCalibration {
  FitReport report;
  SensorGroup gyro, accel, mag;  ///< without channels where the method says nothing of them
  std::optional<ThermometerCalibration> thermometer;
  std::optional<Eigen::Vector3d> axis_B;  ///< of the housing, by the calibrated accelerometers
};

}  // namespace wellgyro
