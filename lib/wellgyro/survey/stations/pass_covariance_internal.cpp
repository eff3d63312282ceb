#include "wellgyro/survey/stations/pass_covariance_internal.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "wellgyro/attitude/along_hole_covariance.h"
#include "wellgyro/base/angle.h"
#include "wellgyro/math/rotation.h"
#include "wellgyro/uncertainty/error_model.h"

namespace wellgyro {
namespace {

/// What the hole may do in a leg that nobody saw: course-length terms XCLA and XCLH of the ISCWSA
/// error model, SPE 187249.
Eigen::Matrix3d UnseenCourse(const PathStation& above, const PathStation& below) {
  constexpr double kRatio = 0.167;  // XCLA, XCLH: of the leg's length times its turn [1]
  const double length = below.md - above.md;
  const double inclination = 0.5 * (above.inclination + below.inclination);
  const double turn = WrapPi(below.azimuth - above.azimuth);
  const double azimuth = above.azimuth + 0.5 * turn;
  const double si = std::sin(inclination), ci = std::cos(inclination);
  const double sa = std::sin(azimuth), ca = std::cos(azimuth);
  const double least = kLeastTortuosity * length;
  const double build = std::abs(below.inclination - above.inclination);
  const Eigen::Vector3d high = Eigen::Vector3d(ci * ca, ci * sa, -si) * std::max(build, least);
  const Eigen::Vector3d right = Eigen::Vector3d(-sa, ca, 0) * std::max(std::abs(si * turn), least);
  const double ratio = kRatio * length;
  return ratio * ratio * (high * high.transpose() + right * right.transpose());
}

/// The same where no point of the way to a station is: between marks of depth that are missing.
Eigen::Matrix3d UnseenOnWay(std::optional<PathStation> above, const PassItem& below) {
  Eigen::Matrix3d unseen = Eigen::Matrix3d::Zero();
  const auto add = [&](const PathStation& point) {
    if (above && point.md - above->md > kUnseenLeg) unseen += UnseenCourse(*above, point);
    above = point;
  };
  for (const PathStation& point : below.way) add(point);
  add(PathOf(below.station));
  return unseen;
}

/// What the errors e of single stations' depths, beyond the one that all share, do to the way
/// below: a turn dt of the tangent at a depth off by e moves it by -e dt. Between marks far apart,
/// where e is larger than what all share, it is taken for one error of the stations there, else for
/// an independent one of each leg.
class MisplacedTurns {
 public:
  explicit MisplacedTurns(double sigma_common) : common_(sigma_common) {}

  Eigen::Matrix3d To(const Station& s) {
    const double variance = s.cov_md_inc_azi(0, 0) - common_ * common_;
    const double sigma = std::sqrt(std::max(variance, 0.0));
    const Eigen::Vector3d tangent = Tangent(s.inclination, s.azimuth);
    if (last_) {
      const Eigen::Vector3d moved = 0.5 * (sigma + sigma_) * (tangent - *last_);
      if (std::max(sigma, sigma_) > common_) {
        stretch_ += moved;
      } else {
        sum_ += stretch_ * stretch_.transpose() + moved * moved.transpose();
        stretch_.setZero();
      }
    }
    sigma_ = sigma;
    last_ = tangent;
    return sum_ + stretch_ * stretch_.transpose();
  }

 private:
  double common_, sigma_ = 0;
  std::optional<Eigen::Vector3d> last_;
  Eigen::Vector3d stretch_ = Eigen::Vector3d::Zero();
  Eigen::Matrix3d sum_ = Eigen::Matrix3d::Zero();
};

/// Covariance of a leg on which the azimuth was lost. Uniform azimuth of the true leg and of the
/// drawn one: E[(x - x')^2] = 2 (L sin I)^2 / 2 in north and in east, with I the mean inclination.
Eigen::Matrix3d UnknownCourse(const Station& above, const Station& below) {
  const double inclination = 0.5 * (above.inclination + below.inclination);
  const double aside = (below.md - above.md) * std::sin(inclination);
  return Eigen::Vector3d(aside * aside, aside * aside, 0).asDiagonal();
}

/// Stations found at rest, each from its own window: errors of inclination and azimuth count as
/// fully correlated from station to station (rho = 1), because shared instrument errors dominate;
/// that is the upper bound of the sum. The course between stations is unobserved: random from leg
/// to leg.
class SystematicCovariance {
 public:
  SystematicCovariance(const Eigen::Matrix3d& cov_tie_in_W, bool legs_unseen)
      : cov_tie_in_W_(cov_tie_in_W), legs_unseen_(legs_unseen) {}

  Eigen::Matrix3d Add(const Station& station) {
    const Eigen::Vector2d sigma = station.cov_md_inc_azi.diagonal().tail<2>().cwiseSqrt();
    const Eigen::Matrix<double, 3, 2> turn =
        TangentByAngles(station.inclination, station.azimuth) * sigma.asDiagonal();
    if (last_) {
      sum_ += 0.5 * (station.md - last_->md) * (last_turn_ + turn);
      if (legs_unseen_) course_ += UnseenCourse(PathOf(*last_), PathOf(station));
    }
    last_ = station;
    last_turn_ = turn;
    return cov_tie_in_W_ + sum_ * sum_.transpose() + course_;
  }

