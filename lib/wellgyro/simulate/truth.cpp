#include "wellgyro/simulate/truth.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <Eigen/Geometry>
#include <fmt/core.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/simulate/ellipsoid.h"

namespace wellgyro {
namespace {

// Of a run whose toolface is commanded: there a bend aside of 1 deg/30 m turns it by 0.033 / sin
// 0.1 deg = 19 deg a metre.
constexpr double kLeastInclination = FromDegrees(0.1);

// The rotation that takes z to `t` by the shortest way, Rz(A) Ry(I) Rz(-A).
Eigen::Matrix3d ShortestFromDown(const Eigen::Vector3d& t) {
  const double x = t.x(), y = t.y(), k = 1 / (1 + t.z());
  Eigen::Matrix3d r;
  r << 1 - k * x * x, -k * x * y, x, -k * x * y, 1 - k * y * y, y, -x, -y, t.z();
  return r;
}

void RequireInclined(const SimulatedRun& run, const TruthWell& well) {
  double shallow = run.start_md, deep = run.start_md;
  for (const RunStep& step : run.steps) {
    if (const auto* move = std::get_if<RunMove>(&step)) {
      shallow = std::min(shallow, move->to_md);
      deep = std::max(deep, move->to_md);
    }
  }
  const double step = std::min(well.shape().detail() / 20, 0.5);
  for (double k = 0; shallow + (k - 1) * step < deep; ++k) {
    const double md = std::min(shallow + k * step, deep);
    const double inclination = well.PointAt(md).inclination;
    if (inclination >= kLeastInclination) continue;
    throw std::invalid_argument(
        fmt::format("[run] roll_reference: no high side at {} m, where the inclination is {} deg; "
                    "count the roll from north",
                    md, ToDegrees(inclination)));
  }
}

}  // namespace

struct Truth::Pose {
  RunMotion motion;
  HoleDirection hole;
  Eigen::Matrix3d R_LT;
  double roll_from_north;  // toolface + azimuth [rad]
  Eigen::Vector3d w_LT_T;  // [rad/s]
};

Truth::Truth(const Simulation& simulation)
    : earth_(simulation.earth),
      roll_reference_(simulation.run.roll_reference),
      well_(simulation.well, simulation.earth),
      plan_(simulation.run, well_) {
  if (roll_reference_ == RollReference::kHighSide) RequireInclined(simulation.run, well_);
}

Truth::Pose Truth::PoseAt(double time) const {
  Pose pose;
  pose.motion = plan_.At(time);
  pose.hole = well_.DirectionAt(pose.motion.md);
  const Eigen::Vector3d& t = pose.hole.tangent_L;
  const Eigen::Vector3d turn = pose.motion.speed * pose.hole.curvature_L;  // of the tangent, per s
  const double swing = t.x() * turn.y() - t.y() * turn.x();                // A' sin^2 I
  double roll = pose.motion.roll, roll_rate = pose.motion.roll_rate;
  if (roll_reference_ == RollReference::kHighSide) {
    roll += std::atan2(t.y(), t.x());
    roll_rate += swing / (t.x() * t.x() + t.y() * t.y());
  }
  pose.roll_from_north = roll;
  const double c = std::cos(roll), s = std::sin(roll);
  const Eigen::Matrix3d r = ShortestFromDown(t);
  pose.R_LT.col(0) = c * r.col(0) + s * r.col(1);
  pose.R_LT.col(1) = c * r.col(1) - s * r.col(0);
  pose.R_LT.col(2) = t;
  // t' = w x t gives the rate across the axis; about it, the roll less what the shortest rotation
  // itself turns, A' (1 - cos I).
  const Eigen::Vector3d across = t.cross(turn);
  pose.w_LT_T = {pose.R_LT.col(0).dot(across), pose.R_LT.col(1).dot(across),
                 roll_rate - swing / (1 + t.z())};
  return pose;
}

TruthState Truth::At(double time) const {
  const Pose pose = PoseAt(time);
  const WellPoint point = well_.PointAt(pose.motion.md);
  const HolePlace place = well_.PlaceAt(pose.motion.md);
  return {.time = time,
          .md = pose.motion.md,
          .speed = pose.motion.speed,
          .inclination = point.inclination,
          .azimuth = point.azimuth,
          .toolface = WrapTwoPi(pose.roll_from_north - point.azimuth),
          .p_WT_W = place.p_WT_W,
          .latitude = place.latitude,
          .longitude = place.longitude,
          .height = place.height(),
          .R_LT = pose.R_LT,
          .still = pose.motion.still};
}

SensorTruth Truth::SensorsAt(double time) const {
  const Pose pose = PoseAt(time);
  const HolePlace place = well_.PlaceAt(pose.motion.md);
  const double s = std::sin(place.latitude), c = std::cos(place.latitude);
  const EllipsoidPlace earth = EllipsoidAt(s, place.height());
  const double anomaly =
      earth_.gravity_anomaly + earth_.gravity_gradient_anomaly * place.p_WT_W.z();
  const double v = pose.motion.speed;
  const Eigen::Vector3d v_L = v * pose.hole.tangent_L;
  const Eigen::Vector3d w_IE_L(earth_.rate * c, 0, -earth_.rate * s);
  const Eigen::Vector3d w_EL_L(v_L.y() / earth.radius_east, -v_L.x() / earth.radius_north,
                               -v_L.y() * s / (c * earth.radius_east));
  const Eigen::Vector3d f_L = pose.motion.acceleration * pose.hole.tangent_L +
                              v * v * pose.hole.curvature_L + (2 * w_IE_L + w_EL_L).cross(v_L) -
                              Eigen::Vector3d(0, 0, earth.gravity + anomaly);
  const Eigen::Matrix3d R_TL = pose.R_LT.transpose();
  return {.w_IT_T = R_TL * (w_IE_L + w_EL_L) + pose.w_LT_T,
          .f_T = R_TL * f_L,
          .b_T = R_TL * earth_.field_L};
}

void Truth::AddStretch(double begin, double end, const Eigen::Vector3d& lever_arm_T,
                       SensorTruth& sum) const {
  // Gauss-Legendre of 4 points: exact to degree 7.
  constexpr double kNode[4] = {-0.861136311594052575, -0.339981043584856265, 0.339981043584856265,
                               0.861136311594052575};
  constexpr double kWeight[4] = {0.347854845137453857, 0.652145154862546143, 0.652145154862546143,
                                 0.347854845137453857};
  const double half = 0.5 * (end - begin), middle = begin + half;
  const bool has_arm = lever_arm_T != Eigen::Vector3d::Zero();
  for (int i = 0; i < 4; ++i) {
    const SensorTruth at = SensorsAt(middle + half * kNode[i]);
    const double weight = half * kWeight[i];
    sum.w_IT_T += weight * at.w_IT_T;
    sum.f_T += weight * at.f_T;
    sum.b_T += weight * at.b_T;
    if (has_arm) sum.f_T += weight * at.w_IT_T.cross(at.w_IT_T.cross(lever_arm_T));
  }
}

SensorTruth Truth::MeanOver(double begin, double end, const Eigen::Vector3d& lever_arm_T) const {
  SensorTruth sum;
  for (double at = begin; at < end;) {
    const double stop = std::min(plan_.NextBreak(at), end);
    const double pieces = std::ceil((stop - at) / plan_.short_time() * (1 - 1e-9));
    const double length = (stop - at) / pieces;
    for (double k = 0; k < pieces; ++k) {
      AddStretch(at + k * length, k + 1 < pieces ? at + (k + 1) * length : stop, lever_arm_T, sum);
    }
    at = stop;
  }
  // The mean of w' x lever arm needs no derivative: it is the change of w over the stretch.
  if (lever_arm_T != Eigen::Vector3d::Zero()) {
    sum.f_T += (SensorsAt(end).w_IT_T - SensorsAt(begin).w_IT_T).cross(lever_arm_T);
  }
  const double seconds = end - begin;
  return {.w_IT_T = sum.w_IT_T / seconds, .f_T = sum.f_T / seconds, .b_T = sum.b_T / seconds};
}

}  // namespace wellgyro
