#include <cstdint>
#include <stdexcept>
#include <string>

#include "wellgyro/attitude/tracker.h"

namespace wellgyro {

void HighSideTracker::AddUnseen(const AlongHole& along, double angle, double variance) {
  CloseBlock(along);
  observed_.noise.Widen(variance);
  unseen_.Add(angle);
  unseen_here_ += angle;
  var_unseen_ += variance;
  // The line fitted to the level is worth no more than what that may have changed it by.
  const double noise = options_.accel_noise * inverse_gravity_;
  const double spread = variance * memory_.seconds;
  if (spread > 0) {
    memory_.Shorten(4 * noise * noise / (4 * noise * noise + spread));
  }
}

Knot HighSideTracker::CutGap(Duration into) {
  Seen& next = seen_[newest_];
  const std::int64_t ns = into.ns - gap_cut_ns_;
  if (!waiting_ || !ready_ || ns < 0 || ns > next.gap_ns) {
    throw std::invalid_argument("CutGap: no gap waits that is cut by " +
                                std::to_string(into.seconds()) + " s");
  }
  const double share = ns > 0 ? static_cast<double>(ns) / static_cast<double>(next.gap_ns) : 0;
  const double variance = share * next.var_unseen_before;
  AddUnseen(last().along, share * next.unseen_before, variance);
  next.unseen_before -= share * next.unseen_before;
  next.var_unseen_before -= variance;
  next.gap_ns -= ns;
  gap_cut_ns_ = into.ns;
  ns_ += ns;
  gap_ns_ += ns;
  quality_ |= Quality::kGap;
  Knot knot = CutKnot(1.0);
  knot.time = knot.time + into;
  knot.utc = knot.utc + into;
  return knot;
}

}  // namespace wellgyro
