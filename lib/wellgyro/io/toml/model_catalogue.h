#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"
#include "wellgyro/io/text_file.h"
#include "wellgyro/uncertainty/error_model.h"

namespace wellgyro {

/// The models that come with the library (data/models), in order of name.
WELLGYRO_EXPORT const std::vector<ErrorModel>& OwnModels();

/// `model` as it is on a floating rig: by OWSG's rule, the depth reference is uncertain by 2.2 m at
/// every station and by 1.0 m in a run, in place of what it was on a fixed one. Its name gains
/// "_Fl".
WELLGYRO_EXPORT ErrorModel OnFloatingRig(const ErrorModel& model);

/// One of OwnModels by name, or with "_Fl" its variant for a floating rig.
WELLGYRO_EXPORT std::optional<ErrorModel> OwnModel(const std::string& name);

/// An error model by name, as "GYRO-NS-CT", with "_Fl" for a floating rig, where `name` is that of
/// one of OwnModels; else the file of that path: .toml (error_model_file.h), .json, .yaml, .ipm and
/// .xml, an EDM export whose tool follows a '#' (model_files.h). `input`, unless null, receives
/// what was read. A Fault names file and term, or the names that are like `name`.
WELLGYRO_EXPORT Result<ErrorModel> FindModel(const std::string& name, InputFile* input = nullptr);

/// The same of bytes that were read already; `path` says what they are.
WELLGYRO_EXPORT Result<ErrorModel> ParseModel(std::string_view text, const std::string& path);

}  // namespace wellgyro
