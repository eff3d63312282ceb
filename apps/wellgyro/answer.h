#pragma once

#include <optional>
#include <string>

#include <fmt/core.h>

#include "wellgyro/base/result.h"
#include "wellgyro/io/atomic_file.h"

#include "commands.h"
#include "distinct.h"
#include "report.h"

namespace wellgyro::apps {

/// Writes the files of an answer into `folder`, says where they are and what is to be noted; the
/// exit code where there is no answer or it cannot be written. Throws std::invalid_argument where
/// one would take the place of what was read, or of a survey's.
template <class Answer>
std::optional<int> WriteAnswer(const Result<Answer>& answer, const std::string& folder) {
  if (!answer) return Unusable(answer.fault());
  RequireUnread(answer->inputs, folder, answer->files);
  RequireNoSurvey(folder, answer->files);
  if (const auto fault = WriteFiles(folder, answer->files)) return Unusable(*fault);
  for (const std::string& note : answer->notes) fmt::print(stderr, "note: {}\n", note);
  for (const OutputFile& file : answer->files) fmt::print("{}/{}\n", folder, file.name);
  return std::nullopt;
}

}  // namespace wellgyro::apps
