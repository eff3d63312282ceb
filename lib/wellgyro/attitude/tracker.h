#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include <Eigen/Core>

#include "wellgyro/base/angle.h"
#include "wellgyro/base/export.h"
#include "wellgyro/base/time.h"
#include "wellgyro/earth/earth.h"
#include "wellgyro/record/along_hole.h"
#include "wellgyro/record/knot.h"
#include "wellgyro/record/quality.h"
#include "wellgyro/record/sample.h"

namespace wellgyro {

/// How a HighSideTracker works. Every length of time is positive; noise may be zero.
struct TrackerOptions {
  enum Order {
    kSecond,  ///< each sample by itself: error of the turn falls as period^2
    kThird,   ///< the slopes across the sample too, from its neighbours: as period^4
  };
  Order order = kThird;
  double accel_noise = 0;        ///< of the mean over t seconds: this / sqrt(t) [m/s^2 sqrt(s)]
  double angle_random_walk = 0;  ///< of the transverse gyros [rad/sqrt(s)]
  double level_seconds = 20;     ///< over which accelerometers correct the gyros' inclination [s]
  double inclination_min = FromDegrees(0.5);  ///< below it, or above pi less it: vertical [rad]
  double sigma_toolface_max = 0.1;            ///< of one sample, beyond it: vertical [rad]
  double roll_limit = kPi / 2;                ///< per sample, beyond it: aliased [rad]
  /// Where the accelerometers sit, from the point of the axis that `speed` moves [m].
  Eigen::Vector3d p_accel_T = Eigen::Vector3d::Zero();
  double roll_rate_seconds = 0.1;  ///< smoothing of the roll rate that the lever arm needs [s]
};

/// Follows the high side of a moving tool sample by sample and sums into Knots what two transverse
/// gyros and three accelerometers say about the turning of the hole. It holds no azimuth.
///
/// The transverse rate W = w_x + i w_y is turned to the high side with the accelerometers' own
/// toolface, W e^{iT}, a slow quantity however fast the tool rolls; both sensors are means over a
/// rotating period, and that loss is given back (sinc). Inclination is the gyros' r-rate, held to
/// the accelerometers by an observer with a rate-bias state. What the tool's travel adds to the
/// specific force, v' e3 + v (w_IT + w_IE) x e3 + the lever arm's part, is taken out first; where
/// along.known is false it is not, and kDepth says so.
///
/// The state stands at the *end of the last sample but one* until Flush(): a sample is summed when
/// its successor is there. Near vertical 1/sin I is held at its value at the threshold
///   sin I = max(sin(inclination_min), accel_noise / (g sqrt(period) sigma_toolface_max)),
/// which keeps all sums finite, and kVertical is set. Values may be copied: a copy goes on alone.
class WELLGYRO_EXPORT HighSideTracker {
 public:
  /// Throws std::invalid_argument for an option outside its domain.
  explicit HighSideTracker(const TrackerOptions& options);

  /// Takes the next sample; `along` at the begin of it. Returns false and changes nothing where the
  /// sample begins before the last one ended (late, or sent twice) or has no period. A jump in
  /// time, number or session is a gap: the window closes before it and opens after it, nothing is
  /// invented for it. A change of period only breaks the window. Allocates nothing.
  bool Push(const ImuSample& sample, const AlongHole& along, const Site& site);

  /// Sums the sample that still waits for its successor. At the end of a run; a Push may follow,
  /// but then the slopes at this place are one-sided.
  void Flush();

  /// The azimuth of the axis [rad], where known, for the Earth's part in the inclination rate and
  /// in the Coriolis force. Both are small: unset, or wrong by d, inclination errs after a change
  /// by at most min(d, 1) We cos L level_seconds / e (7 s of Earth rate) and settles to zero, and
  /// specific force by v We cos L (3e-6 g per m/s). A value held for minutes is good enough.
  void SetAzimuth(std::optional<double> azimuth);

  bool ready() const { return ready_; }                ///< a sample has been summed
  ToolTime time() const { return end_; }               ///< end of the last summed sample
  ToolTime sample_begin() const { return begin_; }     ///< begin of it
  double inclination() const { return inclination_; }  ///< at time() [rad], [0, pi]
  double toolface() const;                             ///< at time() [rad], (-pi, pi]
  Quality quality() const { return sample_quality_; }  ///< of the last summed sample

