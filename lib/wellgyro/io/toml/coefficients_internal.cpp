#include "wellgyro/io/toml/coefficients_internal.h"

#include <algorithm>
#include <span>
#include <string>
#include <vector>

#include "wellgyro/calibration/error_sources.h"
#include "wellgyro/io/toml/job_numbers_internal.h"
#include "wellgyro/survey/job_keys.h"
#include "wellgyro/survey/unstated_errors.h"

namespace wellgyro {
namespace {

// Each key of [errors] with the place of its number in `job`.
template <class Take>
void ForEachPrior(const Job& job, const Take& take) {
  for (const JobKey& key : JobKeys()) {
    if (key.table == "errors") take(std::string(key.key), key.unit, key.find(job));
  }
}

bool IsAmong(const std::string& key, std::span<const std::string> keys) {
  return std::find(keys.begin(), keys.end(), key) != keys.end();
}

// What may stand beside a coefficient: a bound instead of it, or its sigma.
void CheckCompanions(TomlTable& table, const std::string& key) {
  const bool bounded = table.FindNumber(key + "_upper95", kNotNegative).has_value();
  const bool measured = table.FindNumber(key + "_sigma", kNotNegative).has_value();
  if (bounded && (measured || table.Has(key))) {
    table.Refuse(key + "_upper95", "stands alone, for a coefficient that could not be observed",
                 FaultCode::kConflict);
  }
  if (measured && !table.Has(key)) {
    table.RefuseAbsent(key, "is missing while its sigma is there");
  }
}

}  // namespace

NoiseCoefficients ReadCoefficients(TomlTable& table) {
  Job job;
  ReadNumbers(table, "noise", job);
  for (const JobKey& key : JobKeys()) {
    if (key.table == "noise" && key.make) CheckCompanions(table, std::string(key.key));
  }
  return job.noise;
}

ErrorPriors ReadPriors(TomlTable& table) {
  Job job;
  ReadNumbers(table, "errors", job);
  return job.errors;
}

std::vector<std::string> PriorsOfNone(const TomlTable& table, const ErrorPriors& priors) {
  Job job;
  job.errors = priors;
  std::vector<std::string> none;
  ForEachPrior(job, [&](const std::string& key, double /*unit*/, const double* prior) {
    if (table.Has(key) && *prior == 0) none.push_back(key);
  });
  return none;
}

void WritePriors(TomlWriter& out, const ErrorPriors& priors, std::span<const std::string> none) {
  Job job;
  job.errors = priors;
  ForEachPrior(job, [&](const std::string& key, double unit, const double* prior) {
    if (*prior != 0 || IsAmong(key, none)) out.Number(key, *prior / unit);
  });
}

ErrorPriors PriorsOfJob(TomlTable* table, const ToolCalibration* tool) {
  Job job;
  if (tool != nullptr && tool->errors) job.errors = *tool->errors;
  if (table != nullptr) ReadNumbers(*table, "errors", job);
  std::vector<const double*> stated;
  ForEachPrior(job, [&](const std::string& key, double /*unit*/, const double* prior) {
    const bool of_none = tool != nullptr && tool->errors && IsAmong(key, tool->errors_none);
    const bool by_job = table != nullptr && table->Has(key);
    if (by_job || of_none || *prior != 0) stated.push_back(prior);
  });
  FillUnstated(stated, job.errors);
  if (tool != nullptr) {
    const Eigen::Vector2d known = AxialCoupling(tool->gyro);
    job.errors.gyro_misalignment_x = known.x();
    job.errors.gyro_misalignment_y = known.y();
  }
  return job.errors;
}

}  // namespace wellgyro
