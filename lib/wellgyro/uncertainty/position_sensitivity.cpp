#include "wellgyro/uncertainty/position_sensitivity_internal.h"

namespace wellgyro {

using Eigen::Vector3d;

StationDirection DirectionAt(const WeightPlace& p) {
  return {{p.sin_inc * p.cos_hole, p.sin_inc * p.sin_hole, p.cos_inc},
          {p.cos_inc * p.cos_hole, p.cos_inc * p.sin_hole, -p.sin_inc},
          {-p.sin_inc * p.sin_hole, p.sin_inc * p.cos_hole, 0}};
}

PositionSensitivity SensitivityAt(const Vector3d& above_W, const StationDirection& here,
                                  const Vector3d& below_W, double own, double ahead) {
  PositionSensitivity s;
  s.at_by_md_inc_azi_W.col(0) = (above_W + here.tangent_W) / 2;
  s.at_by_md_inc_azi_W.col(1) = own * here.high_side_W;
  s.at_by_md_inc_azi_W.col(2) = own * here.right_W;
  s.along_at = own;
  s.along_through = own + ahead / 2;
  s.through_by_md_inc_azi_W.col(0) = s.at_by_md_inc_azi_W.col(0) - (here.tangent_W + below_W) / 2;
  s.through_by_md_inc_azi_W.col(1) = s.along_through * here.high_side_W;
  s.through_by_md_inc_azi_W.col(2) = s.along_through * here.right_W;
  return s;
}

PositionSensitivity SensitivityFrom(const StationDirection& here, const Vector3d& below_W,
                                    double ahead) {
  PositionSensitivity s;
  s.at_by_md_inc_azi_W.setZero();
  s.along_through = ahead / 2;
  s.through_by_md_inc_azi_W.col(0) = (here.tangent_W - below_W) / 2;
  s.through_by_md_inc_azi_W.col(1) = s.along_through * here.high_side_W;
  s.through_by_md_inc_azi_W.col(2) = s.along_through * here.right_W;
  return s;
}

}  // namespace wellgyro
