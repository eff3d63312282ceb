#include "wellgyro/survey/intake/mark_gate.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include <fmt/core.h>

namespace wellgyro {

bool MarkGate::IsAhead(UtcTime utc) const {
  if (!heard_) return !open_;
  const UtcTime newest = passed_ ? std::max(*heard_, *passed_) : *heard_;
  return utc > newest + ahead_;
}

void MarkGate::Push(const DepthMark& mark) {
  if (!IsAhead(mark.utc)) {
    Release(mark.utc);
    Pass(mark);
    if (!aside_.empty()) Overtake();
    return;
  }
  aside_.emplace(mark.utc, Aside{mark});
  if (aside_.size() <= kAsideMax) return;
  // Without samples there is nothing by which to tell the wrong from the true.
  if (!heard_) return Open();
  const auto last = std::prev(aside_.end());
  TellOf(last->second.mark, Ahead(last->first));
  aside_.erase(last);
}

void MarkGate::Pass(const DepthMark& mark) {
  passed_ = passed_ ? std::max(*passed_, mark.utc) : mark.utc;
  use_(mark);
}

void MarkGate::HeardAt(UtcTime utc) {
  if (!heard_) LeaveOutBefore(utc);
  heard_ = utc;
  Release(utc);
}

void MarkGate::Release(UtcTime utc) {
  while (!aside_.empty() && aside_.begin()->first <= utc) {
    const DepthMark mark = aside_.begin()->second.mark;
    aside_.erase(aside_.begin());
    Pass(mark);
  }
}

void MarkGate::Overtake() {
  for (auto at = aside_.begin(); at != aside_.end();) {
    if (++at->second.overtaken < kOthers) {
      ++at;
      continue;
    }
    TellOf(at->second.mark, Ahead(at->first));
    at = aside_.erase(at);
  }
}

/// Those that no chain of marks joins to the first sample.
void MarkGate::LeaveOutBefore(UtcTime first) {
  UtcTime joined = first;
  auto at = aside_.upper_bound(first);
  while (at != aside_.begin() && joined - std::prev(at)->first <= max_gap_) {
    joined = (--at)->first;
  }
  for (auto old = aside_.begin(); old != at; old = aside_.erase(old)) {
    const double seconds = (first - old->first).seconds();
    TellOf(old->second.mark,
           fmt::format("{:.0f} s before the first sample, without others between", seconds));
  }
}

std::string MarkGate::Ahead(UtcTime utc) const {
  const UtcTime newest = passed_ ? std::max(*heard_, *passed_) : *heard_;
  return fmt::format("{:.0f} s ahead of the samples and of all other marks",
                     (utc - newest).seconds());
}

void MarkGate::TellOf(const DepthMark& mark, std::string_view wrong) {
  tell_({.code = FaultCode::kRange,
         .text = fmt::format("a depth mark at utime_us {} is {} and was left out",
                             mark.utc.ns / 1000, wrong)});
}

void MarkGate::Open() {
  open_ = true;
  if (heard_) return;
  for (auto& [utc, aside] : std::exchange(aside_, {})) Pass(aside.mark);
}

void MarkGate::Close() {
  if (!heard_) return Open();
  for (const auto& [utc, aside] : std::exchange(aside_, {})) {
    // Of the last batch the marks may be a little further than the samples.
    if (utc <= *heard_ + ahead_) {
      Pass(aside.mark);
    } else {
      TellOf(aside.mark, Ahead(utc));
    }
  }
}

}  // namespace wellgyro
