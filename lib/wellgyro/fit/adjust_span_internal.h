#pragma once

#include <complex>
#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/attitude/filter.h"
#include "wellgyro/record/knot.h"
#include "wellgyro/record/knot_sources.h"

namespace wellgyro {

/// Several knots of a run as one, from node to node. With A the azimuth and I the inclination at
/// its begin, and errors e,
///   azimuth grows by turn + Re[e^{iA} earth_turn] + up - (d_turn + Re[e^{iA} by_inclination]
///   d_inclination) e, inclination by lift + Im[e^{iA} earth_lift] + carried - d_lift e;
/// the accelerometers say (I + I_end)/2 + bow + d_level e for its mean.
struct AdjustSpan {
  std::size_t epoch_begin = 0, epoch_end = 0;  ///< [begin, end) of FilterHistory::epochs
  double seconds = 0;                          ///< gaps included [s]
  bool still = false;
  bool vertical = false;      ///< the form below does not hold, or for the azimuth alone
  bool axial = false;         ///< it does for the azimuth: see Knot::axial
  bool lifts = false;         ///< where axial, for the inclination too
  bool broken = false;        ///< moving: nothing links the azimuths of its two ends
  bool levelled = false;      ///< has samples whose accelerometers count
  double turn = 0, lift = 0;  ///< [rad]
  double still_turn = 0;      ///< at rest: what the azimuth is counted from has moved [rad]
  std::complex<double> earth_turn, earth_lift;
  double up = 0;       ///< Earth's and transport rate about the vertical [rad]
  double carried = 0;  ///< transport rate about the right [rad]
  std::complex<double> turn_by_latitude, lift_by_latitude;
  double up_by_latitude = 0;
  std::complex<double> by_inclination;
  Knot::SourceVector d_turn = Knot::SourceVector::Zero();
  Knot::SourceVector d_lift = Knot::SourceVector::Zero();
  Eigen::Vector3d d_inclination = Eigen::Vector3d::Zero();  ///< of the tracker, by accelerometers
  /// Where axial, of the true azimuth by that of its two ends, in the Earth's share of the lift.
  Knot::SourceVector d_azimuth = Knot::SourceVector::Zero();
  bool curved = false;
  SecondOrderShare second;                       ///< if so, of turn and of lift
  SourceForm second_level = SourceForm::Zero();  ///< and of the level below
  Knot::SourceVector d_level = Knot::SourceVector::Zero();
  double level = 0;  ///< mean of the accelerometers' inclination [rad]
  double bow = 0;    ///< mean of the path's inclination less its chord's [rad]
  double var_turn = 0, var_lift = 0, var_level = 0;  ///< [rad^2]
};

struct SpanOptions {
  double seconds = 10;      ///< longest span made of several knots [s]
  bool at_stations = true;  ///< every marked station ends a span
  /// Of every epoch, whether the azimuth is lost over it: moving there nothing links the azimuths
  /// of a span's two ends. Empty: nowhere.
  std::vector<bool> lost;
};

/// Place of the tool at the begin of an epoch, and how its azimuth grows over it.
struct AdjustPlace {
  double latitude = 0, height = 0;
  double grown = 0;  ///< [rad]
};

/// Along the azimuths at the end of every epoch (empty: unknown, the place stays, and the azimuth
/// grows as the gyros say).
std::vector<AdjustPlace> PlacesAlong(const FilterHistory& history,
                                     const std::vector<double>& azimuth);

/// All epochs of `history` that have a length, in spans.
std::vector<AdjustSpan> SpansOf(const FilterHistory& history,
                                const std::vector<AdjustPlace>& places, const SpanOptions& options);

}  // namespace wellgyro
