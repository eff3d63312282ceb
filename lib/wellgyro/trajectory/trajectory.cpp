#include "wellgyro/trajectory/trajectory.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <fmt/core.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/math/rotation.h"
#include "wellgyro/trajectory/arc_internal.h"
#include "wellgyro/trajectory/minimum_curvature.h"

namespace wellgyro {
namespace {

// Crossings closer than this are one: between them the hole leaves the level by less than the
// rounding of TVD, be it around a touching point or at the common station of two legs.
constexpr double kSamePlace = 1e-4;  // [m]
// A level counts as reached when it is missed by no more.
constexpr double kReached = 1e-9;  // [m]

TrajectoryPoint PointAlong(double md, const Eigen::Vector3d& position_W,
                           const Eigen::Vector3d& tangent_W, double azimuth_if_vertical) {
  TrajectoryPoint point{.md = md, .position_W = position_W, .tangent_W = tangent_W};
  const double across = std::hypot(tangent_W.x(), tangent_W.y());
  point.inclination = std::atan2(across, tangent_W.z());
  point.azimuth =
      across > 0 ? WrapTwoPi(std::atan2(tangent_W.y(), tangent_W.x())) : azimuth_if_vertical;
  return point;
}

// Stretches of depth in which the hole is at the level, joined where they touch.
class Stretches {
 public:
  void Add(double begin, double end) {
    if (!ends_.empty() && begin <= ends_.back().y() + kSamePlace) {
      ends_.back().y() = std::max(ends_.back().y(), end);
    } else {
      ends_.emplace_back(begin, end);
    }
  }

  std::vector<double> Depths() const {
    std::vector<double> depths;
    for (const Eigen::Vector2d& e : ends_) {
      depths.push_back(e.x());
      if (e.y() > e.x() + kSamePlace) depths.push_back(e.y());
    }
    return depths;
  }

