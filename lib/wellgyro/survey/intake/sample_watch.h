#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/base/export.h"
#include "wellgyro/record/along_hole.h"
#include "wellgyro/record/along_hole_block.h"
#include "wellgyro/record/check.h"
#include "wellgyro/record/north_fix.h"
#include "wellgyro/record/sample.h"
#include "wellgyro/survey/intake/truncation_watch.h"
#include "wellgyro/survey/job.h"

namespace wellgyro {

/// What samples say of their own sensors before anything is made of them: axes that repeat one
/// value, that are dead, swapped or inverted, rates in another unit, and motion at stops. Sums
/// only; memory grows with the stops.
///
/// - `gyro_stuck`, `accel_stuck` [s]: an axis repeats its value for 2 s and more (20 s where depth
///   rests) while another axis changes from sample to sample, which the stated noise does not allow
///   by the smallest step that the axis makes. `gyro_dead`, `accel_dead`: for nine tenths of the
///   run.
/// - `axes`: f_z' = w_y f_x - w_x f_y whatever the roll, because gravity does not turn but with the
///   Earth. Stretches of 30 s in which the hole bends tell this from the seven other ways to pair
///   gyros with accelerometers; fails where another explains them and this does not, and names it.
///   `axes_change`: in some stretches, one after the other.
/// - `gyro_truncated`, `accel_truncated` [1]: how often the two axes across read zero, over how
///   often they would by the levels beside it: 2 where numbers are cut towards zero.
/// - `accel_unit` [1]: the force at rest over gravity.
/// - `gyro_unit` [1]: by the sums of `axes`, the gyros' scale against the accelerometers'; at rest
///   the rate across the tool over the Earth's. Of axes or accelerometers that are wrong nothing.
/// - `rest_motion` [s]: the longest time for which depth rests and the tool does not.
class WELLGYRO_EXPORT SampleWatch {
 public:
  explicit SampleWatch(const Job& job);

  /// The next samples, in order, and where they are: the first of them at `at` of `along`. Of fast
  /// streams one sample in 20 ms is looked at.
  void Push(std::span<const ImuSample> samples, const AlongHoleBlock& along, std::size_t at);
  std::vector<Check> Checks(std::int32_t run, const std::vector<NorthFix>& fixes) const;
  /// f_z of the first rest over the force there: -1 of a tool that points down.
  std::optional<double> lean() const { return lean_; }

 private:
  static constexpr std::size_t kAxes = 6;      // gx gy gz ax ay az
  static constexpr std::size_t kPairings = 8;  // the right one first

  struct Axis {
    double value = 0;
    double step = 0;  ///< smallest change so far: its converter's
    std::int64_t changes = 0, repeats = 0;
    std::int64_t others = 0;   ///< changes of the busiest other axis, when the repeats began
    bool rests = true;         ///< depth did all the while
    double stuck = 0;          ///< seconds, so far
    std::optional<double> md;  ///< where it first was
    TruncationWatch truncation;
  };
  struct Stretch {
    double seconds = 0, begin_f_z = 0;
    std::optional<double> md;  ///< where it begins
    bool steady = false;       ///< where it begins the string keeps its speed
    Eigen::Matrix2d products = Eigen::Matrix2d::Zero();  ///< of w and f across the tool
  };
  /// Stretches one after the other that another pairing explains, and how much better.
  struct Spell {
    double better = 0, right = 0, left = 0;  ///< chi-square
    double seconds = 0;
    std::optional<double> md;  ///< where it begins
  };
  static Stretch StretchFrom(const ImuSample& sample, const AlongHole& along);
  void WatchSpells(std::optional<double> md, double seconds,
                   const std::array<double, kPairings>& squares);
  struct Stop {
    ToolTime begin, end;
    std::optional<double> md;
  };

  void Watch(const ImuSample& sample, const AlongHole& along);
  void WatchAxes(const ImuSample& sample, const AlongHole& along, bool rests);
  double StuckNow(std::size_t axis) const;
  double ChanceOfRepeats(std::size_t axis) const;
  std::int64_t Busiest(std::size_t besides) const;
  void WatchBend(const ImuSample& sample, const AlongHole& along, double seconds);
  void WatchRest(const ImuSample& sample, const AlongHole& along, bool rests, double seconds);
  void AddStuck(std::int32_t run, std::vector<Check>& checks) const;
  void AddTruncation(std::int32_t run, std::vector<Check>& checks) const;
  void AddPairing(std::int32_t run, std::vector<Check>& checks) const;
  bool AddForce(std::int32_t run, std::vector<Check>& checks) const;
  void AddUnit(std::int32_t run, std::vector<Check>& checks) const;
  void AddMotion(std::int32_t run, const std::vector<NorthFix>& fixes,
                 std::vector<Check>& checks) const;

  const Job& job_;
  std::int64_t wait_ = 0, stride_ = 1;  ///< samples
  std::array<Axis, kAxes> axes_;
  std::int64_t samples_ = 0;
  double seconds_ = 0, period_ = 0;
  std::optional<SampleStamp> last_;
  Stretch stretch_;
  std::array<double, kPairings> squares_{};        ///< what each pairing leaves
  std::array<Spell, kPairings> spells_, longest_;  ///< at hand, and the most telling
  double stretches_ = 0;
  double predicted2_ = 0, predicted_found_ = 0;
  struct Rest {
    Eigen::Vector2d turn = Eigen::Vector2d::Zero();
    double squares = 0, seconds = 0;  ///< of the rates, times time
    int samples = 0;
    Eigen::Vector3d force_T = Eigen::Vector3d::Zero();  ///< times time
  };
  Rest rest_;
  double rest_force_ = 0, rests_ = 0;  ///< forces of rests [m/s^2], how many
  std::optional<double> lean_;
  /// Rate across the tool in the stillest stretch, beyond what scatter makes of it [rad/s].
  std::optional<double> least_at_rest_;
  std::vector<Stop> stops_;
  bool resting_ = false;
};

}  // namespace wellgyro
