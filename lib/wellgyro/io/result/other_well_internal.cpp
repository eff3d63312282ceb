#include "wellgyro/io/result/other_well_internal.h"

#include <cstddef>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/io/exchange/well_stations.h"
#include "wellgyro/survey/hole/well_uncertainty.h"

namespace wellgyro {

Result<Json> WellJson(const OtherWell& other) {
  Result<WellStations> file = ParseWellStations(other.text, other.name);
  if (!file) return file.fault();
  if (!file->start_stated) file->start_W = {0, 0, file->stations.front().md};
  std::vector<double> md;
  for (const SurveyPoint& station : file->stations) md.push_back(station.md);
  const SurveyedWell well = SurveyWell(std::move(file->stations), file->start_W);
  Json rows = Json::array();
  for (std::size_t i = 0; i < md.size(); ++i) {
    const Eigen::Vector3d& p_WT_W = well.position_W[i];
    rows.push_back({md[i], p_WT_W.x(), p_WT_W.y(), p_WT_W.z()});
  }
  return Json{{"name", other.name},
              {"start_stated", file->start_stated},
              {"columns", {"MD[m]", "N[m]", "E[m]", "TVD[m]"}},
              {"rows", std::move(rows)}};
}

}  // namespace wellgyro
