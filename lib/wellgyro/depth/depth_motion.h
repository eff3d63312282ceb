#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "wellgyro/base/export.h"
#include "wellgyro/base/time.h"
#include "wellgyro/depth/depth_track.h"
#include "wellgyro/record/sample_block.h"

namespace wellgyro {

/// Depth marks against the motion along the hole that the accelerometers feel: do marks jump where
/// nothing was felt, and do they come late?
///
/// Third difference of four marks two seconds apart: the way between the middle two less the mean
/// of the ways beside it, zero for any constant acceleration. Less the same third difference of the
/// felt motion (double integral of f_z less gravity's share of it) it is a depth step between the
/// middle two plus -lag times the third difference of the felt speed. Steps are judged against
/// their own scatter, the lag is a least-squares fit over all starts and stops. So is the scale of
/// the marks' third differences over the felt ones: 1, -1 where depth counts against the tool's
/// axis, 3.28 of feet taken for metres. Memory is bounded.
/// Marks are looked up when the samples of their time come, so that how the two streams interleave
/// does not matter.
///
/// Gravity's share changes as the hole builds, near horizontal by g times the turn, and of a third
/// difference a steady change leaves g sin I v kappa T^3 / 2 (.02 m at 1 m/s, 1 deg/30 m, T = 2 s).
/// The gyros tell it: a force that is steady in the Earth's frame changes in T by
///   f_z' = -(w x f)_z = w_y f_x - w_x f_y,
/// whatever the tool's roll is and without a third axis.
class WELLGYRO_EXPORT DepthMotion {
 public:
  struct Found {
    std::int64_t compared = 0;      ///< groups of four marks
    double step = 0;                ///< the largest, less what a lag of 1 s makes there [m]
    double sigma_step = 0;          ///< of one, as they scatter [m]
    std::optional<double> step_md;  ///< where [m]
    /// Length of which all ways from the first mark are whole multiples, to 1 mm; 0: not known [m].
    double resolution = 0;
    double lag = 0;          ///< positive where depth comes late [s]
    double sigma_lag = 0;    ///< 0: no start or stop tells it [s]
    double scale = 0;        ///< of the marks' starts and stops over those felt [1]
    double sigma_scale = 0;  ///< 0: no start or stop tells it [1]
  };

  /// The next samples, each over `period` from its `utc` on. Marks of `track` are final over this
  /// time.
  void Feel(std::span<const UtcTime> utc, Duration period, std::span<const SixAxes> samples,
            const DepthTrack& track);
  /// The depth scale changes here: marks on either side are not compared.
  void Restart();
  Found found() const;

 private:
  static constexpr std::size_t kMarks = 4;  // of a third difference

  /// A mark, and the felt speed and way there, as seen from a body that falls freely from the
  /// oldest mark at hand on.
  struct Passed {
    UtcTime utc;
    double md = 0, speed = 0, way = 0;
  };
  /// What has been felt so far.
  struct Fall {
    double speed = 0, way = 0;
    double gravity = 0;  ///< change of its share along the tool, as the gyros tell it [m/s^2]

    double Force(const SixAxes& sample, double length);
    void Go(double f_z, double seconds);
  };
  /// A time in which no mark is to be compared, of the marks that are in.
  struct NoMark {
    UtcTime from{INT64_MAX}, until{INT64_MIN};
    bool Holds(UtcTime begin, UtcTime end) const { return from <= begin && end <= until; }
  };
  std::size_t FeelOn(std::span<const UtcTime> utc, Duration period,
                     std::span<const SixAxes> samples, const NoMark& none);
  NoMark FeelOne(UtcTime utc, Duration period, const SixAxes& sample, const DepthTrack& track);
  NoMark NoMarkYet() const;
  NoMark PassMark(UtcTime begin, double f_z, const DepthTrack& track);
  void Pass(const Passed& passed);
  void FallFromOldest(UtcTime now);
  void Compare();
  void Resolve(double way);
  void AddScale(double way, double mark);
  double Sigma() const;

  std::array<Passed, kMarks> passed_;
  std::size_t passed_count_ = 0;
  std::optional<UtcTime> last_mark_, felt_until_;
  Fall fall_;
  std::optional<double> first_md_;  ///< of all marks [m]
  Found found_;
  double sum_size_ = 0;  ///< of steps, each at most four times their mean so far
  double rate2_ = 0, rate_step_ = 0;
  double way2_ = 0, way_mark_ = 0, mark2_ = 0;  ///< third differences felt, marked, and of both
};

}  // namespace wellgyro
