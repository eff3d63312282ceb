#include "wellgyro/alignment/still_detector.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "wellgyro/base/units.h"
#include "wellgyro/earth/earth.h"

namespace wellgyro {
namespace {

using Eigen::Vector3d;

// A block, at 10 Hz of ten samples, whose scatter they tell to 1 / sqrt(18) = 24 %.
constexpr std::int64_t kBlockNs = 1'000'000'000;
// Sigmas, P(|x| > 5) = 5.7e-7: of five axes one good block in four days is refused.
constexpr double kGate = 5;
// Of the depth's speed, P(|x| > 4) = 6.3e-5: a block in a hundred stops of 160 s.
constexpr double kSpeedSigmas = 4;
// [s], sigma of a DepthTrack's depth by noise over that of its speed: 0.48 from 10 Hz on, 0.3 to
// 0.62 at 1.3 Hz, by its quadratic of weights 1 - u^2 from 2 s before to 0.8 s after.
constexpr double kDepthBySpeed = 0.5;
// [s] of either end of a stop that may stay out of the means: a block that is cut short, one that
// is left out (guarded_, pending_), and as much again while the string settles.
constexpr double kRagged = 4;
// From which on a slope is told: over n blocks to sqrt(12 / n) of a block's sigma.
constexpr double kCreepBlocks = 10;
// Floors: what a tool hanging in a live hole does, and sensors worse than they are stated.
// Scatter of one sample: gyros of 0.05 deg/sqrt(h) and accelerometers of 2e-4 m/s^2/sqrt(Hz) have
// 0.008 deg/s and 0.002 m/s^2 at 100 Hz. A swing by 0.03 deg at 0.5 Hz has 0.1 deg/s at its peak.
constexpr double kScatterRate = 0.1 * units::kDeg;
constexpr double kScatterForce = 0.05;  // [m/s^2]
// Mean rate beyond the Earth's, beside what is stated of biases: a thousandth of a roll at 1 rpm.
constexpr double kMeanRate = 20 * units::kDegPerHour;
// Block against stretch: a third of what 0.05 deg/sqrt(h) scatter from second to second.
constexpr double kChangeRate = units::kDegPerHour;
constexpr double kChangeForce = 1e-3;  // likewise [m/s^2], 0.006 deg of tilt
// Rotation of gravity in the tool: as a rate error 0.38 deg of azimuth at the equator, 0.76 at 60.
constexpr double kCreep = 0.1 * units::kDegPerHour;

std::int64_t BlockOf(ToolTime time) {
  const std::int64_t block = time.ns / kBlockNs;
  return block * kBlockNs > time.ns ? block - 1 : block;
}

// Variance of a mean over `seconds`, by the coefficients [rad^2/s^2].
double RateVariance(const NoiseCoefficients& gyro, double seconds) {
  const double n = gyro.angle_random_walk, q = gyro.quantization / seconds;
  return n * n / seconds + 2 * q * q;
}

double ForceVariance(const ErrorPriors& errors, double seconds) {
  return errors.accel_noise * errors.accel_noise / seconds;
}

// Variance of a block's mean: as the coefficients say, or as its samples scatter if that is more.
// One or two samples say nothing of their scatter.
double BlockVariance(double model, double scatter, double samples, double floor) {
  if (samples < 3) return model > 0 ? model : floor * floor;
  return std::max(model, scatter / samples);
}

// Samples that begin on whole seconds fall on either side of them by a clock's jitter, so half a
// period is not missed; that none between is missing their numbers say.
bool Whole(std::int64_t index, const SampleStamp& first, const SampleStamp& last) {
  const std::int64_t begin = index * kBlockNs;
  return 2 * (first.tool_time.ns - begin) < 3 * static_cast<std::int64_t>(first.period_ns) &&
         2 * (begin + kBlockNs - last.tool_time.ns) < 3 * static_cast<std::int64_t>(last.period_ns);
}

// Sigma of a mean over blocks: by the coefficients unless the blocks scatter beyond four sigmas of
// what these allow, or there are none.
double SigmaOfMean(double model, double block_model, double square, double blocks) {
  if (blocks < 2) return std::sqrt(model);
  const double scatter = square / (blocks - 1);
  const bool explained = scatter <= block_model * (1 + 4 * std::sqrt(2 / (blocks - 1)));
  return std::sqrt(explained ? model : std::max(model, scatter / blocks));
}

}  // namespace

StillDetector::StillDetector(const StillSetup& setup) : setup_(setup) {
  const auto require = [](bool good, const char* what) {
    if (!good) throw std::invalid_argument(std::string("StillDetector: ") + what);
  };
  require(setup.min_still > Duration::Seconds(2), "min_still must be above 2 s");
  require(setup.speed_limit > 0, "speed_limit must be positive");
  require(setup.travel_limit > 0, "travel_limit must be positive");
  require(setup.gyro.angle_random_walk >= 0, "gyro.angle_random_walk must not be negative");
  require(setup.gyro.quantization >= 0, "gyro.quantization must not be negative");
  require(setup.errors.accel_noise >= 0, "errors.accel_noise must not be negative");
  require(setup.errors.gyro_bias_sigma >= 0, "errors.gyro_bias_sigma must not be negative");
}

inline bool StillDetector::Continues(const SampleStamp& stamp) const {
  if (!previous_ || stamp.session != previous_->session || stamp.seq != previous_->seq + 1 ||
      stamp.period_ns != previous_->period_ns) {
    return false;
  }
  const std::int64_t late = stamp.tool_time.ns - previous_->tool_time.ns - stamp.period_ns;
  return 2 * std::abs(late) <= stamp.period_ns;
}

std::optional<StillWindow> StillDetector::Push(const ImuSample& sample, const AlongHole& along) {
  const SampleStamp& stamp = sample.stamp;
  if (block_.samples == 0 || !Continues(stamp) || !InBlock(stamp.tool_time)) {
    return PushAnew(sample, along);
  }
  Add(sample, along);
  return std::nullopt;
}

/// A sample that is not the next of the block.
std::optional<StillWindow> StillDetector::PushAnew(const ImuSample& sample,
                                                   const AlongHole& along) {
  const SampleStamp& stamp = sample.stamp;
  if (previous_ && stamp.session == previous_->session && stamp.seq <= previous_->seq) {
    return std::nullopt;
  }
  std::optional<StillWindow> window = EndBlock(stamp);
  block_ = Block{};
  block_.index = BlockOf(stamp.tool_time);
  block_.first = stamp;
  block_.w0_T = sample.w_IT_T;
  block_.f0_T = sample.f_T;
  Add(sample, along);
  return window;
}

inline bool StillDetector::InBlock(ToolTime time) const {
  const std::int64_t begin = block_.index * kBlockNs;
  return time.ns >= begin && time.ns - begin < kBlockNs;
}

/// Before a sample that is not the block's.
std::optional<StillWindow> StillDetector::EndBlock(const SampleStamp& next) {
  if (block_.samples == 0) return std::nullopt;
  std::optional<StillWindow> window = CloseBlock();
  if (Continues(next)) return window;
  // The gap may lie exactly at the end of a block, which is then whole and counts.
  std::optional<StillWindow> rest = EndStretch(Quality::kGood);
  return rest ? rest : window;
}

/// A depth that does not know its speed so well cannot tell motion from its own noise.
inline double StillDetector::SpeedLimit(double sigma_speed) const {
  return std::max(setup_.speed_limit, kSpeedSigmas * sigma_speed);
}

/// Of two depths that err by themselves.
double StillDetector::TravelLimit(double sigma_speed) const {
  return std::max(setup_.travel_limit, kSpeedSigmas * std::sqrt(2.0) * kDepthBySpeed * sigma_speed);
}

inline void StillDetector::Add(const ImuSample& sample, const AlongHole& along) {
  Block& block = block_;
  ++block.samples;
  const Vector3d w = sample.w_IT_T - block.w0_T;
  const Vector3d f = sample.f_T - block.f0_T;
  block.sum_w_T += w;
  block.sum_f_T += f;
  if (sample.has_mag) block.sum_b_T += sample.b_T;
  block.square_w += w.cwiseAbs2();
  block.square_f += f.cwiseAbs2();
  block.sum_temperature += static_cast<double>(sample.stamp.temperature);
  block.gz &= sample.has_gz;
  block.mag &= sample.has_mag;
  block.saturated |= sample.stamp.gyro_saturated | sample.stamp.accel_saturated;
  previous_ = sample.stamp;
  sliding_ = along.known && std::abs(along.speed) > SpeedLimit(along.sigma_speed);
  if (!along.known) return;
  ++block.depths;
  block.sum_md += along.md;
  block.sum_speed += std::abs(along.speed);
  block.sum_sigma_speed += along.sigma_speed;
}

std::size_t StillDetector::Room(const SampleStamp& next) const {
  if (block_.samples == 0 || !Continues(next) || !InBlock(next.tool_time)) return 0;
  const std::int64_t left = (block_.index + 1) * kBlockNs - next.tool_time.ns;
  return static_cast<std::size_t>((left - 1) / next.period_ns + 1);
}

void StillDetector::Append(const SampleBlock& samples, const AlongHoleBlock& along,
                           std::size_t at) {
  using Sums = Eigen::Array<double, 6, 1>;
  const auto n = static_cast<Eigen::Index>(samples.size()), from = static_cast<Eigen::Index>(at);
  Block& block = block_;
  Sums first, sum, square;
  first << block.w0_T, block.f0_T;
  sum << block.sum_w_T, block.sum_f_T;
  square << block.square_w, block.square_f;
  for (const SixAxes& axes : samples.axes) {
    const Sums from_first = axes - first;
    sum += from_first;
    square += from_first.square();
  }
  block.sum_w_T = sum.head<3>();
  block.sum_f_T = sum.tail<3>();
  block.square_w = square.head<3>();
  block.square_f = square.tail<3>();
  const SampleStamp& stamp = samples.first();
  const ImuSample& like = samples.samples.front();
  if (like.has_mag) {
    for (const ImuSample& sample : samples.samples) block.sum_b_T += sample.b_T;
  }
  const auto temperature = static_cast<double>(stamp.temperature);
  Eigen::Array4d others(block.sum_temperature, block.sum_md, block.sum_speed,
                        block.sum_sigma_speed);
  for (Eigen::Index i = from; i < from + n; ++i) {
    others +=
        Eigen::Array4d(temperature, along.md[i], std::abs(along.speed[i]), along.sigma_speed[i]);
  }
  block.sum_temperature = others[0];
  block.sum_md = others[1];
  block.sum_speed = others[2];
  block.sum_sigma_speed = others[3];
  block.samples += n;
  block.depths += n;
  block.gz &= like.has_gz;
  block.mag &= like.has_mag;
  block.saturated |= stamp.gyro_saturated | stamp.accel_saturated;
  previous_ = samples.last();
  const Eigen::Index last = from + n - 1;
  sliding_ = std::abs(along.speed[last]) > SpeedLimit(along.sigma_speed[last]);
}

/// Judges the finished block; returns the window that its motion ends.
std::optional<StillWindow> StillDetector::CloseBlock() {
  const Block& block = block_;
  if (!Whole(block.index, block.first, *previous_)) return EndStretch(Quality::kGood);
  const double n = static_cast<double>(block.samples);
  const double depths = static_cast<double>(std::max<std::int64_t>(block.depths, 1));
  const double free = std::max(n - 1, 1.0);
  const Means means{.first = block.first,
                    .last = *previous_,
                    .samples = block.samples,
                    .w_T = block.w0_T + block.sum_w_T / n,
                    .f_T = block.f0_T + block.sum_f_T / n,
                    .b_T = block.sum_b_T / n,
                    .var_w = (block.square_w - block.sum_w_T.cwiseAbs2() / n) / free,
                    .var_f = (block.square_f - block.sum_f_T.cwiseAbs2() / n) / free,
                    .temperature = block.sum_temperature / n,
                    .md = block.sum_md / depths,
                    .speed = block.sum_speed / depths,
                    .sigma_speed = block.sum_sigma_speed / depths,
                    .md_known = block.depths == block.samples,
                    .gz = block.gz,
                    .mag = block.mag,
                    .saturated = block.saturated};
  if (!StillAlone(means)) return EndStretch(Quality::kGood);
  std::optional<StillWindow> window;
  if (pending_.samples > 0 && !StillTogether(means)) {
    window = EndStretch(Quality::kGood);
  } else if (pending_.samples > 0) {
    if (guarded_) Average(pending_);
    guarded_ = true;
    if (Creeps()) window = EndStretch(Quality::kMoved);
  }
  pending_ = means;
  return window;
}

bool StillDetector::StillAlone(const Means& block) const {
  if (block.speed > SpeedLimit(block.sigma_speed)) return false;
  const double period = static_cast<double>(block.first.period_ns) * 1e-9;
  const double n = static_cast<double>(block.samples);
  const double rate_model = RateVariance(setup_.gyro, period);
  const double rate_scatter = 9 * rate_model + kScatterRate * kScatterRate;
  const double force_scatter =
      9 * ForceVariance(setup_.errors, period) + kScatterForce * kScatterForce;
  const int axes = block.gz ? 3 : 2;
  if (block.var_w.head(axes).maxCoeff() > rate_scatter || block.var_f.maxCoeff() > force_scatter) {
    return false;
  }
  const ErrorPriors& errors = setup_.errors;
  const double bias = std::hypot(errors.gyro_bias_sigma, setup_.gyro.bias_instability) +
                      (errors.mass_unbalance_sigma + errors.quadrature_sigma) * block.f_T.norm();
  const double noise =
      BlockVariance(rate_model / n, block.var_w.head(axes).maxCoeff(), n, kScatterRate);
  const double limit = kEarthRate + kMeanRate + kGate * (bias + std::sqrt(noise));
  return block.w_T.head(axes).norm() <= limit;
}

/// Against the means of the stretch, or of its first block while that is all there is.
bool StillDetector::StillTogether(const Means& block) const {
  const bool young = stretch_.blocks == 0;
  const double n = young ? 1 : static_cast<double>(stretch_.blocks);
  const Vector3d& w = young ? pending_.w_T : stretch_.mean_w_T;
  const Vector3d& f = young ? pending_.f_T : stretch_.mean_f_T;
  const Vector3d var_w = ((young ? pending_.var_w : stretch_.sum_var_w) + block.var_w) / (n + 1);
  const Vector3d var_f = ((young ? pending_.var_f : stretch_.sum_var_f) + block.var_f) / (n + 1);
  const double seconds = block.seconds();
  const double samples = static_cast<double>(block.samples);
  const auto agree = [&](double a, double b, double model, double scatter, double floor,
                         double change) {
    const double variance = BlockVariance(model, scatter, samples, floor);
    return std::abs(a - b) <= kGate * std::sqrt(variance * (1 + 1 / n)) + change;
  };
  for (int i = 0; i < 3; ++i) {
    if (!agree(block.f_T[i], f[i], ForceVariance(setup_.errors, seconds), var_f[i], kScatterForce,
               kChangeForce)) {
      return false;
    }
    if (i == 2 && !block.gz) break;
    if (!agree(block.w_T[i], w[i], RateVariance(setup_.gyro, seconds), var_w[i], kScatterRate,
               kChangeRate)) {
      return false;
    }
  }
  return !(block.md_known && stretch_.md_known && !young &&
           std::abs(block.md - stretch_.md_begin) > TravelLimit(block.sigma_speed));
}

/// A slope of the specific force over the stretch, too much for the accelerometers' noise: gravity
/// turns in the tool.
bool StillDetector::Creeps() const {
  if (static_cast<double>(stretch_.blocks) < kCreepBlocks) return false;
  for (int i = 0; i < 3; ++i) {
    const double limit = kGate * std::sqrt(VarianceOfSlope(i)) + kCreep * stretch_.mean_f_T.norm();
    if (std::abs(SlopeOfForce(i)) > limit) return true;
  }
  return false;
}

/// Of the line fitted to the blocks' means [m/s^3].
double StillDetector::SlopeOfForce(int axis) const {
  const Stretch& s = stretch_;
  const double n = static_cast<double>(s.blocks);
  return (s.sum_tf_T[axis] - s.sum_t * s.mean_f_T[axis]) / (s.sum_tt - s.sum_t * s.sum_t / n);
}

double StillDetector::VarianceOfSlope(int axis) const {
  const Stretch& s = stretch_;
  const double n = static_cast<double>(s.blocks);
  const double seconds = static_cast<double>(s.samples * s.first.period_ns) * 1e-9;
  const double variance =
      BlockVariance(ForceVariance(setup_.errors, seconds / n), s.sum_var_f[axis] / n,
                    static_cast<double>(s.samples) / n, kScatterForce);
  return variance / (s.sum_tt - s.sum_t * s.sum_t / n);
}

/// How fast gravity turns about the tool's axis. fx + i fy = g sin I e^{-iT}.
void StillDetector::TakeRoll(StillWindow& window) const {
  const double across = stretch_.mean_f_T.head<2>().squaredNorm();
  if (static_cast<double>(stretch_.blocks) < kCreepBlocks || !(across > 0)) return;
  const double fx = stretch_.mean_f_T.x(), fy = stretch_.mean_f_T.y();
  window.roll_rate = (fy * SlopeOfForce(0) - fx * SlopeOfForce(1)) / across;
  window.sigma_roll_rate =
      std::sqrt(fy * fy * VarianceOfSlope(0) + fx * fx * VarianceOfSlope(1)) / across;
}

void StillDetector::Average(const Means& block) {
  Stretch& s = stretch_;
  if (s.blocks == 0) {
    s.first = block.first;
    s.md_begin = block.md;
  }
  s.last = block.last;
  ++s.blocks;
  s.samples += block.samples;
  const double n = static_cast<double>(s.blocks);
  const double samples = static_cast<double>(block.samples);
  s.sum_w_T += samples * block.w_T;
  s.sum_f_T += samples * block.f_T;
  s.sum_b_T += samples * block.b_T;
  s.sum_temperature += samples * block.temperature;
  s.sum_md += samples * block.md;
  const Vector3d dw = block.w_T - s.mean_w_T, df = block.f_T - s.mean_f_T;
  s.mean_w_T += dw / n;
  s.mean_f_T += df / n;
  s.square_w += dw.cwiseProduct(block.w_T - s.mean_w_T);
  s.square_f += df.cwiseProduct(block.f_T - s.mean_f_T);
  s.sum_var_w += block.var_w;
  s.sum_var_f += block.var_f;
  const double t = (block.first.tool_time - s.first.tool_time).seconds();
  s.sum_t += t;
  s.sum_tt += t * t;
  s.sum_tf_T += t * block.f_T;
  s.md_known = s.md_known && block.md_known;
  s.gz = s.gz && block.gz;
  s.mag = s.mag && block.mag;
  s.saturated = s.saturated || block.saturated;
}

std::optional<StillWindow> StillDetector::EndStretch(Quality quality) {
  std::optional<StillWindow> window;
  const double least = setup_.min_still.seconds();
  if (stretch_.blocks > 0) {
    window = Window(quality);
    if (window->seconds() < std::max(least - 2 * kRagged, least / 2)) window.reset();
  }
  stretch_ = Stretch{};
  pending_ = Means{};
  guarded_ = false;
  return window;
}

StillWindow StillDetector::Window(Quality quality) const {
  const Stretch& s = stretch_;
  const double n = static_cast<double>(s.samples), blocks = static_cast<double>(s.blocks);
  const Duration period{s.last.period_ns};
  StillWindow window;
  window.begin = s.first.tool_time;
  window.end = s.last.tool_time + period;
  window.utc_begin = s.first.utc;
  window.utc_end = s.last.utc + period;
  window.seq_begin = s.first.seq;
  window.seq_end = s.last.seq + 1;
  window.session = s.first.session;
  window.run = s.first.run;
  window.tool = s.first.tool;
  window.samples = s.samples;
  window.w_IT_T = s.sum_w_T / n;
  window.f_T = s.sum_f_T / n;
  if (s.mag) window.b_T = s.sum_b_T / n;
  window.has_gz = s.gz;
  window.has_mag = s.mag;
  window.index_position = index_position_;
  if (s.md_known) window.md = s.sum_md / n;
  window.temperature = s.sum_temperature / n;
  window.quality = quality | (s.saturated ? Quality::kSaturated : Quality::kGood);
  const double seconds = window.seconds(), block = seconds / blocks;
  const double rate = RateVariance(setup_.gyro, seconds), rate1 = RateVariance(setup_.gyro, block);
  const double force = ForceVariance(setup_.errors, seconds);
  for (int i = 0; i < 3; ++i) {
    window.sigma_w_IT_T[i] = SigmaOfMean(rate, rate1, s.square_w[i], blocks);
    window.sigma_f_T[i] = SigmaOfMean(force, force * blocks, s.square_f[i], blocks);
  }
  if (!s.gz) window.w_IT_T[2] = window.sigma_w_IT_T[2] = 0;
  TakeRoll(window);
  return window;
}

std::optional<StillWindow> StillDetector::Cut(std::optional<std::int32_t> index_position) {
  std::optional<StillWindow> window = Flush();
  index_position_ = index_position;
  return window;
}

std::optional<StillWindow> StillDetector::Flush() {
  if (block_.samples == 0) return EndStretch(Quality::kGood);
  std::optional<StillWindow> window = CloseBlock();
  auto rest = EndStretch(Quality::kGood);
  block_ = Block{};
  return rest ? rest : window;
}

std::optional<StillWindow> StillDetector::OpenWindow() const {
  if (stretch_.blocks == 0) return std::nullopt;
  return Window(Quality::kGood);
}

}  // namespace wellgyro
