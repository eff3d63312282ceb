#include "wellgyro/live/finish_wait.h"

#include "wellgyro/live/observer.h"

namespace wellgyro {
namespace {

constexpr std::int64_t kFinishPatienceUs = 5 * kSecondUs;

}  // namespace

bool FinishWait::IsOver(const Intake& intake, std::int64_t now_us) {
  const std::int64_t messages = intake.sample_messages();
  if (messages != messages_ || last_us_ == 0) {
    messages_ = messages;
    last_us_ = now_us;
  }
  return intake.operations().finish_obeyed() && now_us - last_us_ > kFinishPatienceUs;
}

}  // namespace wellgyro
