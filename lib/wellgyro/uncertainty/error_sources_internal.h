#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/uncertainty/propagate.h"

namespace wellgyro {

/// The independent error sources of a well and what each has done to the position so far.
///
/// A source adds up, as a vector, while its group lasts; its groups are independent of each other.
/// A random error begins a group at every station, a systematic one never does. Terms that several
/// legs share are one source.
class ErrorSources {
 public:
  explicit ErrorSources(const PropagateOptions& options)
      : options_(options), cov_tie_in_W_(options.cov_tie_in_W) {}

  /// The source of `term` in `leg`, which may be that of an earlier leg.
  std::size_t SourceOf(const ErrorTerm& term, const ToolLeg& leg, std::size_t leg_number);
  /// To be called once, when every source is known.
  void Open(std::size_t stations, PositionUncertainty& result);

  /// Only `sources` change from here on.
  void StartLeg(const std::vector<std::size_t>& sources);
  /// The error of this station: `at_W` moves its own position, `through_W` that of all deeper ones.
  void Add(std::size_t source, std::int64_t group, const Eigen::Vector3d& at_W,
           const Eigen::Vector3d& through_W) {
    Source& s = sources_[source];
    if (group != s.group) Close(s, group);
    s.error_W = s.sum_W + at_W;
    s.sum_W += through_W;
  }
  /// What has been gathered so far, the tie-in's covariance included, is left out from here on.
  void Forget();
  /// Writes this station's covariances.
  void Give(PositionUncertainty& result) const;

 private:
  struct Source {
    std::string name;
    Propagation propagation = Propagation::kSystematic;
    std::size_t leg = 0;                ///< the first that has it, from 0
    int run = 0;                        ///< of those within a leg
    const ErrorModel* model = nullptr;  ///< likewise
    std::int64_t group = 0;
    Eigen::Vector3d sum_W = Eigen::Vector3d::Zero();
    Eigen::Vector3d error_W = Eigen::Vector3d::Zero();  ///< at this station
    /// Of ended groups, where terms are asked for.
    Eigen::Matrix3d cov_closed_W = Eigen::Matrix3d::Zero();
    bool has_closed = false;
  };

  void Close(Source& source, std::int64_t group);

  const PropagateOptions& options_;
  Eigen::Matrix3d cov_tie_in_W_;
  std::vector<Source> sources_;
  std::vector<std::size_t> active_, resting_;
  std::vector<std::size_t> shared_;  ///< sources of result.shared
  /// Of all ended groups, and of sources that this leg does not have.
  Eigen::Matrix3d cov_ended_W_ = Eigen::Matrix3d::Zero(), cov_idle_W_ = cov_ended_W_;
};

}  // namespace wellgyro
