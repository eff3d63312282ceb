#pragma once

#include <map>
#include <vector>

#include "wellgyro/record/station.h"
#include "wellgyro/survey/stations/station_key.h"
#include "wellgyro/survey/surveyor.h"

namespace wellgyro {

/// Every station as it was told last: of one revision a station has one position and covariance,
/// wherever it is read.
class ToldStations {
 public:
  /// `sink` must outlive this object.
  explicit ToldStations(Sink& sink) : sink_(sink) {}

  void Tell(const Station& station);
  /// Gives stations the numbers of the revision that was told; a later one brings others.
  void KeepTo(std::vector<Station>& stations) const;

 private:
  Sink& sink_;
  std::map<StationKey, Station> told_;
};

}  // namespace wellgyro
