#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/fit/tool_model_internal.h"

namespace wellgyro {

/// A row about x: its residual, and by what it changes.
struct RowAbout {
  const ToolRow* row = nullptr;
  Eigen::VectorXd e;
  Eigen::MatrixXd J, wobble;
  double weight = 1;  ///< of its squares
};

/// Finds the sigmas of a tool's readings: of three kinds of readings, of the wobble of attitudes
/// and of that on the rate table. Those that the setup states are held.
class NoiseFinder {
 public:
  NoiseFinder(const ToolReadings& readings, const ToolFitSetup& setup, const ToolModel& model)
      : readings_(readings), setup_(setup), model_(model) {}

  /// By the medians of residuals about x, of all rows.
  ToolNoise Start(const Eigen::VectorXd& x);

  /// The sigmas under which the rows are likeliest, what each kind of readings loses to the
  /// parameters allowed for (restricted likelihood), in a model linear about x.
  void Find(const std::vector<RowAbout>& rows, const Eigen::VectorXd& x, int sweeps,
            ToolNoise& noise) const;

  /// The same of rows with the tails that Cauchy's loss stands for: a row of n channels, residual
  /// d of unit covariance, counts by 5n / (4n + d^2), the weight of Student's t with 4n degrees of
  /// freedom. No row moves a sigma by more than five sound ones. Gives the step from x to the
  /// coefficients that suit these sigmas.
  Eigen::VectorXd FindRobustly(std::vector<RowAbout> rows, const Eigen::VectorXd& x,
                               ToolNoise& noise) const;

  /// On the variances of the two wobbles: tr(V P V P) / 2, row by row.
  std::array<double, 2> WobbleInformation(const std::vector<RowAbout>& rows,
                                          const Eigen::VectorXd& x, const ToolNoise& noise) const;

 private:
  static constexpr std::size_t kComponents = 5;  ///< members of ToolNoise

  struct Found {
    std::array<double, kComponents> ratios{};
    std::array<double, 2> wobble_information{};
    Eigen::VectorXd step;
  };
  Found SquaresOverExpected(const std::vector<RowAbout>& rows, const Eigen::VectorXd& x,
                            const ToolNoise& noise) const;
  void Scale(const Found& found, ToolNoise& noise) const;
  std::array<bool, kComponents> Held() const;
  std::size_t KindOf(const ToolRow& row, Eigen::Index place) const;

  const ToolReadings& readings_;
  const ToolFitSetup& setup_;
  const ToolModel& model_;
  std::array<double, kComponents> floor_{1e-300, 1e-300, 1e-300, 1e-8, 1e-8};
};

}  // namespace wellgyro
