#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>

#include <Eigen/Core>

#include "wellgyro/attitude/level_noise.h"
#include "wellgyro/attitude/roll_observer.h"
#include "wellgyro/attitude/unseen.h"
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
    kThird,   ///< the slopes across the sample too, from its neighbours: as period^3
  };
  Order order = kThird;
  double accel_noise = 0;        ///< of the mean over t seconds: this / sqrt(t) [m/s^2 sqrt(s)]
  double angle_random_walk = 0;  ///< of the transverse gyros [rad/sqrt(s)]
  double level_seconds = 20;     ///< over which accelerometers correct the gyros' inclination [s]
  /// Acceleration along the hole at which they do so at half weight: depth tells a changing one
  /// late and smeared, and what is left of it would pass for inclination [m/s^2]. Where depth does
  /// not tell it at all, they count for a tenth.
  double acceleration_doubt = 0.005;
  double inclination_min = FromDegrees(0.5);  ///< below it, or above pi less it: vertical [rad]
  double sigma_toolface_max = 0.1;            ///< of one sample, beyond it: vertical [rad]
  double roll_limit = kPi / 2;                ///< per sample, beyond it: aliased [rad]
  /// Where the accelerometers sit, from the point of the axis that `speed` moves [m].
  Eigen::Vector3d p_accel_T = Eigen::Vector3d::Zero();
  double toolface_seconds = 2;     ///< over which they correct the third gyro's toolface [s]
  double roll_rate_seconds = 0.1;  ///< smoothing of the roll rate that the lever arm needs [s]
  UnseenHole unseen;
};

/// Follows the high side of a moving tool sample by sample and sums into Knots what two transverse
/// gyros and three accelerometers say about the turning of the hole. It holds no azimuth.
///
/// The transverse rate W = w_x + i w_y is turned to the high side with the accelerometers' own
/// toolface, W e^{iT}, a slow quantity however fast the tool rolls; both sensors are means over a
/// rotating period, and that loss is given back (sinc). Inclination is the gyros' r-rate, held to
/// the accelerometers by an observer with a rate-bias state. What the tool's travel adds to the
/// specific force, v' e3 + v (w_IT + w_IE) x e3 + the lever arm's part, is taken out first; where
/// along.known is false it is not, and kDepth says so. A third gyro axis, where a sample has it,
/// gives the toolface above a tenth of a Hz: see RollObserver.
///
/// The state stands at the *end of the last sample but one* until Flush(): a sample is summed when
/// its successor is there. Near vertical 1/sin I is held at its value at the threshold
///   sin I = max(sin(inclination_min), accel_noise / (g sqrt(period) sigma_toolface_max)),
/// which keeps all sums finite, and kVertical is set. Values may be copied: a copy goes on alone.
///
/// What a gap hides, and by how much a rate passed full scale, is unknown and counts in var_unseen;
/// the accelerometers' inclination takes over from the gyros' after it. A rate at full scale may be
/// as much again.
class WELLGYRO_EXPORT HighSideTracker {
 public:
  /// Throws std::invalid_argument for an option outside its domain.
  explicit HighSideTracker(const TrackerOptions& options);

  /// Takes the next sample; `along` at the middle of it. Returns false and changes nothing where
  /// the sample begins before the last one ended (late, or sent twice), has no period or is not
  /// finite. A jump in time, number or session is a gap: the window closes before it and opens
  /// after it, nothing is invented for it. A change of period only breaks the window. Allocates
  /// nothing.
  bool Push(const ImuSample& sample, const AlongHole& along, const Site& site);

  /// Sums the sample that still waits for its successor. At the end of a run; a Push may follow,
  /// but then the slopes at this place are one-sided.
  void Flush();

  /// The azimuth of the axis [rad], where known, for the Earth's part in the inclination rate and
  /// in the Coriolis force. Both are small: wrong by d, inclination errs after a change by at most
  /// min(d, 2) We cos L level_seconds / e (7 s of Earth rate) and settles to zero, and specific
  /// force by v We cos L (3e-6 g per m/s). A value held for minutes is good enough. Setting or
  /// unsetting it makes no step in inclination.
  void SetAzimuth(std::optional<double> azimuth);

  bool ready() const { return ready_; }  ///< a sample has been summed
  /// End of the last summed sample.
  ToolTime time() const { return sample_begin() + Duration{last().stamp.period_ns}; }
  ToolTime sample_begin() const { return last().stamp.tool_time; }  ///< begin of it
  double inclination() const { return inclination_; }               ///< at time() [rad], [0, pi]
  double toolface() const;                                          ///< at time() [rad], (-pi, pi]
  Quality quality() const { return sample_quality_; }               ///< of the last summed sample

