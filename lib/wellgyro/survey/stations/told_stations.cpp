#include "wellgyro/survey/stations/told_stations.h"

namespace wellgyro {

void ToldStations::Tell(const Station& station) {
  told_.insert_or_assign(KeyOf(station), station);
  sink_.OnStation(station);
}

void ToldStations::KeepTo(std::vector<Station>& stations) const {
  for (Station& station : stations) {
    const auto told = told_.find(KeyOf(station));
    if (told == told_.end() || told->second.revision != station.revision) continue;
    const Station& as = told->second;
    station.md = as.md;
    station.tangent_L = as.tangent_L;
    station.inclination = as.inclination;
    station.azimuth = as.azimuth;
    station.toolface = as.toolface;
    station.cov_md_inc_azi = as.cov_md_inc_azi;
    station.cov_tangent_L = as.cov_tangent_L;
    station.p_WT_W = as.p_WT_W;
    station.cov_p_WT_W = as.cov_p_WT_W;
    station.dogleg_severity = as.dogleg_severity;
    // Without the flag, the covariance of an unfit station would be a strange one.
    if (Has(as.quality, Quality::kUnfit)) station.quality |= Quality::kUnfit;
  }
}

}  // namespace wellgyro
