#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/earth/earth.h"
#include "wellgyro/fit/bench_checks_internal.h"
#include "wellgyro/fit/tool_references_internal.h"
#include "wellgyro/math/median.h"

namespace wellgyro {

void TellReferences(std::span<const BenchTable> tables, const ToolReadings& readings,
                    const ToolFitSetup& setup, FitReport& report) {
  if (!tables.front().Find("T_C")) {
    report.remarks.emplace_back(
        "no temperatures (column T_C): what they do to the sensors is in the result");
  }
  const bool timed = std::all_of(tables.begin(), tables.end(), [](const BenchTable& data) {
    return data.Find("t_s").has_value();
  });
  if (!timed) {
    report.remarks.emplace_back(
        "no times (column t_s): drift is taken to go from row to row, so the rows of a table must "
        "stand in the order in which they were read");
  }
  if (readings.n_accel == 0 || !setup.reference.latitude) return;
  // Of gravity: an anomaly of 200 mGal, and with it two kilometres of height, 6.3e-4.
  constexpr double kAbove = 8e-4, kAnomaly = 2e-4;
  const double normal = SiteAt(*setup.reference.latitude, 0).gravity;
  const double off = setup.reference.gravity_mps2 / normal - 1;
  if (off < kAnomaly && off > -kAbove) return;
  report.remarks.push_back(fmt::format(
      "gravity is taken as {:.5g} m/s2 where {:.5g} is normal at the bench's latitude: the "
      "accelerometers' sensitivities are wrong by as much ({:.1e}) if that is not so",
      setup.reference.gravity_mps2, normal, off));
}

// Rates of change of a chamber's temperature end at 15 degC a minute (IEC 60068-2-14, test Nb); a
// tool in it follows more slowly. Half of a table's readings beyond that have times in another
// unit.
void TellHeating(std::span<const BenchTable> tables, const ToolReadings& readings,
                 FitReport& report) {
  constexpr double kChamber = 15.0 / 60;  // degC/s
  for (std::size_t table = 0; table < tables.size(); ++table) {
    std::vector<double> rates;
    for (const ToolRow& row : readings.rows) {
      if (static_cast<std::size_t>(row.table) == table) rates.push_back(std::abs(row.heating));
    }
    const double middle = Median(std::move(rates));
    if (!(middle > kChamber)) continue;
    report.remarks.push_back(fmt::format(
        "{}: T_C changes by {:.3g} degC a minute, faster than any chamber: t_s is not in seconds, "
        "and heating terms are wrong by as much",
        tables[table].source, 60 * middle));
  }
}

// Positions tell a wrong latitude as a rate along gravity, which mass unbalance is too.
void TellLatitude(std::span<const BenchTable> tables, const ToolReadings& readings,
                  const ToolFitSetup& setup, FitReport& report) {
  const bool rates = std::any_of(tables.begin(), tables.end(), [](const BenchTable& data) {
    return data.Find("rate_deg_s").has_value();
  });
  if (readings.n_gyro == 0 || rates) return;
  const double L = *setup.reference.latitude, turn = FromDegrees(0.1);
  report.remarks.push_back(fmt::format(
      "no rate table: nothing here checks the latitude; 0.1 deg more would move mass unbalance by "
      "{:.2g} deg/h/g and the gyros' sensitivity by {:.2g}",
      std::abs(kBenchEarthDegPerHour * std::sin(turn) / std::cos(L)),
      std::abs(std::tan(L) * turn)));
}

}  // namespace wellgyro