  /// Ends the interval at time(), or at `fraction` in (0, 1] of the last summed sample, whose
  /// remainder then stays for the next interval. Sums over adjoining intervals add up to those
  /// over their union to rounding. A sample cut in two counts in both sequence ranges and gives its
  /// flags to both. `still` is left false: stillness is not seen here. An interval without samples
  /// has seconds = 0. Throws std::invalid_argument before the first sample has been summed, and for
  /// a fraction outside (0, 1] or before an earlier cut of the same sample.
  Knot CutKnot() { return CutKnot(1.0); }
  Knot CutKnot(double fraction);

  /// Ends the interval in the gap behind which the last pushed sample waits, `into` it. Its
  /// inclination is that of the gap's begin, with what it may have changed by since. Throws
  /// std::invalid_argument where no gap waits, or before an earlier cut of it or behind its end.
  Knot CutGap(Duration into);

 private:
  /// Rms acceleration of a tool whose depth nobody knows [m/s^2].
  static constexpr double kUnknown = 0.03;

  // Summed over samples, V = W e^{iT} over the period: what Evaluate() makes errors from.
  enum Sum {
    kTurn,     // V_h / sin I
    kAccel,    // accelerometers' inclination dt
    kLift,     // V_r
    kLiftH,    // V_h
    kRoll,     // of the toolface
    kCot,      // cot I dt
    kUnitC,    // cos T dt
    kUnitS,    // sin T dt
    kSpin,     // rotation about z where has_gz, else zero
    kTrust,    // how far the observer followed the accelerometers, times dt
    kSeconds,  // dt
    kSums
  };
  using Sums = std::array<double, kSums>;

  struct Seen {  // a sample made ready: the rate turned to the high side, force of gravity alone
    SampleStamp stamp;
    AlongHole along;
    double dt, ux, uy;                        // e^{iT}, T the phase of the mean
    double vh, vr;                            // (W dt) e^{iT}
    double spin;                              // rotation about z where has_gz, else zero
    double across, fz;                        // |f_x + i f_y|, f_z [m/s^2]
    double e_r;                               // the Earth's part of the inclination rate [rad/s]
    std::int64_t gap_ns, lost;                // before it
    double unseen_before, var_unseen_before;  // in that gap: see Knot
    double unseen;                            // in it
    Quality quality;
    bool has_gz;
  };
  struct Slopes {  // over u in [-1/2, 1/2]: T = c0 + c1 u + c2 u^2, W e^{iT} period = a0 + a1 u
    double c1 = 0, c2 = 0, a1h = 0, a1r = 0;
  };
  struct Mean {  // inclination over a sample; csc and cot held below the threshold
    double accel, csc, cot, trust;
    bool vertical;
  };
  struct Gains {  // of the observer, on inclination and on its rate times the step
    double level, rate;
  };
  /// Of a line fitted to the level: the samples' trust, summed, and its moments of time from now.
  struct Memory {
    double span = 0, seconds = 0, first = 0, second = 0;
    void Add(double dt, double trust);
    void Shorten(double left);
  };
  struct Observed {  // errors of inclination, as the observer carries them on: by source ...
    Knot::SourceVector level = Knot::SourceVector::Zero();
    Knot::SourceVector rate = Knot::SourceVector::Zero();
    LevelNoise noise;  // ... and from noise of the depth
  };
  struct Errors {  // what a Knot says of errors
    Knot::SourceVector turn = Knot::SourceVector::Zero();
    Knot::SourceVector lift = Knot::SourceVector::Zero();
    double white = 0, jitter = 0;
    void Add(const Errors& other, double sign);
  };

  struct Block {  // means of angles and sums of turns over a block
    double seconds, cot, csc, cs, sn, vh, vr, roll, spin, trust;
  };

