#include "wellgyro/attitude/smoother.h"

#include <cmath>
#include <utility>

#include "wellgyro/attitude/filter_core_internal.h"
#include "wellgyro/base/angle.h"

namespace wellgyro {
namespace {

// What the backward sweep needs of one epoch of the forward pass.
struct Record {
  FilterTransition transition;
  AttitudeRows rows;
  AttitudeRows rows_cov;     // rows P
  Eigen::Vector3d estimate;  // rows x
  Eigen::Matrix3d cov;       // rows P rows'
  bool diffuse = false;      // so far nothing has told of the azimuth
  std::size_t measurements_end = 0;
  std::size_t stations_end = 0;
};

struct StationRecord {
  FilterMatrix cov, cross;
};

// The azimuth at the begin of epoch 0, then at the end of every epoch.
using Path = std::vector<double>;

struct ForwardPass {
  std::vector<Record> records;
  std::vector<FilterMeasurement> measurements;
  std::vector<StationRecord> stations;
  std::size_t start = 0;          // measurements before the first epoch
  double start_azimuth = 0;       // after those
  FilterVector start_covariance;  // of azimuth with all states, likewise
};

bool Used(const FilterFix& f) { return f.use == FixUse::kUsed || f.use == FixUse::kMirror; }

FilterPlace PlaceBefore(const FilterHistory& history, std::size_t i) {
  FilterPlace place;
  place.latitude = history.setup.site.latitude;
  place.height = history.setup.site.height;
  if (i > 0) {
    place.any_knot = true;
    place.inclination = history.epochs[i - 1].knot.inclination;
    place.along = history.epochs[i - 1].knot.along;
  }
  return place;
}

// The filter's path, and where it knew none, that which leads to the azimuth it then learned.
Path FirstPath(const FilterHistory& history) {
  const auto& epochs = history.epochs;
  Path path(epochs.size() + 1);
  double next = 0;     // azimuth at the end of the epoch in hand, from what comes after
  bool leads = false;  // whether there is one
  for (std::size_t i = epochs.size(); i-- > 0;) {
    const FilterEpoch& e = epochs[i];
    if (e.fix >= 0) {
      // Of a window all epochs are alike, its first ones not yet good in the filter.
      const double azimuth = history.fixes[static_cast<std::size_t>(e.fix)].about;
      next = leads ? next + WrapPi(azimuth - next) : azimuth;
    } else if (e.azimuth_known || !leads) {
      next = leads ? next + WrapPi(e.azimuth - next) : e.azimuth;
    }
    leads = leads || e.azimuth_known || e.fix >= 0;
    path[i + 1] = next;
    if (e.knot.still) {
      next -= StillGrowth(e.knot);
    } else if (!e.knot.vertical && e.knot.seconds > 0) {
      next -= GrowthOver(e.knot, PlaceBefore(history, i), history.setup.site, next, true).growth;
    }
  }
  path[0] = next;
  // State and path must count the same whole turns.
  if (history.setup.start_azimuth) {
    const double turns = std::round((*history.setup.start_azimuth - next) / kTwoPi);
    for (double& azimuth : path) azimuth += turns * kTwoPi;
  }
  return path;
}

void TakeAndKeep(FilterMeasurement m, FilterCore* core, ForwardPass* pass) {
  core->Take(&m);
  pass->measurements.push_back(std::move(m));
}

void TakePlainFixes(const FilterHistory& history, std::size_t worked, double growth,
                    FilterCore* core, ForwardPass* pass) {
  for (const FilterFix& f : history.fixes) {
    if (!Used(f) || f.rates || f.epoch_end != worked) continue;
    const double since =
        worked > 0 ? GrowthSince(history.epochs[worked - 1].knot, f.fix, growth) : 0;
    const double azimuth = core->azimuth() + WrapPi(f.azimuth + since - core->azimuth());
    TakeAndKeep(core->OfAzimuth(azimuth, f.fix.cov_attitude(1, 1)), core, pass);
  }
}

ForwardPass Forward(const FilterHistory& history, const Path& path) {
  ForwardPass pass;
  FilterCore core(history.setup);
  if (!history.setup.start_azimuth) core.SetAzimuth(path[0]);
  TakePlainFixes(history, 0, 0, &core, &pass);
  pass.start = pass.measurements.size();
  pass.start_azimuth = core.azimuth();
  pass.start_covariance = core.covariance().col(0);
  pass.records.reserve(history.epochs.size());
  for (std::size_t i = 0; i < history.epochs.size(); ++i) {
    const FilterEpoch& e = history.epochs[i];
    Record r;
    const double before = core.azimuth();
    r.transition = core.Step(e.knot, path[i], path[i + 1]);
    const double growth = core.azimuth() - before;
    if (auto level = core.Level(e.knot)) TakeAndKeep(std::move(*level), &core, &pass);
    if (e.fix >= 0) {
      const FilterFix& fix = history.fixes[static_cast<std::size_t>(e.fix)];
      const double about = fix.steady ? path[i + 1] + WrapPi(fix.about - path[i + 1]) : path[i + 1];
      StillMeasurements m = core.AtRest(e.knot, {about, fix.var_about, fix.seconds});
      TakeAndKeep(std::move(m.turn), &core, &pass);
      TakeAndKeep(std::move(m.lift), &core, &pass);
      if (fix.var_hold > 0 && i + 1 == fix.epoch_end) {
        TakeAndKeep(core.OfAzimuth(about + fix.hold - fix.about, fix.var_hold), &core, &pass);
      }
    }
    TakePlainFixes(history, i + 1, growth, &core, &pass);
    r.rows = RowsOf(core.layout(), e.knot, history.setup.site.gravity);
    r.rows_cov = r.rows * core.covariance();
    r.estimate = r.rows * core.state();
    r.cov = r.rows_cov * r.rows.transpose();
    r.diffuse = core.azimuth_diffuse();
    r.measurements_end = pass.measurements.size();
    if (e.station) {
      pass.stations.push_back({core.covariance(), core.cross()});
      core.BeginStation();
    }
    r.stations_end = pass.stations.size();
    pass.records.push_back(std::move(r));
  }
  return pass;
}

// The adjoint of the forward pass: x_smoothed = x - P state, P_smoothed = P - P information P.
struct Adjoint {
  FilterVector state;
  FilterMatrix information;

