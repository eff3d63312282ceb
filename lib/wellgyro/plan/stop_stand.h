#pragma once

#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/plan/stop_information.h"

namespace wellgyro {

/// What a set of stops comes to.
struct PlanValue {
  double ellipse = 0;  ///< semi-major axis of the end's 95 % ellipse [m]
  double hidden = 0;   ///< largest horizontal shift of the end that stays unseen [m]
  /// The largest of both by their limits, smooth: what a search goes down.
  double soft = 0;
  bool Meets(double ellipse_limit, double hidden_limit) const {
    return ellipse <= ellipse_limit && hidden <= hidden_limit;
  }
};

/// A run with the stops made so far, at some of the places of a StopInformation, to which rest is
/// added and from which it is taken back.
class StopStand {
 public:
  struct Rest {
    std::size_t place = 0;  ///< of the information
    double turn = 0;        ///< of the tool against how it comes [rad]
    double seconds = 0;
  };

  /// `hidden_limit` HUGE_VAL: faults do not count. `info` must outlive this object.
  StopStand(const StopInformation& info, double ellipse_limit, double hidden_limit);

  /// The value as it stands, and with `rest` too; negative seconds take away. Where `soft` is above
  /// `soft_most` it may be infinite, and `hidden` not the largest: that is found out sooner.
  PlanValue Value() const;
  PlanValue ValueWith(const Rest& rest, double soft_most = HUGE_VAL) const;
  void Add(const Rest& rest);
  /// Forgets all places but these, and those with stops.
  void Keep(std::span<const std::size_t> places);

  std::span<const Rest> stops() const { return stops_; }
  std::span<const std::size_t> places() const { return places_; }
  double at_rest() const;  ///< [s]
  bool Meets() const { return Value().Meets(ellipse_limit_, hidden_limit_); }
  bool MeetsWith(const Rest& rest) const {
    return ValueWith(rest).Meets(ellipse_limit_, hidden_limit_);
  }

 private:
  using Pair = Eigen::Matrix<double, Eigen::Dynamic, 2>;
  using Basis = Eigen::Matrix<double, StopInformation::kBasis, StopInformation::kBasis>;
  /// The two rows of a rest, mix times those of its place.
  struct Rows {
    Eigen::Matrix<double, 2, StopInformation::kBasis> mix;
    Eigen::Index place = 0;            ///< first row of its place
    Eigen::Matrix2d with_end, weight;  ///< C, (S + V)^-1
  };
  Rows RowsOf(const Rest& rest) const;
  Basis Own(Eigen::Index place) const;
  /// Covariance of row `i`, which stands before those of all places, with the rows of a rest.
  Eigen::Vector2d With(const Rows& rest, Eigen::Index i) const;
  Pair WithAll(const Rows& rest) const;
  Eigen::Matrix2d End() const;
  PlanValue ValueOf(const Eigen::Matrix2d& end, const Rows* rest, double soft_most) const;
  void Order();
  /// What a fault may do unseen; never more than the largest that is looked for.
  double Hidden(const HiddenFault& fault, double variance, const Eigen::Vector2d& with_end) const;
  static double Largest(const HiddenFault& fault, const Eigen::Vector2d& with_end);

  const StopInformation* info_;
  double ellipse_limit_, hidden_limit_;
  std::vector<std::size_t> places_;
  std::vector<Eigen::Index> row_;    ///< of each place of the information; -1: forgotten
  Eigen::MatrixXd covariance_;       ///< its upper triangle
  std::vector<std::size_t> faults_;  ///< that which hides the most first
  std::vector<Rest> stops_;
};

}  // namespace wellgyro
