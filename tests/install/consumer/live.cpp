// A vendor's live program: live JOB URL OUT LOG. Killed, it goes on from its log when it is started
// again.
#include <chrono>
#include <cstdio>
#include <filesystem>

#include <wellgyro/live/session.h>

int main(int, char** argv) {
  const auto job = wellgyro::ReadJob(argv[1]);
  wellgyro::LiveSetup setup{.job = *job, .url = argv[2], .out = argv[3], .record = argv[4]};
  setup.resume = std::filesystem::exists(setup.record);
  setup.clock.utc_us = [] {
    return std::chrono::system_clock::now().time_since_epoch() / std::chrono::microseconds(1);
  };
  setup.clock.monotonic_us = [] {
    return std::chrono::steady_clock::now().time_since_epoch() / std::chrono::microseconds(1);
  };
  wellgyro::LiveObserver observer;
  auto session = wellgyro::LiveSession::Open(setup, observer);
  if (!session) return std::puts(SentenceOf(session.fault()).c_str());
  return (*session)->Run().usable() ? 0 : 1;
}
