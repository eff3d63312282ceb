#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/base/time.h"
#include "wellgyro/depth/depth_track.h"
#include "wellgyro/record/depth.h"

namespace wellgyro {

/// How much longer a cable of measured length `md` [m] is in the hole: K L (mean tension -
/// measuring tension), with the tension going evenly from `tension` at the wheel [N], or what the
/// cable and tool weigh, to the tool's weight; and alpha L (mean temperature - measuring
/// temperature). This is what the stretch charts of cable makers hold, K in ft for 1000 ft and 1000
/// lbf.
WELLGYRO_EXPORT double StretchOf(const Cable& cable, double md, std::optional<double> tension);

/// `mark` with stretch in its depth and sigma, unless it is corrected already.
WELLGYRO_EXPORT DepthMark Stretched(const Cable& cable, DepthMark mark);

/// Holds the depth of a track to the magnetic marks of its cable.
///
/// A mark that passes says that the depth is a whole number of spacings from the first; what the
/// track reads differently is added from there on, brought in over half a spacing so that depth
/// stays smooth, and carried on at the rate at which it grew between the last two marks (at most
/// 2 m per km). A mark that reads more than a quarter of a spacing off is left out. After a depth
/// event marks count anew. A function of the marks up to the instant alone.
class WELLGYRO_EXPORT CableMarks {
 public:
  /// `track` must outlive this object. Throws std::invalid_argument for a negative spacing or
  /// sigma.
  CableMarks(const Cable& cable, const DepthTrack& track);

  /// Takes a mark whose magnetic_mark is set; others, and marks seen before, are skipped.
  void Push(const DepthMark& mark);
  /// What to add to the track's `md` at `utc`, where the track is final. 0 before the first mark.
  double At(UtcTime utc, double md) {
    return waiting_.empty() && laws_.empty() ? 0 : Added(utc, md);
  }

  std::size_t passed() const { return laws_.size(); }        ///< marks that count
  std::size_t left_out() const { return left_out_; }         ///< read too far off
  double largest_change() const { return largest_change_; }  ///< of what is added, mark to mark [m]

 private:
  /// What holds from one mark to the next.
  struct Law {
    UtcTime utc;
    std::int32_t segment;
    double md;      ///< read at the mark [m]
    double start;   ///< added just before it [m]
    double target;  ///< to be added at it [m]
    double slope;   ///< of what is added [1]
    double At(double md_now, double half) const;
  };
  double Added(UtcTime utc, double md);
  void Resolve(UtcTime until);
  void Take(UtcTime utc);

  Cable cable_;
  const DepthTrack* track_;
  std::vector<UtcTime> waiting_;  ///< marks not yet resolved, by time
  std::vector<Law> laws_;         ///< by time
  std::optional<double> base_;    ///< depth of a mark, by the reading of the present segment
  std::optional<std::int32_t> segment_;
  std::size_t left_out_ = 0;
  double largest_change_ = 0;
};

}  // namespace wellgyro