 private:
  Eigen::Matrix3d cov_tie_in_W_;
  bool legs_unseen_;
  Eigen::Matrix3d course_ = Eigen::Matrix3d::Zero();
  Eigen::Matrix<double, 3, 2> sum_ = Eigen::Matrix<double, 3, 2>::Zero();
  Eigen::Matrix<double, 3, 2> last_turn_ = Eigen::Matrix<double, 3, 2>::Zero();
  std::optional<Station> last_;
};

/// Second-order term: an azimuth error d shortens a leg's horizontal reach by the factor cos d. The
/// sign of 1 - cos d is always the same, so all legs count as fully correlated.
class ShortOfWay {
 public:
  explicit ShortOfWay(const Station& first) : md_(first.md), last_(Of(first)) {}
  Eigen::Matrix3d To(const Station& s) {
    const Eigen::Vector3d here = Of(s);
    sum_ += 0.5 * (s.md - md_) * (last_ + here);
    md_ = s.md;
    last_ = here;
    return sum_ * sum_.transpose();
  }

 private:
  /// Root mean square of 1 - cos d for a normal d, along the station's way.
  static Eigen::Vector3d Of(const Station& s) {
    const double u = -std::expm1(-s.cov_md_inc_azi(2, 2) / 2);
    const double less = u * std::sqrt(3 - 2 * u + u * u / 2) * std::sin(s.inclination);
    return {less * std::cos(s.azimuth), less * std::sin(s.azimuth), 0};
  }

  double md_;
  Eigen::Vector3d last_, sum_ = Eigen::Vector3d::Zero();
};

std::vector<Eigen::Matrix3d> OfWindows(const PassItems& pass, const PathStart& start,
                                       const Station& origin) {
  std::vector<Eigen::Matrix3d> covs;
  SystematicCovariance sum(start.cov_p_WT_W, true);
  sum.Add(origin);
  ShortOfWay shortfall(origin);
  for (const PassItem& item : pass) {
    const Station& s = item.station;
    covs.push_back(sum.Add(s) + shortfall.To(s));
  }
  return covs;
}

std::vector<Eigen::Matrix3d> OfSamples(const Job& job, const PassItems& pass,
                                       const PathStart& start, const Station& origin) {
  std::vector<Eigen::Matrix3d> covs;
  const bool out = pass.front().station.pass == Pass::kOut;
  const auto order = out ? TimeAlongHole::kAgainstDepth : TimeAlongHole::kWithDepth;
  const bool unseen_above = SeenFrom(pass) - start.point.station.md > kUnseenLeg;
  SystematicCovariance first(start.cov_p_WT_W, pass.front().way.empty() || unseen_above);
  first.Add(origin);
  ShortOfWay shortfall(origin);
  AlongHoleCovariance sum(first.Add(pass.front().station), 0, order);
  MisplacedTurns misplaced(job.errors.depth_sigma);
  Eigen::Matrix3d unseen = Eigen::Matrix3d::Zero();
  const PassItem* above = nullptr;
  for (const PassItem& item : pass) {
    if (item.on_line) {
      unseen += UnseenOnWay(above ? std::optional(PathOf(above->station)) : std::nullopt, item);
      const StationState* later = above == nullptr ? nullptr : out ? above->state : item.state;
      if (later != nullptr && later->cov_with_previous.size() == 0) {
        unseen += UnknownCourse(above->station, item.station);
      }
      above = &item;
      sum.Add(*item.state);
      covs.push_back(sum.cov_without_depth_W() + unseen + shortfall.To(item.station) +
                     misplaced.To(item.station));
    } else {
      sum.Skip(*item.state);
      covs.push_back(covs.back());
    }
  }
  return covs;
}

/// The job's sigma is of an error common to all depths; what a station's own depth is less sure by
/// moves it along the hole alone.
Eigen::Matrix3d OfDepth(const Job& job, const Eigen::Vector3d& top, const Station& s) {
  const Eigen::Vector3d tangent = Tangent(s.inclination, s.azimuth);
  const double variance = s.cov_md_inc_azi(0, 0);
  const double common = std::min(job.errors.depth_sigma * job.errors.depth_sigma, variance);
  return common * ByCommonDepth(top, tangent) + (variance - common) * tangent * tangent.transpose();
}

}  // namespace

Eigen::Matrix3d ByCommonDepth(const Eigen::Vector3d& top_W, const Eigen::Vector3d& tangent_W) {
  const Eigen::Vector3d turned = top_W - tangent_W;
  return top_W * top_W.transpose() + turned * turned.transpose();
}

PassCovariances PassCovariancesOf(const Job& job, const PassItems& pass, const PathStart& start) {
  // The first leg runs from the start to the first station with the first station's error.
  Station origin = pass.front().station;
  origin.md = start.point.station.md;
  const bool windows = std::any_of(pass.begin(), pass.end(),
                                   [](const PassItem& item) { return item.state == nullptr; });
  PassCovariances covs;
  covs.covs_of_sensors_W =
      windows ? OfWindows(pass, start, origin) : OfSamples(job, pass, start, origin);
  for (const PassItem& item : pass) {
    covs.covs_of_depth_W.push_back(OfDepth(job, start.top_tangent_W, item.station));
  }
  return covs;
}

}  // namespace wellgyro
