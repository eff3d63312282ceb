#include "wellgyro/live/adviser.h"

#include <algorithm>
#include <exception>
#include <utility>
#include <vector>

#include "wellgyro/live/observer.h"

namespace wellgyro {
namespace {

constexpr std::int64_t kEveryUs = 2 * kSecondUs;  // two statuses: nobody acts on it sooner

}  // namespace

Adviser::Adviser(const AdviceCase& advised) : case_(advised), thread_([this] { Work(); }) {}

Adviser::~Adviser() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
    changed_.notify_all();
  }
  thread_.join();
}

std::optional<Advice> Adviser::Attend(const Surveyor& surveyor, std::int64_t now_us) {
  std::optional<Advice> advice = Take();
  if (now_us < next_us_) return advice;
  const std::vector<std::int32_t> tools = surveyor.tools();
  const std::optional<UtcTime> newest = surveyor.tally().newest;
  if (tools.empty() || !newest || newest->ns <= 0) return advice;
  if (Ask(NowOf(surveyor, tools.front()), *newest)) next_us_ = now_us + kEveryUs;
  return advice;
}

bool Adviser::Ask(const RunNow& now, UtcTime newest) {
  const std::lock_guard lock(mutex_);
  if (busy_) return false;
  if (now.run != now_.run) deepest_ = 0;
  now_ = now;
  if (now.state != nullptr) {
    state_ = *now.state;
    now_.state = &state_;
  }
  newest_ = newest;
  busy_ = true;
  changed_.notify_all();
  return true;
}

std::optional<Advice> Adviser::Take() {
  const std::lock_guard lock(mutex_);
  return std::exchange(advice_, std::nullopt);
}

/// What cannot be advised is no reason to end a survey.
Advice Adviser::Answer() const {
  Advice advice;
  try {
    advice = Advise(case_.c, case_.limits, AskingOf(now_, newest_, deepest_));
  } catch (const std::exception& error) {
    advice.text = error.what();
  }
  advice.utc = newest_;
  advice.run = now_.run;
  return advice;
}

void Adviser::Work() {
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [this] { return busy_ || ending_; });
    if (ending_) return;
    lock.unlock();
    Advice advice = Answer();
    lock.lock();
    deepest_ = std::max(deepest_, now_.md.value_or(0));
    advice_ = std::move(advice);
    busy_ = false;
  }
}

}  // namespace wellgyro
