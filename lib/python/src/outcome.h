#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "wellgyro/earth/grid.h"
#include "wellgyro/io/toml/job_file.h"
#include "wellgyro/survey/surveyor.h"

#include "binding.h"

namespace wellgyro::python {

/// Everything that a survey came to.
struct Outcome {
  std::shared_ptr<const JobFile> job;
  std::map<std::int32_t, Survey> tools;
  std::vector<std::string> faults;
  std::int64_t fault_count = 0;

  /// Throws std::invalid_argument where no such tool was heard of.
  const Survey& Of(std::int32_t tool) const;
  std::optional<WellGrid> Grid() const;
};

void AddOutcome(nb::module_& m);

}  // namespace wellgyro::python
