#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"
#include "wellgyro/earth/grid.h"
#include "wellgyro/io/text_file.h"
#include "wellgyro/survey/wells/merge.h"

namespace wellgyro {

/// What the legs that a merge is made of say of each other where they overlap.
enum class OnDisagreement { kNote, kFail };

/// What a merge file asks for, with the files that it names read.
struct MergePlan {
  std::vector<MergeLeg> legs;
  std::vector<std::string> model_names;  ///< of each leg, as another file may name it
  std::vector<std::shared_ptr<const ErrorModel>> models;  ///< that the legs point to
  MergePolicy policy;
  OnDisagreement disagreement = OnDisagreement::kFail;
  Eigen::Vector3d start_W = Eigen::Vector3d::Zero();  ///< north, east, TVD of the first [m]
  Eigen::Matrix3d cov_tie_in_W = Eigen::Matrix3d::Zero();
  std::string name;  ///< of the hole
  std::vector<InputFile> inputs;
  std::vector<std::string> notes;
};

/// A merge, `wellgyro.merge/1`: `name`; `[policy]` `choose` (smallest, order), `measure`
/// (horizontal, vertical, volume), `at_md_m`, `min_gain`, `max_gap_m`, `on_disagreement` (fail,
/// note); `[tie_in]` as a program's; `[parent]` `program` and `kick_off_md_m`, the hole that this
/// one leaves; `[[leg]]` with `survey`, `model`, `name`, `run`, `from_md_m`, `to_md_m`, and
/// `left_out`, a reason not to take it. Files are named relative to `path`; azimuths from `wanted`.
/// Faults name file and line.
WELLGYRO_EXPORT Result<MergePlan> ReadMergePlan(const std::filesystem::path& path, North wanted);
/// The same of text, which `source` names in Faults; files are relative to `folder`.
WELLGYRO_EXPORT Result<MergePlan> ParseMergePlan(std::string_view text, const std::string& source,
                                                 const std::filesystem::path& folder, North wanted);

}  // namespace wellgyro
