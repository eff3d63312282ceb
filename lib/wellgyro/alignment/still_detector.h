#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include <Eigen/Core>

#include "wellgyro/base/export.h"
#include "wellgyro/base/time.h"
#include "wellgyro/record/along_hole.h"
#include "wellgyro/record/along_hole_block.h"
#include "wellgyro/record/noise.h"
#include "wellgyro/record/sample.h"
#include "wellgyro/record/sample_block.h"

namespace wellgyro {

struct StillSetup {
  NoiseCoefficients gyro = {};
  ErrorPriors errors = {};  ///< gyro_bias_sigma and accel_noise are used
  /// A stop of this length gives a window. Its ragged ends, up to 4 s each, stay out of the means
  /// and are not held against it.
  Duration min_still = Duration::Seconds(60);
  /// Along-hole speed, as the mean of a block, above which the tool is not still [m/s]. Where four
  /// sigmas of the depth's speed are more, they count: one count of a 1 cm encoder reads as up to
  /// 0.011 m/s in a DepthTrack, whose speed such rounding leaves with 1-sigma .0052 m/s at 2 Hz and
  /// .0017 at 10 Hz. A speed just below it passes travel_limit in 17 s.
  double speed_limit = 0.006;
  /// Along-hole way within one window [m]; where four sigmas of two depths' difference are more,
  /// they count: marks that scatter by 0.1 m read as up to 0.4 m of way in a DepthTrack at 2 Hz.
  double travel_limit = 0.1;
};

/// Finds the stretches at rest in a stream of samples, causally and in constant memory.
///
/// The tool clock is cut into blocks of one second. A block is at rest when the scatter of its
/// samples is that of the sensors' noise (with floors for a tool hanging in a live hole), its mean
/// rate can be the Earth's with the gyros' bias, its mean rate and specific force agree with those
/// of the stretch so far, the specific force shows no slope over the stretch (creep, roll), and the
/// depth, where known, does not move: a tool sliding in a straight hole looks still to its sensors.
/// Partial blocks, and the first and last whole one of a stretch, are not averaged. Gaps, another
/// session and a change of the sample period end the stretch; saturation flags it.
///
/// Results depend on the samples and Cuts alone, not on how they come in batches.
class WELLGYRO_EXPORT StillDetector {
 public:
  /// Throws std::invalid_argument for a negative sigma or limit, or min_still not above 2 s.
  explicit StillDetector(const StillSetup& setup);

  /// Takes the next sample and the motion along the hole at its time; duplicates of seq are
  /// ignored. Returns the window that this sample ended, if one was long enough.
  [[nodiscard]] std::optional<StillWindow> Push(const ImuSample& sample, const AlongHole& along);
  /// How many samples from this one on are of the block at hand, each a period behind the one
  /// before.
  std::size_t Room(const SampleStamp& next) const;
  /// Takes samples, no more than there is Room() for, with the motion along the hole at each of
  /// them from `at` on, known for all. As Push of each would, at less cost.
  void Append(const SampleBlock& samples, const AlongHoleBlock& along, std::size_t at);
  /// The mode or the index position changes before the next sample: no window spans it. Windows
  /// from now on carry `index_position`.
  [[nodiscard]] std::optional<StillWindow> Cut(std::optional<std::int32_t> index_position);
  /// End of the stream; returns the open window if it is long enough.
  [[nodiscard]] std::optional<StillWindow> Flush();

  /// At rest as far as whole blocks and the speed at the last sample tell; true from the third
  /// block of a stretch on.
  bool still() const { return stretch_.blocks > 0 && !sliding_; }
  /// The means so far of the open stretch, of whatever length, for a provisional fix.
  std::optional<StillWindow> OpenWindow() const;

 private:
  /// Sums over the samples of the block in progress, relative to its first sample.
  struct Block {
    std::int64_t index = 0;  ///< of the second on the tool clock
    SampleStamp first;
    std::int64_t samples = 0, depths = 0;
    Eigen::Vector3d w0_T = Eigen::Vector3d::Zero(), f0_T = w0_T;  ///< the first sample
    Eigen::Vector3d sum_w_T = w0_T, sum_f_T = w0_T, sum_b_T = w0_T, square_w = w0_T,
                    square_f = w0_T;
    double sum_temperature = 0, sum_md = 0, sum_speed = 0, sum_sigma_speed = 0;
    bool gz = true, mag = true, saturated = false;
  };
  /// What remains of a finished block.
  struct Means {
    SampleStamp first, last;
    std::int64_t samples = 0;
    Eigen::Vector3d w_T = Eigen::Vector3d::Zero(), f_T = w_T, b_T = w_T;  ///< means
    Eigen::Vector3d var_w = w_T, var_f = w_T;                             ///< of one sample
    double temperature = 0, md = 0, speed = 0, sigma_speed = 0;
    bool md_known = false, gz = false, mag = false, saturated = false;

    double seconds() const { return static_cast<double>(samples * first.period_ns) * 1e-9; }
  };
  /// The averaged blocks of the stretch.
  struct Stretch {
    SampleStamp first, last;
    std::int64_t blocks = 0, samples = 0;
    Eigen::Vector3d sum_w_T = Eigen::Vector3d::Zero(), sum_f_T = sum_w_T, sum_b_T = sum_w_T;
    Eigen::Vector3d mean_w_T = sum_w_T, mean_f_T = sum_w_T;  ///< of block means
    Eigen::Vector3d square_w = sum_w_T, square_f = sum_w_T;  ///< of their differences from the mean
    Eigen::Vector3d sum_var_w = sum_w_T, sum_var_f = sum_w_T;
    double sum_temperature = 0, sum_md = 0;
    double sum_t = 0, sum_tt = 0;  ///< for the slope of f [s] since the first block
    Eigen::Vector3d sum_tf_T = sum_w_T;
    double md_begin = 0;
    bool md_known = true, gz = true, mag = true, saturated = false;
  };

  std::optional<StillWindow> PushAnew(const ImuSample& sample, const AlongHole& along);
  bool Continues(const SampleStamp& stamp) const;
  bool InBlock(ToolTime time) const;
  std::optional<StillWindow> EndBlock(const SampleStamp& next);
  double SpeedLimit(double sigma_speed) const;
  double TravelLimit(double sigma_speed) const;
  void Add(const ImuSample& sample, const AlongHole& along);
  std::optional<StillWindow> CloseBlock();
  bool StillAlone(const Means& block) const;
  bool StillTogether(const Means& block) const;
  bool Creeps() const;
  double SlopeOfForce(int axis) const;
  double VarianceOfSlope(int axis) const;
  void TakeRoll(StillWindow& window) const;
  void Average(const Means& block);
  std::optional<StillWindow> EndStretch(Quality quality);
  StillWindow Window(Quality quality) const;

  StillSetup setup_;
  std::optional<std::int32_t> index_position_;
  std::optional<SampleStamp> previous_;  ///< the block's last
  Block block_;                          ///< without samples: none
  Means pending_;         ///< newest still block, averaged when the next one is still too; or none
  bool guarded_ = false;  ///< the stretch's first block has been left out
  Stretch stretch_;
  bool sliding_ = false;  ///< the last sample was above the speed limit
};

}  // namespace wellgyro
