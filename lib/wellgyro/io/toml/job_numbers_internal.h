#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "wellgyro/io/toml/toml_internal.h"
#include "wellgyro/survey/job.h"
#include "wellgyro/survey/job_keys.h"

/// Numbers and choices of a job as survey/job_keys.h says that they are.
namespace wellgyro {

/// The number under `key` of `section`, in SI, into its place in `job`; as it was where absent.
void ReadNumber(TomlTable& table, std::string_view section, std::string_view key, Job& job);

/// The same, and it must be there.
void NeedNumber(TomlTable& table, std::string_view section, std::string_view key, Job& job);

/// All numbers of `section`.
void ReadNumbers(TomlTable& table, std::string_view section, Job& job);

/// Which of the words of `key` stands there: its place among the enumerators, or false or true.
template <class T>
std::optional<T> FindChoice(TomlTable& table, std::string_view section, std::string_view key) {
  const auto place = table.FindPlace(key, JobKeyOf(section, key).words);
  if (!place) return std::nullopt;
  return static_cast<T>(*place);
}

/// A whole number.
std::optional<std::int64_t> FindWhole(TomlTable& table, std::string_view section,
                                      std::string_view key);

/// A number that has no one place in a job, in SI.
std::optional<double> FindListed(TomlTable& table, std::string_view section, std::string_view key);

}  // namespace wellgyro
