#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"
#include "wellgyro/uncertainty/error_model.h"

namespace wellgyro {

/// An error model from TOML, `wellgyro.error-model/1`; data/models/README.md describes its keys.
///
/// A Fault names file, line and, where one is to blame, the term: an unknown weighting function, a
/// missing parameter, a magnitude without its unit or with one that does not fit, a key that does
/// not belong. A model that comes back can be used as it is.
WELLGYRO_EXPORT Result<ErrorModel> ReadErrorModel(std::string_view text, const std::string& source);

/// The same from the file at `path`.
WELLGYRO_EXPORT Result<ErrorModel> ReadErrorModelFile(const std::filesystem::path& path);

/// The same as text, read back with magnitudes to the last bit but one, and `remarks` as comments
/// before the terms of their numbers. A Fault names a term whose weighting function is the model's
/// own formula, for which the format has no word.
WELLGYRO_EXPORT Result<std::string> WriteErrorModel(const ErrorModel& model,
                                                    std::span<const std::string> remarks = {});

}  // namespace wellgyro