  void Undo(const FilterMeasurement& m) {
    const double k = m.gain.dot(state);
    state -= m.h * (k + m.innovation / m.innovation_variance);
    // (I - h k') M (I - k h') + h h' / s
    const FilterVector mk = information * m.gain;
    information -= m.h * mk.transpose();
    const FilterVector right = information * m.gain;
    information -= right * m.h.transpose();
    information += m.h * m.h.transpose() / m.innovation_variance;
  }

  void Undo(const FilterLayout& layout, const FilterTransition& t) {
    ApplyTransposed(layout, t, &state);
    ApplyTransposed(layout, t, &information);
    information.transposeInPlace();
    ApplyTransposed(layout, t, &information);
    information = ((information + information.transpose()) / 2).eval();
  }
};

// What the errors of S and of the toolface had in common when the knot was made, they no longer
// have once more is known of S.
AttitudeSample SmoothAttitude(const Knot& knot, const Eigen::Vector3d& estimate,
                              const Eigen::Matrix3d& cov, const NoiseCoefficients& gyro) {
  if (!(knot.var_azimuth_beyond < 0)) return AttitudeOf(knot, estimate, cov, gyro);
  Knot apart = knot;
  apart.var_azimuth_beyond = 0;
  return AttitudeOf(apart, estimate, cov, gyro);
}

StationState SmoothStation(const FilterHistory& history, std::size_t i, const Record& r,
                           const StationRecord& s, const AttitudeSample& attitude,
                           const Adjoint& adjoint, bool unknown) {
  FilterMatrix cov = s.cov - s.cov * adjoint.information * s.cov;
  cov(0, 0) = Shown(cov(0, 0), unknown);
  FilterMatrix cross;
  if (s.cross.size() > 0) cross = s.cross - s.cross * adjoint.information * s.cov;
  return StationOf(i, history.epochs[i].knot, attitude, r.rows, (cov + cov.transpose()) / 2, cross,
                   history.setup.gyro);
}

// Fills `run` and the smoothed path from a forward pass.
void Backward(const FilterHistory& history, const ForwardPass& pass, const FilterLayout& layout,
              SmoothedRun* run, Path* path) {
  const std::size_t n = history.epochs.size();
  run->attitude.assign(n, {});
  run->stations.assign(pass.stations.size(), {});
  Adjoint adjoint{FilterVector::Zero(layout.size), FilterMatrix::Zero(layout.size, layout.size)};
  for (std::size_t i = n; i-- > 0;) {
    const Record& r = pass.records[i];
    const Eigen::Vector3d estimate = r.estimate - r.rows_cov * adjoint.state;
    Eigen::Matrix3d cov = r.cov - r.rows_cov * adjoint.information * r.rows_cov.transpose();
    const bool unknown = r.diffuse && cov(1, 1) > kTellsOfAzimuth * r.cov(1, 1);
    cov(1, 1) = Shown(cov(1, 1), unknown);
    run->attitude[i] = SmoothAttitude(history.epochs[i].knot, estimate, cov, history.setup.gyro);
    // The state is S - toolface where the knot is axial, as it was read.
    (*path)[i + 1] = estimate[1] + (history.epochs[i].knot.axial ? estimate[2] : 0);
    if (history.epochs[i].station) {
      StationState& station = run->stations[r.stations_end - 1];
      station = SmoothStation(history, i, r, pass.stations[r.stations_end - 1], run->attitude[i],
                              adjoint, unknown);
    }
    const std::size_t begin = i > 0 ? pass.records[i - 1].measurements_end : pass.start;
    for (std::size_t m = r.measurements_end; m-- > begin;) adjoint.Undo(pass.measurements[m]);
    adjoint.Undo(layout, r.transition);
  }
  (*path)[0] = pass.start_azimuth - pass.start_covariance.dot(adjoint.state);
}

}  // namespace

SmoothedRun Smooth(const FilterHistory& history) {
  SmoothedRun run;
  if (history.epochs.empty()) return run;
  const FilterLayout layout = LayoutOf(history.setup);
  Path path = FirstPath(history);
  for (int pass = 0; pass < 2; ++pass) {
    Backward(history, Forward(history, path), layout, &run, &path);
  }
  return run;
}

}  // namespace wellgyro