  /// Ends the interval at time(), or at `fraction` in (0, 1] of the last summed sample, whose
  /// remainder then stays for the next interval. Sums over adjoining intervals add up to those
  /// over their union to rounding. A sample cut in two counts in both sequence ranges and gives its
  /// flags to both. `still` is left false: stillness is not seen here. An interval without samples
  /// has seconds = 0. Throws std::invalid_argument before the first sample has been summed, and for
  /// a fraction outside (0, 1] or before an earlier cut of the same sample.
  Knot CutKnot() { return CutKnot(1.0); }
  Knot CutKnot(double fraction);

 private:
  static constexpr int kStates = 12;  // inclination errors followed through the observer
  static constexpr int kSums = 29 + kStates;
  using Sums = std::array<double, kSums>;  // see enum Sum in the source

  struct Seen {  // a sample made ready: the rate turned to the high side, force of gravity alone
    SampleStamp stamp;
    AlongHole along;
    double dt, ux, uy;          // e^{iT}, T the phase of the mean
    double vh, vr;              // (W dt) e^{iT}
    double ax, ay, az;          // rotation over the period in T; az where has_gz
    double across, fz;          // |f_x + i f_y|, f_z [m/s^2]
    double e_r;                 // the Earth's part of the inclination rate [rad/s]
    std::int64_t gap_ns, lost;  // before it
    Quality quality;
    bool has_gz;
  };
  struct Slopes {  // over u in [-1/2, 1/2]: T = c0 + c1 u + c2 u^2, W e^{iT} period = a0 + a1 u
    double c1 = 0, c2 = 0, a1h = 0, a1r = 0;
  };
  struct Mean {  // inclination over a sample
    double accel, sine, cosine, csc, rise;
  };

  bool Follows(const SampleStamp& next, bool& breaks, std::int64_t& gap_ns,
               std::int64_t& lost) const;
  void Prepare(const ImuSample& sample, const AlongHole& along, Seen& s);
  void TakeSite(const Site& site, double dt);
  void TakeFirst(const ImuSample& sample);
  void TakeLeverArm(const ImuSample& sample, double dt, double& fx, double& fy, double& fz);
  void Integrate(const Seen& s, const Slopes& slopes);
  Mean Level(const Seen& s, double rise, double curve, double across);
  void TakeGains(double dt);
  double Roll(const Seen& s, const Slopes& slopes) const;
  void FollowErrors(const Seen& s, const Slopes& slopes, const Mean& mean, double vh, double vr);
  void AddSample(const Seen& s, bool vertical);
  void FillErrors(const Sums& sums, Knot& knot) const;

  const Seen& last() const { return seen_[waiting_ ? 1 - newest_ : newest_]; }

  TrackerOptions options_;
  // What only changes now and then: azimuth (both zero: unset), site, period.
  double cos_azimuth_ = 0, sin_azimuth_ = 0;
  double latitude_ = 0, earth_cos_ = 0, earth_sin_ = 0, inverse_radius_ = 0;
  double gravity_ = 0, inverse_gravity_ = 0;
  double dt_ = 0, alpha_steady_ = 0, beta_steady_ = 0, sin_min_ = 1;
  // Observer of inclination and of its errors.
  double inclination_ = 0, sin_i_ = 0, cos_i_ = 1, csc_ = 1, rate_bias_ = 0;
  double memory_ = 0, alpha_ = 1, beta_ = 0;
  int since_exact_ = 0;
  std::array<double, kStates> error_{}, error_rate_{};
  // Roll rate, twice smoothed, for the lever arm.
  double roll_rate_1_ = 0, roll_rate_2_ = 0, raw_x_ = 0, raw_y_ = 0;
  // The window: the sample that waits, and what is left of the one before it.
  std::array<Seen, 2> seen_{};
  int newest_ = 0;
  bool started_ = false, waiting_ = false, has_before_ = false, ready_ = false;
  double before_vh_ = 0, before_vr_ = 0, delta_in_ = 0;
  // The last summed sample.
  ToolTime begin_, end_;
  Slopes slopes_;
  Sums part_{};
  double end_x_ = 1, end_y_ = 0, cut_ = 1, rise_ = 0;
  Quality sample_quality_ = Quality::kGood;
  bool sample_vertical_ = false;
  // The open interval.
  Sums sums_{};
  std::int64_t ns_ = 0, gap_ns_ = 0, lost_ = 0, seq_begin_ = 0;
  bool empty_ = true, all_vertical_ = true;
  Quality quality_ = Quality::kGood;
};

}  // namespace wellgyro
