#pragma once

#include <array>
#include <cstddef>

/// How a tool rolls, for VerticalFilter.
namespace wellgyro::vertical {

/// Walks of the rate about the axis, a decade apart [rad/s/sqrt(s)].
inline constexpr std::array<double, 5> kWalks = {1e-5, 1e-4, 1e-3, 1e-2, 1e-1};
using PerWalk = std::array<double, kWalks.size()>;

/// How much the rate about the tool's axis walks: weights of the walks by how likely each makes
/// what is seen. What was learned is forgotten over minutes.
class RollWalk {
 public:
  void Reset();
  /// Logarithms of the likelihoods of a stretch of `seconds`.
  void Weigh(const PerWalk& likelihood, double seconds);
  /// Time in which nothing was seen.
  void Pass(double seconds);
  /// A walk without weight for so long that a filter with it should begin anew. Says so once.
  bool TakeIdle(std::size_t i);

  double mean() const;  ///< of the walks as decades [rad/s/sqrt(s)]
  /// The walk over `seconds` in which nothing is seen: there it may become another one, and the
  /// largest counts for most.
  double Over(double seconds) const;

 private:
  void Forget(double part);

  PerWalk weight_{}, idle_{};  // [1]; how long without weight [s]
};

}  // namespace wellgyro::vertical
