#pragma once

#include <array>

#include <Eigen/Core>

#include "wellgyro/base/export.h"

namespace wellgyro {

/// The 24 coefficients x_kj of the trigonometric "orthogonality error" model: k = Gx Gy Gz Mx My
/// Mz, j = amplitude, frequency, phase [rad], offset; G in g, M in nT, the trade's axes. A
/// channel's error is
///   x1 sin(x2 inc + x3) times sin(tf) for x and cos(tf) for y, plus x4, and
///   x1 sin(x2 tf + x3) times sin(inc) for z, plus x4.
///
/// It is read, applied and written for what was calibrated with it. It is not the affine model:
/// right only on the great circles where it was taken (Gx error terms along z have the wrong sign
/// at the opposite toolface), blind to three of nine linear terms, and its magnetic part holds at
/// one azimuth only. Use the affine model for anything new.
struct TrigonometricModel {
  std::array<std::array<double, 4>, 6> x{};
};

/// raw = sensitivity ideal + b, of accelerometers and fluxgates.
struct AffineModel {
  Eigen::Matrix3d sensitivity_G = Eigen::Matrix3d::Identity(),
                  sensitivity_M = Eigen::Matrix3d::Identity();
  Eigen::Vector3d b_G = Eigen::Vector3d::Zero(), b_M = Eigen::Vector3d::Zero();
};

struct CorrectedReading {
  Eigen::Vector3d G_B, M_B;
  double inclination = 0, toolface = 0;  ///< [rad]; toolface in [0, 2 pi)
  int turns = 0;                         ///< of the iteration
  bool fell_back = false;                ///< the affine model was used
};

/// What the two models leave at the attitudes of verification.
struct OrthogonalityCheck {
  struct Errors {
    double G_mg = 0, M_nT = 0;   ///< rms over all channels
    double inclination_deg = 0;  ///< rms
    double azimuth_deg = 0;      ///< median of its size
  };
  int attitudes = 0, fell_back = 0;
  Errors raw, trigonometric, affine;
};

/// Corrects by the model, whose angles are those of its own result: from the raw angles on,
/// repeated until they stand still to 1e-12 rad. Contracts by about max(x1) in inclination and
/// |x1 sin x3| / sin(inc) in toolface. Where sin(inc) is below five times the largest amplitude of
/// Gx and Gy, or 200 turns do not settle it, `affine` is applied instead.
WELLGYRO_EXPORT CorrectedReading Correct(const TrigonometricModel& model,
                                         const Eigen::Vector3d& G_raw, const Eigen::Vector3d& M_raw,
                                         const AffineModel& affine);

/// The errors of the model at given angles: Gx Gy Gz Mx My Mz.
WELLGYRO_EXPORT Eigen::Matrix<double, 6, 1> TrigonometricErrors(const TrigonometricModel& model,
                                                                double inclination,
                                                                double toolface);

/// ideal = sensitivity^-1 (raw - b).
WELLGYRO_EXPORT CorrectedReading Correct(const AffineModel& model, const Eigen::Vector3d& G_raw,
                                         const Eigen::Vector3d& M_raw);

/// The coefficients that the model's own three sequences would give for a tool with affine errors,
/// frequencies 1: Gx and Gy in the magnetic meridian (azimuth 0), Gz at azimuth 270 deg; field [nT]
/// and dip [rad].
WELLGYRO_EXPORT TrigonometricModel FromAffine(const AffineModel& affine, double field, double dip);

}  // namespace wellgyro
