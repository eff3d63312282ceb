#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"
#include "wellgyro/survey/wells/separation.h"

namespace wellgyro {

/// A well as a clearance file names it; files are relative to that file.
struct ClearanceWell {
  std::string name;
  std::string survey;                      ///< empty: `program`
  std::string model;                       ///< of the survey; empty: the one of the command line
  std::string program;                     ///< `wellgyro.program/1`
  std::optional<Eigen::Vector3d> start_W;  ///< north, east, TVD of its first station [m]
  /// Where the reference and this one part, the one a side-track of the other [m MD].
  std::optional<double> kick_off;
  /// Above it rows are listed but not judged: below a kick-off both begin as one hole [m MD].
  std::optional<double> judged_from;
  std::vector<HoleSection> hole;  ///< empty: the policy's
};

/// What two wells may not come nearer than, and which wells.
struct ClearancePolicy {
  SeparationRule rule;
  TieOn tie_on = TieOn::kModel;
  double stop = 1;     ///< separation factors below it fail
  double alert = 1.5;  ///< below it they warn
  double report = 5;   ///< wells that cannot come below it are screened out
  std::vector<HoleSection> reference_hole, offset_hole;
  std::optional<ClearanceWell> reference;
  std::vector<ClearanceWell> offsets;
};

/// A clearance policy, `wellgyro.clearance/1`:
/// `[rule]` `k`, `sigma_pa_m`, `surface_margin_m`, `correlation` (none, global, full), `surface`
/// (pedal, ellipsoid), `scan` (nearest, horizontal, travelling-cylinder), `tie_on` (model, half,
/// whole); `[limits]` `stop`, `alert`, `report`; `[hole]` `reference_radius_m`, `offset_radius_m`,
/// each a number or rows of [to MD in m, radius in m]; `[reference]` and `[[offset]]` with `name`,
/// `survey` and `model`, or `program`; `north_m`, `east_m`, `tvd_m`, `kick_off_md_m`,
/// `judged_from_md_m`, `hole_radius_m`. All but the format line may be left out. Faults name file
/// and line.
WELLGYRO_EXPORT Result<ClearancePolicy> ReadClearancePolicy(const std::filesystem::path& path);

}  // namespace wellgyro