 private:
  std::vector<Eigen::Vector2d> ends_;
};

}  // namespace

Trajectory::Trajectory(std::span<const double> md, std::span<const double> inclination,
                       std::span<const double> azimuth, const Eigen::Vector3d& start_W)
    : md_(md.begin(), md.end()),
      inclination_(inclination.begin(), inclination.end()),
      severity_(md.size()),
      position_W_(md.size()),
      tangent_W_(md.size()) {
  if (md.empty()) throw std::invalid_argument("Trajectory: no station");
  if (!start_W.allFinite()) throw std::invalid_argument("Trajectory: the start is not finite");
  MinimumCurvature(md, inclination, azimuth, start_W, position_W_, severity_, tangent_W_);
  azimuth_.reserve(md.size());
  for (const double a : azimuth) azimuth_.push_back(WrapTwoPi(a));
  Index();
}

Trajectory Trajectory::OfPath(std::span<const PathPoint> points) {
  if (points.empty()) throw std::invalid_argument("Trajectory: no station");
  Trajectory made;
  for (const PathPoint& p : points) {
    const TrajectoryPoint point =
        PointAlong(p.station.md, p.p_WT_W, p.tangent_W, WrapTwoPi(p.station.azimuth));
    if (!made.md_.empty() && !(point.md > made.md_.back())) {
      throw std::invalid_argument(fmt::format("Trajectory: station {}: depth {} m after {} m",
                                              made.md_.size(), point.md, made.md_.back()));
    }
    made.md_.push_back(point.md);
    made.inclination_.push_back(point.inclination);
    made.azimuth_.push_back(point.azimuth);
    made.severity_.push_back(p.dogleg_severity);
    made.position_W_.push_back(p.p_WT_W);
    made.tangent_W_.push_back(p.tangent_W);
  }
  made.severity_.front() = 0;
  made.Index();
  return made;
}

Trajectory Trajectory::TiedOnto(const Trajectory& parent, double md,
                                std::span<const PathStation> stations) {
  const TrajectoryPoint tie = parent.AtMd(md);
  std::vector<double> depths{tie.md}, inclinations{tie.inclination}, azimuths{tie.azimuth};
  for (const PathStation& s : stations) {
    depths.push_back(s.md);
    inclinations.push_back(s.inclination);
    azimuths.push_back(s.azimuth);
  }
  return Trajectory(depths, inclinations, azimuths, tie.position_W);
}

void Trajectory::Index() {
  const std::size_t legs = size() - 1;
  if (legs == 0) return;
  leaves_ = std::bit_ceil(legs);
  constexpr double kNone = std::numeric_limits<double>::infinity();
  range_.assign(2 * leaves_, Eigen::Vector2d(kNone, -kNone));
  for (std::size_t i = 0; i < legs; ++i) {
    const double z1 = position_W_[i].z(), z2 = position_W_[i + 1].z();
    const double t1 = tangent_W_[i].z(), t2 = tangent_W_[i + 1].z();
    Eigen::Vector2d& range = range_[leaves_ + i];
    range = {std::min(z1, z2), std::max(z1, z2)};
    if (t1 * t2 < 0) {
      const Arc arc = MakeArc(md_[i + 1] - md_[i], z1, tangent_W_[i], tangent_W_[i + 1]);
      range = RangeOf(arc, z1, z2, t1, t2);
    }
  }
  for (std::size_t k = leaves_ - 1; k > 0; --k) {
    range_[k] = {std::min(range_[2 * k].x(), range_[2 * k + 1].x()),
                 std::max(range_[2 * k].y(), range_[2 * k + 1].y())};
  }
}

TrajectoryPoint Trajectory::station(std::size_t i) const {
  return {.md = md_[i],
          .inclination = inclination_[i],
          .azimuth = azimuth_[i],
          .position_W = position_W_[i],
          .tangent_W = tangent_W_[i],
          .dogleg_severity = severity_[i]};
}

TrajectoryPoint Trajectory::AtMd(double md) const {
  if (!(md >= md_begin() && md <= md_end())) {
    throw std::domain_error(
        fmt::format("Trajectory: {} m is outside {} m to {} m", md, md_begin(), md_end()));
  }
  const auto below = std::lower_bound(md_.begin(), md_.end(), md);
  const auto i = static_cast<std::size_t>(below - md_.begin());
  if (*below == md) return station(i);
  const double length = md - md_[i - 1];
  const double fraction = length / (md_[i] - md_[i - 1]);
  const Eigen::Vector3d tangent_W = TangentOnArc(tangent_W_[i - 1], tangent_W_[i], fraction);
  const auto leg = MinimumCurvatureLeg(length, tangent_W_[i - 1], tangent_W);
  TrajectoryPoint point =
      PointAlong(md, position_W_[i - 1] + (leg ? leg->displacement : Eigen::Vector3d::Zero()),
                 tangent_W, azimuth_[i - 1]);
  point.dogleg_severity = severity_[i];
  return point;
}

std::vector<double> Trajectory::MdAtTvd(double tvd) const {
  Stretches found;
  if (leaves_ == 0) {
    if (std::abs(position_W_.front().z() - tvd) <= kReached) found.Add(md_begin(), md_begin());
    return found.Depths();
  }
  // Down the heap from the left, into every node whose range holds the level: as TVD is continuous
  // each of them holds a crossing.
  std::vector<std::size_t> open{1};
  while (!open.empty()) {
    const std::size_t k = open.back();
    open.pop_back();
    if (!(tvd >= range_[k].x() - kReached && tvd <= range_[k].y() + kReached)) continue;
    if (k < leaves_) {
      open.push_back(2 * k + 1);
      open.push_back(2 * k);
      continue;
    }
    const std::size_t i = k - leaves_;
    const Arc arc =
        MakeArc(md_[i + 1] - md_[i], position_W_[i].z(), tangent_W_[i], tangent_W_[i + 1]);
    const Crossings at = CrossingsAt(arc, tvd);
    if (at.level) {
      found.Add(md_[i], md_[i + 1]);
      continue;
    }
    for (int c = 0; c < at.count; ++c) {
      const double md = md_[i] + at.s[static_cast<std::size_t>(c)];
      found.Add(md, md);
    }
  }
  return found.Depths();
}

std::vector<TrajectoryPoint> Trajectory::Resampled(double spacing, bool keep_stations) const {
  if (!(spacing > 0) || !std::isfinite(spacing)) {
    throw std::invalid_argument(fmt::format("Trajectory: no spacing of {} m", spacing));
  }
  std::vector<double> depths{md_begin()};
  if (keep_stations) depths = md_;
  const double first = std::ceil(md_begin() / spacing);
  // Counted, not added up, so that no rounding gathers.
  for (double k = first; k * spacing <= md_end(); ++k) depths.push_back(k * spacing);
  depths.push_back(md_end());
  std::sort(depths.begin(), depths.end());
  depths.erase(std::unique(depths.begin(), depths.end()), depths.end());
  std::vector<TrajectoryPoint> points;
  points.reserve(depths.size());
  for (const double md : depths) {
    if (md >= md_begin()) points.push_back(AtMd(md));
  }
  return points;
}

TrajectoryPoint Trajectory::Ahead(double length, double dogleg_severity, double toolface) const {
  const double dogleg = length * dogleg_severity;
  if (!(length >= 0) || !(dogleg_severity >= 0) || !(dogleg < kDoglegLimit) ||
      !std::isfinite(length) || !std::isfinite(toolface)) {
    throw std::invalid_argument(
        fmt::format("Trajectory: no curve ahead of {} m at {} rad/m, toolface {} rad", length,
                    dogleg_severity, toolface));
  }
  const TrajectoryPoint last = station(size() - 1);
  const Eigen::Vector3d high = Tangent(last.inclination + kPi / 2, last.azimuth);
  const Eigen::Vector3d right(-std::sin(last.azimuth), std::cos(last.azimuth), 0);
  const Eigen::Vector3d to = std::cos(toolface) * high + std::sin(toolface) * right;
  const Eigen::Vector3d tangent_W = std::cos(dogleg) * last.tangent_W + std::sin(dogleg) * to;
  const auto leg = MinimumCurvatureLeg(length, last.tangent_W, tangent_W);
  TrajectoryPoint point = PointAlong(
      last.md + length, last.position_W + (leg ? leg->displacement : Eigen::Vector3d::Zero()),
      tangent_W, last.azimuth);
  point.dogleg_severity = dogleg_severity;
  return point;
}

}  // namespace wellgyro