  void AddUnseen(const AlongHole& along, double angle, double variance);
  void TakeSite(const Site& site, std::int32_t period_ns);
  void TakeFirst(const ImuSample& sample);
  void TakeReference();
  void TakeEarth();
  void Prepare(const ImuSample& sample, const AlongHole& along, Seen& s);
  void TakeLeverArm(const ImuSample& sample, double dt, double& fx, double& fy, double& fz);
  template <TrackerOptions::Order kOrder>
  Slopes Across(const Seen& s, const Seen* next);
  template <TrackerOptions::Order kOrder>
  void SumUp(const Seen& s, const Seen* next);
  void Integrate(const Seen& s, const Seen* next);
  Mean Level(const Seen& s, double rise, double curve, double across);
  /// Acceleration that halves what a sample counts: the shorter the memory, the more it weighs.
  double Reach(const Memory& memory, double dt) const {
    const double full = 2 * options_.level_seconds;
    if (memory.seconds >= full) return options_.acceleration_doubt;
    return options_.acceleration_doubt * std::clamp((memory.seconds + dt) / full, 0.3, 1.0);
  }
  /// One by what a sample counts that says no acceleration. The scatter of one averages out, which
  /// a late change does not.
  double Quiet(const AlongHole& along) const {
    const double sigma = along.known ? along.sigma_acceleration : kUnknown;
    const double doubt = 0.5 * sigma / options_.acceleration_doubt;
    return 1 + doubt * doubt;
  }
  Gains Steady(double dt) const;
  Gains Weighed(Gains steady, double dt, double trust, const Memory& memory) const;
  double Roll(const Seen& s, const Slopes& slopes);
  void AddSample(const Seen& s, bool vertical);
  void CloseBlock(const AlongHole& along);
  Block Means(const Sums& sums) const;
  void AddedTo(const Block& b, Knot::SourceVector& across, Knot::SourceVector& rise) const;
  Errors Evaluate(const Sums& sums, const AlongHole& along, Observed& observed) const;
  void FillErrors(const Sums& block, Knot& knot);
  void FillStamps(const Seen& s, Duration into, Knot& knot) const;
  void OpenInterval(const Seen& s, double fraction, std::int64_t rest_ns);

  const Seen& last() const { return seen_[waiting_ ? 1 - newest_ : newest_]; }

  TrackerOptions options_;
  bool off_axis_ = false;  ///< the accelerometers are
  // What only changes now and then: azimuth (both zero: unset), site, period.
  double cos_azimuth_ = 0, sin_azimuth_ = 0;
  double latitude_ = 0, earth_cos_ = 0, earth_sin_ = 0, inverse_radius_ = 0;
  double gravity_ = 0, inverse_gravity_ = 0;
  std::int32_t period_ns_ = 0;
  double dt_ = 0, inverse_dt_ = 0, sin_min_ = 1;
  Gains steady_{};
  RollObserver roll_;  // where there is a third gyro axis
  // Observer of inclination.
  double inclination_ = 0, rate_bias_ = 0;
  Memory memory_;
  double reference_ = 0, reference_sin_ = 0, reference_cos_ = 1, reference_cot_ = 0;
  double reference_reach_ = 0, earth_h_ = 0, earth_r_ = 0, carried_ = 0;
  // Roll rate, twice smoothed, for the lever arm.
  double roll_rate_1_ = 0, roll_rate_2_ = 0, raw_x_ = 0, raw_y_ = 0;
  // The window: the sample that waits, and what is left of the one before it.
  std::array<Seen, 2> seen_{};
  int newest_ = 0;
  bool started_ = false, waiting_ = false, has_before_ = false, ready_ = false;
  double before_vh_ = 0, before_vr_ = 0, delta_in_ = 0, delta_out_ = 0;
  // The last summed sample.
  double c1_ = 0, c2_ = 0;  ///< slopes of its toolface
  Sums part_{};
  double end_toolface_ = 0, cut_ = 1, rise_ = 0;
  Quality sample_quality_ = Quality::kGood;
  bool sample_vertical_ = false, has_gz_ = false;
  // Errors are followed by blocks of samples, whose bounds do not depend on where knots are cut:
  // what a cut takes out of an open block is taken off when the block closes.
  Sums block_{};
  Memory block_memory_;
  Observed observed_;
  Errors errors_, given_;
  // What was not seen of the hole's turning: as it goes on, in the interval.
  UnseenTurn unseen_;
  double unseen_here_ = 0, var_unseen_ = 0, unseen_roll_ = 0;
  std::int64_t gap_cut_ns_ = 0;
  bool level_ = true;
  // The open interval, without the open block.
  Sums sums_{};
  std::int64_t ns_ = 0, gap_ns_ = 0, lost_ = 0, seq_begin_ = 0;
  AlongHole along_begin_;
  bool empty_ = true, all_vertical_ = true;
  Quality quality_ = Quality::kGood;
};

}  // namespace wellgyro
