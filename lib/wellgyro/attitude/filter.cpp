#include "wellgyro/attitude/filter.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "wellgyro/attitude/filter_core_internal.h"
#include "wellgyro/base/angle.h"

namespace wellgyro {
namespace {

constexpr Duration kClockGrain{1000};  // knots and windows cut at the same sample
constexpr double kBranchMargin = 9;    // chi-square by which one branch must beat the other
constexpr double kVagueVariance = 1;   // of a fix that is no place to start from [rad^2]
constexpr std::size_t kSnapshotsMax = 256;

void RequireNotNegative(const char* name, double value) {
  if (std::isfinite(value) && value >= 0) return;
  throw std::invalid_argument(std::string("FilterSetup: ") + name + " is " + std::to_string(value));
}

void Validate(const FilterSetup& s) {
  const NoiseCoefficients& n = s.gyro;
  const ErrorPriors& e = s.errors;
  const std::pair<const char*, double> numbers[] = {
      {"gyro.quantization", n.quantization},
      {"gyro.angle_random_walk", n.angle_random_walk},
      {"gyro.bias_instability", n.bias_instability},
      {"gyro.rate_random_walk", n.rate_random_walk},
      {"gyro.rate_ramp", n.rate_ramp},
      {"gyro.bias_instability_correlation_time",
       n.bias_instability_correlation_time.value_or(1) > 0
           ? n.bias_instability_correlation_time.value_or(1)
           : -1},
      {"errors.gyro_bias_sigma", e.gyro_bias_sigma},
      {"errors.mass_unbalance_sigma", e.mass_unbalance_sigma},
      {"errors.quadrature_sigma", e.quadrature_sigma},
      {"errors.gyro_scale_sigma", e.gyro_scale_sigma},
      {"errors.gyro_misalignment_sigma", e.gyro_misalignment_sigma},
      {"errors.accel_bias_sigma", e.accel_bias_sigma},
      {"errors.roll_offset_sigma", e.roll_offset_sigma},
      {"errors.time_skew_sigma", e.time_skew_sigma},
      {"errors.latitude_sigma", e.latitude_sigma},
      {"start_sigma", s.start_sigma},
      {"start_azimuth", std::abs(s.start_azimuth.value_or(0))},
      {"site.latitude", std::abs(s.site.latitude)},
      {"site.height", std::abs(s.site.height)},
  };
  for (const auto& [name, value] : numbers) RequireNotNegative(name, value);
  if (!(s.site.radius_north > 0 && s.site.radius_east > 0 && s.site.gravity > 0)) {
    throw std::invalid_argument("FilterSetup: site has no radii or gravity; use SiteAt()");
  }
}

ToolTime BeginOf(const Knot& knot) { return knot.time - Duration::Seconds(knot.seconds); }

// A still knot that lies in the fix's window: what the fix rests on.
bool Serves(const Knot& knot, const NorthFix& fix) {
  return knot.still && knot.seconds > 0 && knot.gap_seconds <= 0 &&
         !Has(knot.quality, Quality::kVertical) && !knot.vertical && !knot.axial &&
         fix.begin <= BeginOf(knot) + kClockGrain && knot.time <= fix.end + kClockGrain;
}

// At rest the toolface stands: that it seems to change is noise, and of an error that goes by its
// change many such knots would learn what they do not hold.
void ForgetRoll(Knot* knot) {
  for (const Knot::Source source : {Knot::kMisalignmentX, Knot::kMisalignmentY, Knot::kTimeSkew}) {
    knot->d_turn[source] = knot->d_lift[source] = 0;
  }
}

// A fix as the filter holds an axial knot: by the sum of azimuth and toolface, which is regular.
void TakeSum(const Knot& knot, NorthFix* fix) {
  const double shift = WrapPi(fix->toolface - knot.toolface);
  const Eigen::Matrix3d& cov = fix->cov_attitude;
  fix->cov_attitude(1, 1) = cov(1, 1) + cov(2, 2) + 2 * cov(1, 2);
  fix->azimuth += shift;
  if (fix->mirror_azimuth) *fix->mirror_azimuth += shift;
}

// Whether the second order of the rates at rest counts against the first, over this spread.
bool Bends(double azimuth, double inclination, double variance) {
  const double slope = std::hypot(std::cos(azimuth), std::sin(azimuth) / std::tan(inclination));
  return 3 * variance > slope * slope;
}

// Where the rates are made linear, the azimuth before being known by `variance`. Near east-west and
// horizontal they bend, so that the place matters, and going on from there to where the window
// itself leads would pick one of two mirrors that have run into one. Their second order is one and
// the same error in all `others` that bent before: it leaves an azimuth that rests on them as vague
// as each says, and all count as little more than one.
void TakePoint(double before, double variance, std::ptrdiff_t others, FilterFix* f) {
  const double given = f->fix.cov_attitude(1, 1);
  const bool known = variance < kUnknownAngleVariance;
  const double weight = known ? variance / (variance + given) : 1;
  f->about = known ? before + weight * WrapPi(f->azimuth - before) : f->azimuth;
  f->var_about = weight * given;
  f->steady = f->rates && Bends(f->azimuth, f->fix.inclination, given);
  if (!f->steady) return;
  f->seconds *= static_cast<double>((others + 1) * (others + 1));
  if (!known) return;
  f->about = before;
  f->var_about = others > 0 ? std::max(variance, given) : variance;
}

double ChiSquare(double azimuth, double predicted, double variance) {
  const double d = WrapPi(azimuth - predicted);
  return variance > 0 ? d * d / variance : 0;
}

}  // namespace

struct AzimuthFilter::Impl {
  struct Snapshot {
    std::size_t epochs;  // worked before it was taken
    FilterCore core;
  };

