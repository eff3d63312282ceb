#include "wellgyro/survey/run/run_book.h"

#include <algorithm>
#include <cstddef>
#include <limits>

namespace wellgyro {
namespace {

// Every sample looks them through; more come from a broken sender alone.
constexpr std::size_t kEventsMax = 2000;

/// Behind the last number there is they begin anew.
std::int32_t NextTo(std::int32_t number) {
  return number < std::numeric_limits<std::int32_t>::max() ? number + 1 : 1;
}

}  // namespace

RunBook::RunBook(const std::vector<RunSpec>& runs) : specs_(runs) {
  for (const RunSpec& run : runs) {
    if (run.begin) begins_.push_back({*run.begin, run.number, true, {}});
  }
  std::stable_sort(begins_.begin(), begins_.end(),
                   [](const Begin& a, const Begin& b) { return a.utc < b.utc; });
}

void RunBook::Take(const Event& event) {
  if (begins_.size() + ends_.size() >= kEventsMax) return;
  if (event.kind == Event::Kind::kRunBegin) {
    const auto after = std::upper_bound(begins_.begin(), begins_.end(), event.utc,
                                        [](UtcTime utc, const Begin& b) { return utc < b.utc; });
    begins_.insert(after, {event.utc, event.run, false, event.text});
  } else if (event.kind == Event::Kind::kRunEnd) {
    ends_.push_back({event.utc, event.run, event.what == "misrun", event.text});
  }
}

void RunBook::HeardAt(UtcTime utc) {
  if (!heard_ || utc < *heard_) heard_ = utc;
}

std::int32_t RunBook::RunBegunBy(UtcTime utc) const {
  // The job says of its runs when they begin: what is earlier still belongs to the first of them.
  const bool before_first = heard_ && *heard_ < begins_.front().utc;
  if (utc < begins_.front().utc) return begins_.front().of_job ? begins_.front().number : 1;
  std::int32_t number = before_first ? 1 : 0;
  for (const Begin& begin : begins_) {
    if (utc < begin.utc) break;
    number = begin.number > 0 ? begin.number : NextTo(number);
  }
  return number;
}

bool RunBook::EndedBySpec(std::int32_t run, UtcTime utc) const {
  return std::any_of(specs_.begin(), specs_.end(), [&](const RunSpec& spec) {
    return spec.number == run && spec.end && utc >= *spec.end;
  });
}

bool RunBook::Changes(UtcTime first, UtcTime last) const {
  const auto between = [&](UtcTime utc) { return first < utc && utc <= last; };
  return std::any_of(begins_.begin(), begins_.end(),
                     [&](const Begin& begin) { return between(begin.utc); }) ||
         std::any_of(specs_.begin(), specs_.end(),
                     [&](const RunSpec& spec) { return spec.end && between(*spec.end); });
}

bool RunBook::misrun(std::int32_t run) const {
  const bool by_job = std::any_of(specs_.begin(), specs_.end(), [run](const RunSpec& spec) {
    return spec.number == run && spec.misrun;
  });
  return by_job || std::any_of(ends_.begin(), ends_.end(), [&](const End& end) {
           return end.misrun && RunAt(end.utc, end.told) == run;
         });
}

std::string RunBook::remark(std::int32_t run) const {
  for (const RunSpec& spec : specs_) {
    if (spec.number == run && !spec.remark.empty()) return spec.remark;
  }
  for (const End& end : ends_) {
    if (!end.remark.empty() && RunAt(end.utc, end.told) == run) return end.remark;
  }
  for (const Begin& begin : begins_) {
    if (!begin.remark.empty() && RunAt(begin.utc, 0) == run) return begin.remark;
  }
  return {};
}

}  // namespace wellgyro
