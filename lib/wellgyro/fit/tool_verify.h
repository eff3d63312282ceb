#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"
#include "wellgyro/calibration/bench_table.h"
#include "wellgyro/fit/tool_fit.h"
#include "wellgyro/record/tool_calibration.h"

namespace wellgyro {

struct VerifySetup {
  ToolFitSetup bench;         ///< sigmas of the readings are needed
  double false_alarm = 0.01;  ///< that any quantity of a sound tool is called shifted
  /// What a tool may be off and stay in service, 1-sigma of what it is used with; 0: no limit.
  double budget_gyro_bias = 0;   ///< [deg/h]
  double budget_gyro_force = 0;  ///< mass unbalance and quadrature [deg/h per g]
  double budget_accel_bias = 0;  ///< [of local gravity]
};

/// By how much one quantity of the tool is not what its calibration says.
struct ToolShift {
  std::string name;  ///< gyro_b[0], gyro_G[1,0], accel_b[2]
  std::string unit;
  double value = 0, sigma = 0;  ///< sigma: of the readings, the bench and the calibration together
  double limit = 0;             ///< three times the budget; 0: none
  bool shifted = false;         ///< beyond what chance reaches
  bool within = true;           ///< of the budget
  /// The positions tell it to its budget, sigma no larger than one of these. Without a budget, to
  /// what matters to a survey: 2 % of the Earth's rate (per g), 2e-3 of gravity, a tenth of a
  /// degree of inclination. What they do not tell from other shifts has an infinite sigma.
  bool told = true;
};

/// A tool is not known to be sound because nothing shows where it was not looked at.
enum class VerifyOutcome { kPass, kNotVerified, kFail };

struct Verification {
  std::vector<ToolShift> shifts;
  double reach = 0;  ///< sigmas that chance reaches, by the false alarm rate
  double chi_square = 0;
  int dof = 0;             ///< of the residuals without any shift
  double probability = 1;  ///< that a sound tool's are as large
  double left = 0;         ///< chi-square beside the shifts
  int left_dof = 0;
  /// False: what is beside the shifts is larger than chance has it in one of 1000 tools. Something
  /// else than a bias or a force term is wrong, of the tool, the bench or what was stated of them.
  bool fits = true;
  /// The residuals ask for shifts, and the positions do not tell for which.
  bool unassigned = false;
  /// kPass: fits, and everything is told and within its budget, without budgets not shifted.
  /// kNotVerified: so is all that is told. kFail: anything else.
  VerifyOutcome outcome = VerifyOutcome::kPass;
  /// Lowest and highest temperature of the readings where the calibration was made for neither,
  /// which it then takes for its nearest [degC].
  std::optional<std::pair<double, double>> beyond;
};

/// A tool against its calibration, as found or as left: a table of positions (columns as FitTool's)
/// read at rest. Biases and force terms are estimated as shifts from the tool model, by generalised
/// least squares: in the covariance are the readings' noise and wobble, level, north and zero of
/// inclination of the bench, and the calibration's own whole covariance. All shifts are listed;
/// those that these positions cannot tell are not told. Throws std::invalid_argument without the
/// sigmas.
WELLGYRO_EXPORT Result<Verification> VerifyTool(const BenchTable& data, const ToolCalibration& tool,
                                                const VerifySetup& setup);

}  // namespace wellgyro