  explicit Impl(const FilterSetup& setup) : core(setup) { history.setup = setup; }

  void Work(std::size_t i);
  void TakePlainFixes(std::size_t worked, double growth, const FilterPlace& place);
  void FitRates(std::size_t from, FilterFix* f);
  double PointOf(const FilterFix& f) const;
  void TakeStill(std::size_t i);
  void TakeAzimuth(double azimuth, double variance);
  void Observe(const Knot& knot);
  void Station(std::size_t i);
  void Remember(std::size_t epochs);
  void WorkStretchAgain();
  void Rewind(std::size_t epochs);
  void Locate(FilterFix* f) const;
  // A plain fix enters when its epoch is worked, one at the start before all of them.
  static std::size_t FirstToWork(const FilterFix& f) {
    return f.rates || f.epoch_end == 0 ? f.epoch_begin : f.epoch_end - 1;
  }
  void ChooseBranch(FilterFix* f, double azimuth, double variance) const;

  FilterHistory history;
  FilterCore core;
  AttitudeSample attitude;
  std::vector<StationState> stations;
  std::vector<Snapshot> snapshots;
};

void AzimuthFilter::Impl::Remember(std::size_t epochs) {
  if (!snapshots.empty() && snapshots.back().epochs == epochs) snapshots.pop_back();
  if (snapshots.size() >= kSnapshotsMax) {  // thin out; the first stays
    std::size_t kept = 0;
    for (std::size_t i = 0; i < snapshots.size(); i += 2) snapshots[kept++] = snapshots[i];
    snapshots.erase(snapshots.begin() + static_cast<std::ptrdiff_t>(kept), snapshots.end());
  }
  snapshots.push_back({epochs, core});
}

// Back to the state after the first `epochs` epochs.
void AzimuthFilter::Impl::Rewind(std::size_t epochs) {
  while (!snapshots.empty() && snapshots.back().epochs > epochs) snapshots.pop_back();
  std::size_t at = 0;
  if (snapshots.empty()) {
    core = FilterCore(history.setup);
    TakePlainFixes(0, 0, core.place());
  } else {
    core = snapshots.back().core;
    at = snapshots.back().epochs;
  }
  while (!stations.empty() && stations.back().epoch >= at) stations.pop_back();
  for (; at < epochs; ++at) Work(at);
}

void AzimuthFilter::Impl::TakeAzimuth(double azimuth, double variance) {
  if (core.azimuth_diffuse()) core.SetAzimuth(azimuth);
  FilterMeasurement m = core.OfAzimuth(core.azimuth() + WrapPi(azimuth - core.azimuth()), variance);
  core.Take(&m);
}

// The fixes that enter as azimuths once `worked` epochs are worked; 0: before the first knot.
void AzimuthFilter::Impl::TakePlainFixes(std::size_t worked, double growth,
                                         const FilterPlace& place) {
  for (const FilterFix& f : history.fixes) {
    const bool used = f.use == FixUse::kUsed || f.use == FixUse::kMirror;
    if (!used || f.rates || f.epoch_end != worked) continue;
    double since = 0;
    if (worked > 0) {
      const Knot& knot = history.epochs[worked - 1].knot;
      // From an unknown azimuth the Earth's share of the growth was anything.
      if (core.azimuth_diffuse() && !knot.still && !knot.vertical) {
        growth = GrowthOver(knot, place, history.setup.site, f.azimuth, false).growth;
      }
      since = GrowthSince(knot, f.fix, growth);
    }
    TakeAzimuth(f.azimuth + since, f.fix.cov_attitude(1, 1));
  }
}

// `about`, counted through the same whole turns as the azimuth before the window.
double AzimuthFilter::Impl::PointOf(const FilterFix& f) const {
  double before = f.about;
  if (f.epoch_begin > 0 && history.epochs[f.epoch_begin - 1].azimuth_known) {
    before = history.epochs[f.epoch_begin - 1].azimuth;
  } else if (f.epoch_begin == 0) {
    before = history.setup.start_azimuth.value_or(before);
  }
  return before + WrapPi(f.about - before);
}

void AzimuthFilter::Impl::TakeStill(std::size_t i) {
  const FilterEpoch& epoch = history.epochs[i];
  const FilterFix& fix = history.fixes[static_cast<std::size_t>(epoch.fix)];
  // Every knot of a window is made linear about the same azimuth, so that together they weigh as
  // one measurement.
  const double about = PointOf(fix);
  if (core.azimuth_diffuse() && i == fix.epoch_begin) core.SetAzimuth(about);
  StillMeasurements m = core.AtRest(epoch.knot, {about, fix.var_about, fix.seconds});
  core.Take(&m.turn);
  core.Take(&m.lift);
  if (fix.var_hold > 0 && i + 1 == fix.epoch_end) {
    FilterMeasurement hold = core.OfAzimuth(about + fix.hold - fix.about, fix.var_hold);
    core.Take(&hold);
  }
}

// Makes the rates linear about what the window itself gives, as in an iterated Kalman filter. Where
// they bend and nothing was known, they leave less than the fix says, which holds the difference.
void AzimuthFilter::Impl::FitRates(std::size_t from, FilterFix* f) {
  if (f->steady && !core.azimuth_diffuse()) return;
  for (int pass = 0; pass < 2; ++pass) {
    for (std::size_t i = from; i < f->epoch_end; ++i) Work(i);
    const double azimuth = core.azimuth(), variance = core.covariance()(0, 0);
    Rewind(from);
    if (f->steady) {
      const double given = f->fix.cov_attitude(1, 1);
      if (!(given < variance)) return;
      f->var_hold = 1 / (1 / given - 1 / variance);
      f->hold = f->about + (f->about - azimuth) * f->var_hold / variance;
      return;
    }
    f->about = azimuth;
  }
}

void AzimuthFilter::Impl::Observe(const Knot& knot) {
  const AttitudeRows rows = RowsOf(core.layout(), knot, history.setup.site.gravity);
  attitude = AttitudeOf(knot, rows * core.state(),
                        rows * core.shown_covariance() * rows.transpose(), history.setup.gyro);
}

void AzimuthFilter::Impl::Work(std::size_t i) {
  FilterEpoch& epoch = history.epochs[i];
  const Knot& knot = epoch.knot;
  const bool stops = knot.still && (i == 0 || !history.epochs[i - 1].knot.still);
  if (stops || i == 0) Remember(i);
  const double before = core.azimuth();
  const FilterPlace place = core.place();
  core.Step(knot, before, std::nullopt);
  if (auto level = core.Level(knot)) core.Take(&*level);
  if (epoch.fix >= 0) TakeStill(i);
  TakePlainFixes(i + 1, core.azimuth() - before, place);
  epoch.azimuth = core.azimuth();
  epoch.azimuth_known = core.azimuth_known();
  epoch.sigma_azimuth = std::sqrt(std::min(core.variance(), kUnknownAngleVariance));
  Observe(knot);
  if (epoch.station) Station(i);
}

void AzimuthFilter::Impl::Station(std::size_t i) {
  const Knot& knot = history.epochs[i].knot;
  stations.push_back(StationOf(i, knot, attitude,
                               RowsOf(core.layout(), knot, history.setup.site.gravity),
                               core.shown_covariance(), core.cross(), history.setup.gyro));
  core.BeginStation();
  Remember(i + 1);
}

// Which epochs a fix concerns, and whether it enters by rates.
void AzimuthFilter::Impl::Locate(FilterFix* f) const {
  const auto& epochs = history.epochs;
  const NorthFix& fix = f->fix;
  f->use = FixUse::kUsed;
  const auto ends_before = [](const FilterEpoch& e, ToolTime t) { return e.knot.time < t; };
  const auto at = static_cast<std::size_t>(
      std::lower_bound(epochs.begin(), epochs.end(), fix.end - kClockGrain, ends_before) -
      epochs.begin());
  if (!fix.external && fix.from_samples) {
    double covered = 0;
    std::size_t begin = epochs.size(), end = 0;
    for (std::size_t i = std::min(at + 1, epochs.size());
         i-- > 0 && fix.begin < epochs[i].knot.time;) {
      if (!Serves(epochs[i].knot, fix)) continue;
      covered += epochs[i].knot.seconds;
      begin = i;
      end = std::max(end, i + 1);
    }
    if (covered > 0 && covered >= 0.5 * (fix.end - fix.begin).seconds()) {
      f->rates = true;
      f->seconds = covered;
      f->epoch_begin = begin;
      f->epoch_end = end;
      return;
    }
  }
  if (epochs.empty() || fix.end <= BeginOf(epochs.front().knot) + kClockGrain) return;  // start
  std::size_t last = at;
  if (at == epochs.size()) {  // beyond the last knot: the same direction only if at rest since
    if (!epochs.back().knot.still || epochs.back().knot.time < fix.begin) {
      f->use = FixUse::kNoKnot;
      return;
    }
    last = epochs.size() - 1;
  }
  f->epoch_begin = last;
  f->epoch_end = last + 1;
  if (!fix.external && epochs[last].knot.axial) TakeSum(epochs[last].knot, &f->fix);
}

void AzimuthFilter::Impl::ChooseBranch(FilterFix* f, double azimuth, double variance) const {
  const NorthFix& fix = f->fix;
  f->azimuth = fix.azimuth;
  const bool known = variance < kUnknownAngleVariance;
  if (!known) {
    const bool mirrored = fix.mirror_azimuth && fix.mirror_cost <= kBranchMargin;
    if (mirrored || fix.cov_attitude(1, 1) > kVagueVariance) f->use = FixUse::kAmbiguous;
    return;
  }
  const double sum = variance + fix.cov_attitude(1, 1);
  f->chi_square = ChiSquare(fix.azimuth, azimuth, sum);
  if (!fix.mirror_azimuth) return;
  const double mirror = ChiSquare(*fix.mirror_azimuth, azimuth, sum);
  const double difference = mirror + fix.mirror_cost - f->chi_square;
  if (std::abs(difference) <= kBranchMargin) f->use = FixUse::kAmbiguous;
  if (difference < -kBranchMargin) {
    f->use = FixUse::kMirror;
    f->azimuth = *fix.mirror_azimuth;
    f->chi_square = mirror;
  }
}

void TakeClosure(double azimuth, double variance, FilterFix* f) {
  if (!(variance < kUnknownAngleVariance)) return;
  f->closure = WrapPi(f->azimuth - azimuth);
  f->sigma_closure = std::sqrt(variance + f->fix.cov_attitude(1, 1));
}

// The axial knots before the last one, with what is known of their noise by now; and the last.
void AzimuthFilter::Impl::WorkStretchAgain() {
  auto& epochs = history.epochs;
  const std::size_t last = epochs.size() - 1;
  const auto knots = static_cast<std::size_t>(epochs[last].knot.axial_noise_knots);
  const std::size_t begin = last - std::min(last, knots);
  // What they cost in the end is little; on the way each azimuth was as uncertain as it was then.
  const double share = epochs[last].knot.axial_noise_share;
  double counted = 0;
  for (std::size_t i = begin; i < last; ++i) {
    Knot& knot = epochs[i].knot;
    counted += knot.toolface_noise_turn;
    knot.toolface_noise_turn *= share;
    knot.var_azimuth_beyond += (1 - share) * counted;
  }
  epochs[last].knot.axial_noise_share = 1;
  Rewind(begin);
  for (std::size_t i = begin; i < epochs.size(); ++i) Work(i);
}

AzimuthFilter::AzimuthFilter(const FilterSetup& setup) {
  Validate(setup);
  impl_ = std::make_unique<Impl>(setup);
}
AzimuthFilter::~AzimuthFilter() = default;
AzimuthFilter::AzimuthFilter(AzimuthFilter&&) noexcept = default;
AzimuthFilter& AzimuthFilter::operator=(AzimuthFilter&&) noexcept = default;

const AttitudeSample& AzimuthFilter::Step(const Knot& knot) {
  auto& epochs = impl_->history.epochs;
  if (!epochs.empty() && knot.time <= epochs.back().knot.time) {
    throw std::invalid_argument("AzimuthFilter::Step: knot.time " + std::to_string(knot.time.ns) +
                                " ns is not after the knot before");
  }
  if (!(knot.seconds >= 0)) {
    throw std::invalid_argument("AzimuthFilter::Step: knot.seconds is " +
                                std::to_string(knot.seconds));
  }
  epochs.emplace_back();
  epochs.back().knot = knot;
  if (knot.still && !knot.axial) ForgetRoll(&epochs.back().knot);
  if (knot.axial_noise_share < 1) {
    impl_->WorkStretchAgain();
  } else {
    impl_->Work(epochs.size() - 1);
  }
  return impl_->attitude;
}

FilterFix AzimuthFilter::Update(const NorthFix& fix) {
  Impl& m = *impl_;
  FilterFix f;
  f.fix = fix;
  m.Locate(&f);
  const std::size_t all = m.history.epochs.size();
  if (f.use != FixUse::kNoKnot) {
    const std::size_t from = m.FirstToWork(f);
    m.Rewind(from);
    double since = 0;
    if (!f.rates && f.epoch_end > 0) {
      const double begin = m.core.azimuth();
      m.Work(from);
      since = GrowthSince(m.history.epochs[from].knot, fix, m.core.azimuth() - begin);
    }
    const double before = m.core.azimuth() - since, variance = m.core.variance();
    m.ChooseBranch(&f, before, variance);
    TakeClosure(before, variance, &f);
    const auto others =
        std::count_if(m.history.fixes.begin(), m.history.fixes.end(),
                      [](const FilterFix& o) { return o.steady && o.use != FixUse::kAmbiguous; });
    TakePoint(before, variance, others, &f);
  }
  m.history.fixes.push_back(f);
  if (f.use == FixUse::kNoKnot) return f;
  if (f.rates && f.use != FixUse::kAmbiguous) {
    for (std::size_t i = f.epoch_begin; i < f.epoch_end; ++i) {
      FilterEpoch& e = m.history.epochs[i];
      if (Serves(e.knot, fix)) e.fix = static_cast<int>(m.history.fixes.size()) - 1;
    }
  }
  const std::size_t from = m.FirstToWork(f);
  if (f.epoch_end == 0) m.snapshots.clear();
  m.Rewind(from);
  if (f.rates && f.use != FixUse::kAmbiguous) m.FitRates(from, &m.history.fixes.back());
  for (std::size_t i = from; i < all; ++i) m.Work(i);
  return m.history.fixes.back();
}

const StationState& AzimuthFilter::MarkStation() {
  auto& epochs = impl_->history.epochs;
  if (epochs.empty()) throw std::logic_error("AzimuthFilter::MarkStation: no knot yet");
  if (!epochs.back().station) {
    epochs.back().station = true;
    impl_->Station(epochs.size() - 1);
  }
  return impl_->stations.back();
}

const AttitudeSample& AzimuthFilter::attitude() const { return impl_->attitude; }
const std::vector<StationState>& AzimuthFilter::stations() const { return impl_->stations; }
const FilterHistory& AzimuthFilter::history() const { return impl_->history; }

}  // namespace wellgyro
