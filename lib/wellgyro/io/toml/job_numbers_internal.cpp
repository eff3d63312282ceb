#include "wellgyro/io/toml/job_numbers_internal.h"

#include <limits>

namespace wellgyro {
namespace {

void Take(TomlTable& table, const JobKey& key, Job& job) {
  const auto number = table.FindNumber(key.key, key.range);
  if (number) *key.make(job) = *number * key.unit;
}

}  // namespace

void ReadNumber(TomlTable& table, std::string_view section, std::string_view key, Job& job) {
  Take(table, JobKeyOf(section, key), job);
}

void NeedNumber(TomlTable& table, std::string_view section, std::string_view key, Job& job) {
  if (!table.Has(key)) table.RefuseAbsent(key, "is missing");
  ReadNumber(table, section, key, job);
}

void ReadNumbers(TomlTable& table, std::string_view section, Job& job) {
  for (const JobKey& key : JobKeys()) {
    if (key.table == section && key.make) Take(table, key, job);
  }
}

std::optional<std::int64_t> FindWhole(TomlTable& table, std::string_view section,
                                      std::string_view key) {
  using Limits = std::numeric_limits<std::int64_t>;
  const auto number = table.FindInteger(key, Limits::min(), Limits::max());
  if (!number) return std::nullopt;
  const auto complaint = ComplaintOfWhole(*number, JobKeyOf(section, key).range);
  if (complaint) table.Refuse(key, *complaint);
  return number;
}

std::optional<double> FindListed(TomlTable& table, std::string_view section, std::string_view key) {
  const JobKey& rule = JobKeyOf(section, key);
  const auto number = table.FindNumber(key, rule.range);
  if (!number) return std::nullopt;
  return *number * rule.unit;
}

}  // namespace wellgyro
