#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "wellgyro/base/export.h"
#include "wellgyro/base/number_range.h"
#include "wellgyro/survey/job.h"

/// Every key of a job file, `wellgyro.job/1`: the one place that says what it may be, in which unit
/// it stands there, what holds where it is absent, and what it means. Reading a file, the check of
/// a Job made in a program, and the reference in lib/docs all rest on it.
namespace wellgyro {

struct JobKey {
  std::string_view table;  ///< "depth.cable"; of lists of tables "run", "event"
  std::string_view key;    ///< with its unit: "weight_n_per_m"
  std::string_view type;   ///< "number", "whole number", "text", "true or false"; empty: a choice
  /// What holds without it; empty: the number of a Job{}, of [errors] and [noise] what is unstated.
  std::string_view absent;
  std::string_view meaning;  ///< one sentence or less
  /// Of a number, or of each in a list, in the key's unit; of a text's length [bytes].
  NumberRange range = {};
  double unit = 1;  ///< one of the key's unit in SI
  /// Where the number stands in a Job; null where it is absent. Null for what is no single number.
  const double* (*find)(const Job&) = nullptr;
  double* (*make)(Job&) = nullptr;           ///< the same, made first where it is absent
  NumberRange second = {};                   ///< of the second number of each row of a list of two
  std::string Channels::*channel = nullptr;  ///< the name that it gives, of [channels]
  std::span<const std::string_view> words = {};  ///< of a choice, see job_words.h
};

/// In the order of the reference.
WELLGYRO_EXPORT std::span<const JobKey> JobKeys();

/// The key of that name. Throws std::logic_error when there is none.
WELLGYRO_EXPORT const JobKey& JobKeyOf(std::string_view table, std::string_view key);

/// What is wrong with the first number of `job` that is out of its range: "depth.latency_s: 900
/// must be at most 600".
WELLGYRO_EXPORT std::optional<std::string> FindNumberComplaint(const Job& job);

/// The keys as Markdown, a table of each section.
WELLGYRO_EXPORT std::string JobReference();

}  // namespace wellgyro
