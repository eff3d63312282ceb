#include "wellgyro/estimate/layout.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "wellgyro/estimate/swing.h"
#include "wellgyro/math/linear_algebra.h"
#include "wellgyro/record/force_errors.h"

namespace wellgyro {
namespace {

/// Prior sigmas by the job, beside a calibration's covariance.
ErrorVector SourceSigmas(const EstimateSetup& setup) {
  const ErrorPriors& e = setup.errors;
  // Without a correlation time the instability is a constant beside the bias.
  const double constant =
      setup.gyro.bias_instability_correlation_time ? 0 : setup.gyro.bias_instability;
  ErrorVector sigma = ErrorVector::Zero();
  sigma[kGyroBiasX] = sigma[kGyroBiasY] = std::hypot(e.gyro_bias_sigma, constant);
  sigma[kMassUnbalance] = e.mass_unbalance_sigma;
  sigma[kQuadrature] = e.quadrature_sigma;
  sigma[kGyroScaleX] = sigma[kGyroScaleY] = e.gyro_scale_sigma;
  if (setup.third_axis) {
    sigma[kGyroBiasZ] = sigma[kGyroBiasX];
    sigma[kGyroScaleZ] = e.gyro_scale_sigma;
  }
  sigma[kMisalignmentX] = sigma[kMisalignmentY] = e.gyro_misalignment_sigma;
  sigma[kToolfaceOffset] = ToolfaceOffsetSigma(e);
  sigma[kTimeSkew] = e.time_skew_sigma;
  sigma.segment<3>(kAccelBiasX).setConstant(e.accel_bias_sigma);
  sigma.segment<3>(kAccelScaleX).setConstant(e.accel_scale_sigma);
  sigma.segment<2>(kAccelMisalignmentX).setConstant(e.accel_misalignment_sigma);
  sigma[kAccelShear] = ShearSigma(e);
  sigma.segment<2>(kAccelMisalignmentZX).setConstant(e.accel_misalignment_sigma);
  return sigma;
}

ErrorCovariance SourceCovariance(const EstimateSetup& setup) {
  ErrorCovariance cov = setup.cov_errors.value_or(ErrorCovariance{});
  if (!setup.third_axis) {
    for (const int absent : {kGyroBiasZ, kGyroScaleZ, kGyroMisalignmentZX, kGyroMisalignmentZY}) {
      for (ErrorMatrix* matrix : {&cov.constant, &cov.change, &cov.constant_with_change}) {
        matrix->row(absent).setZero();
        matrix->col(absent).setZero();
      }
    }
  }
  cov.constant.diagonal() += SourceSigmas(setup).cwiseAbs2();
  return cov;
}

/// Added to the diagonal of the errors' correlations. A calibration that knows errors by their sum
/// has a covariance without full rank: the sum then has a sigma of sqrt(kApart), a thousandth of
/// theirs.
constexpr double kApart = 1e-6;

double BiasesByWarmth(const EstimateSetup& setup, int source) {
  const bool across = source == kGyroBiasX || source == kGyroBiasY;
  const bool counts = across || (source == kGyroBiasZ && setup.third_axis);
  return counts ? setup.sigma_bias_by_warmth : 0;
}

/// Information of the border before any knot.
BorderMatrix InformationOf(const Layout& layout, const ErrorCovariance& sources) {
  BorderMatrix correlation = BorderMatrix::Identity(layout.border, layout.border);
  bool linked = false;
  const auto put = [&](int row, int column, double cov) {
    if (row == column || row == kAbsent || column == kAbsent || cov == 0) return;
    correlation(row, column) = correlation(column, row) =
        cov / (layout.sigma[row] * layout.sigma[column]);
    linked = true;
  };
  for (Eigen::Index i = 0; i < kErrorSources; ++i) {
    const auto row = static_cast<std::size_t>(i);
    for (Eigen::Index j = 0; j < kErrorSources; ++j) {
      const auto column = static_cast<std::size_t>(j);
      put(layout.source[row], layout.source[column], sources.constant(i, j));
      put(layout.change[row], layout.change[column], sources.change(i, j));
      put(layout.source[row], layout.change[column], sources.constant_with_change(i, j));
    }
  }
  if (linked) {
    correlation.diagonal().array() += kApart;
    correlation = InverseOfSymmetric(correlation);
  }
  const auto per_sigma = layout.sigma.cwiseInverse().asDiagonal();
  return per_sigma * correlation * per_sigma;
}

}  // namespace

Layout LayoutOf(const EstimateSetup& setup) {
  Layout layout;
  const auto node = [&layout](int count) {
    const int column = layout.node;
    layout.node += count;
    return column;
  };
  layout.gyros = setup.third_axis ? 3 : 2;
  if (setup.gyro.rate_random_walk > 0) layout.walk = node(layout.gyros);
  if (setup.gyro.bias_instability_correlation_time && setup.gyro.bias_instability > 0) {
    layout.markov = node(layout.gyros);
  }
  if (setup.swing && !setup.third_axis) layout.swing = node(2);

  layout.sigma.resize(kBorderMax);
  const auto border = [&layout](double sigma) {
    if (!(sigma > 0)) return kAbsent;
    layout.sigma[layout.border] = sigma;
    return layout.border++;
  };
  const ErrorCovariance sources = SourceCovariance(setup);
  for (int i = 0; i < kErrorSources; ++i) {
    const double constant = std::max(0.0, sources.constant(i, i)), change = sources.change(i, i);
    const double by_warmth = BiasesByWarmth(setup, i);
    const auto at = static_cast<std::size_t>(i);
    layout.source[at] = border(std::sqrt(constant));
    layout.change[at] =
        border(std::hypot(change > kApart * constant ? std::sqrt(change) : 0, by_warmth));
    layout.second_order |= i >= kAccelSecondOrder && constant > 0;
  }
  layout.ramp = border(setup.gyro.rate_ramp);
  for (int i = 1; i < layout.gyros; ++i) border(setup.gyro.rate_ramp);
  layout.latitude = border(setup.errors.latitude_sigma);
  layout.gravity = border(setup.sigma_gravity);
  layout.gravity_gradient = border(setup.sigma_gravity_gradient);
  if (layout.swing != kAbsent) layout.frequency = border(kSwingSigma);
  layout.depth_scale = border(setup.sigma_depth_scale);
  layout.sigma.conservativeResize(layout.border);
  layout.information = InformationOf(layout, sources);
  return layout;
}

int BorderColumn(const Layout& layout, int unknown) {
  switch (unknown) {
    case kLatitudeError:
      return layout.latitude;
    case kGravityError:
      return layout.gravity;
    case kDepthScaleError:
      return layout.depth_scale;
    case kRampX:
    case kRampY:
    case kRampZ: {
      const int gyro = unknown - kRampX;
      return layout.ramp == kAbsent || gyro >= layout.gyros ? kAbsent : layout.ramp + gyro;
    }
    case kWarmthX:
      return layout.change[kGyroBiasX];
    case kWarmthY:
      return layout.change[kGyroBiasY];
    case kWarmthZ:
      return layout.change[kGyroBiasZ];
    default:
      return layout.source[static_cast<std::size_t>(unknown)];
  }
}

double* PriorOf(int unknown, EstimateSetup& setup) {
  ErrorPriors& e = setup.errors;
  switch (unknown) {
    case kGyroBiasX:
    case kGyroBiasY:
    case kGyroBiasZ:
      return &e.gyro_bias_sigma;
    case kMassUnbalance:
      return &e.mass_unbalance_sigma;
    case kQuadrature:
      return &e.quadrature_sigma;
    case kGyroScaleX:
    case kGyroScaleY:
    case kGyroScaleZ:
      return &e.gyro_scale_sigma;
    case kMisalignmentX:
    case kMisalignmentY:
      return &e.gyro_misalignment_sigma;
    case kToolfaceOffset:
      return &e.roll_offset_sigma;
    case kTimeSkew:
      return &e.time_skew_sigma;
    case kAccelBiasX:
    case kAccelBiasY:
    case kAccelBiasZ:
      return &e.accel_bias_sigma;
    case kAccelScaleX:
    case kAccelScaleY:
    case kAccelScaleZ:
      return &e.accel_scale_sigma;
    case kAccelMisalignmentX:
    case kAccelMisalignmentY:
    case kAccelShear:
    case kAccelMisalignmentZX:
    case kAccelMisalignmentZY:
      return &e.accel_misalignment_sigma;
    case kLatitudeError:
      return &e.latitude_sigma;
    case kGravityError:
      return &setup.sigma_gravity;
    case kDepthScaleError:
      return &setup.sigma_depth_scale;
    case kRampX:
    case kRampY:
    case kRampZ:
      return &setup.gyro.rate_ramp;
    case kWarmthX:
    case kWarmthY:
    case kWarmthZ:
      return &setup.sigma_bias_by_warmth;
    default:
      return nullptr;
  }
}

std::vector<int> LinkedColumns(const Layout& layout) {
  std::vector<int> columns{0, 1, 2};
  for (const int drift : {layout.walk, layout.markov}) {
    if (drift == kAbsent) continue;
    for (int i = 0; i < layout.gyros; ++i) columns.push_back(drift + i);
  }
  for (int i = 0; i < layout.border; ++i) columns.push_back(layout.node + i);
  return columns;
}

Eigen::MatrixXd LinkedRows(const Layout& layout) {
  const std::vector<int> columns = LinkedColumns(layout);
  Eigen::MatrixXd rows =
      Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(columns.size()), layout.node + layout.border);
  for (std::size_t i = 0; i < columns.size(); ++i) {
    rows(static_cast<Eigen::Index>(i), columns[i]) = 1;
  }
  return rows;
}

void CarryLink(const Layout& layout, const BehindMatrix& gain, Eigen::MatrixXd& link) {
  const Eigen::MatrixXd by_border = link.rightCols(layout.border);
  link = (link.leftCols(layout.node) * gain).eval();
  link.rightCols(layout.border) += by_border;
}

}  // namespace wellgyro
