#include "capi/random_calls.h"

#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "wellgyro.h"

namespace wellgyro::support {
namespace {

constexpr const char* kJob =
    "format = \"wellgyro.job/1\"\n[well]\nlatitude_deg = 60\n[stations]\nevery_m = 1\n";

class Caller {
 public:
  explicit Caller(std::uint64_t seed) : random_(seed) {}
  ~Caller() {
    for (wellgyro_session* session : sessions_) wellgyro_close(session);
  }
  Caller(const Caller&) = delete;
  Caller& operator=(const Caller&) = delete;

  bool CallOnce() {
    wellgyro_session*& session = sessions_[Below(sessions_.size())];
    switch (Below(11)) {
      case 0:
        return Open(session);
      case 1:
        return Depth(session);
      case 2:
        return Poll(session);
      case 3:  // the one that takes long
        return Below(40) == 0 && wellgyro_adjust(session) != WELLGYRO_OK;
      case 4:
        return Below(20) == 0 && wellgyro_finish(session) != WELLGYRO_OK;
      case 5:
        return Csv(session);
      case 6:
        return Judge(session);
      case 7:
        wellgyro_refused(session);
        return std::string(wellgyro_error(session)).size() > 1'000'000;
      default:
        return Samples(session);
    }
  }

 private:
  std::size_t Below(std::size_t end) {
    return std::uniform_int_distribution<std::size_t>(0, end - 1)(random_);
  }

  double Odd(double usual) {
    switch (Below(200)) {
      case 0:
        return std::numeric_limits<double>::quiet_NaN();
      case 1:
        return std::numeric_limits<double>::infinity();
      case 2:
        return -1e300;
      default:
        return usual;
    }
  }

  std::int64_t OddTime(std::int64_t usual) {
    switch (Below(200)) {
      case 0:
        return std::numeric_limits<std::int64_t>::min();
      case 1:
        return std::numeric_limits<std::int64_t>::max();
      default:
        return usual;
    }
  }

  bool Open(wellgyro_session*& session) {
    if (session && Below(10) != 0) return false;
    wellgyro_close(session);
    session = nullptr;
    clock_ = 0;
    switch (Below(8)) {
      case 0:
        return wellgyro_open_text(nullptr, ".", &session) != WELLGYRO_OK;
      case 1:
        return wellgyro_open_text("format = 1", ".", &session) != WELLGYRO_OK;
      case 2:
        return wellgyro_open("no/such/job.toml", &session) != WELLGYRO_OK;
      case 3:
        return wellgyro_open_text(kJob, ".", nullptr) != WELLGYRO_OK;
      default:
        return wellgyro_open_text(kJob, ".", &session) != WELLGYRO_OK;
    }
  }

  bool Samples(wellgyro_session* session) {
    std::vector<wellgyro_imu> samples(Below(20));
    for (wellgyro_imu& sample : samples) {
      sample = {};
      sample.tool_ns = OddTime(clock_ * 100'000'000);
      sample.utime_us = OddTime(clock_ * 100'000);
      sample.seq = OddTime(clock_++);
      sample.period_ns = Below(300) == 0 ? -1 : 100'000'000;
      sample.flags = static_cast<std::uint32_t>(Below(50) == 0 ? Below(256) : 0);
      sample.tool = Below(100) == 0 ? static_cast<std::int32_t>(Below(1000)) : 0;
      for (double& v : sample.rate_rad_per_s) v = Odd(7e-5);
      sample.force_mps2[0] = Odd(4.9);
      sample.force_mps2[2] = Odd(-8.5);
    }
    const bool null = Below(50) == 0;
    return wellgyro_push_imu(session, null ? nullptr : samples.data(), samples.size()) !=
           WELLGYRO_OK;
  }

  bool Depth(wellgyro_session* session) {
    wellgyro_depth mark{};
    mark.utime_us = OddTime(clock_ * 100'000);
    mark.seq = clock_;
    mark.md_m = Odd(100 + 0.05 * static_cast<double>(clock_));
    mark.sigma_m = Odd(-1);
    mark.kind = static_cast<std::int32_t>(Below(10)) - 2;
    return wellgyro_push_depth(session, Below(50) == 0 ? nullptr : &mark, 1) != WELLGYRO_OK;
  }

  bool Poll(wellgyro_session* session) {
    std::array<wellgyro_station, 4> stations{};
    std::array<wellgyro_directed_station, 4> directed{};
    std::size_t count = 0;
    std::size_t* const counted = Below(50) == 0 ? nullptr : &count;
    const bool null = Below(50) == 0;
    if (Below(2) == 0) {
      return wellgyro_poll(session, null ? nullptr : stations.data(), Below(5), counted) !=
             WELLGYRO_OK;
    }
    return wellgyro_poll_directed(session, null ? nullptr : directed.data(), Below(5), counted) !=
           WELLGYRO_OK;
  }

  bool Judge(wellgyro_session* session) {
    std::array<char, 4000> causes{};
    std::int32_t verdict = 0;
    std::size_t size = 0;
    const bool null = Below(50) == 0;
    return wellgyro_verdict(session, static_cast<std::int32_t>(Below(3)),
                            Below(50) == 0 ? nullptr : &verdict, null ? nullptr : causes.data(),
                            Below(2) == 0 ? 1 : causes.size(),
                            Below(50) == 0 ? nullptr : &size) != WELLGYRO_OK;
  }

  bool Csv(wellgyro_session* session) {
    std::vector<char> text(Below(2) == 0 ? 10 : 100'000);
    std::size_t size = 0;
    return wellgyro_survey_csv(session, static_cast<std::int32_t>(Below(3)), text.data(),
                               text.size(), &size) != WELLGYRO_OK;
  }

  std::mt19937_64 random_;
  std::array<wellgyro_session*, 3> sessions_{};
  std::int64_t clock_ = 0;
};

}  // namespace

std::int64_t CallAtRandom(std::uint64_t seed, std::int64_t calls) {
  Caller caller(seed);
  std::int64_t refused = 0;
  for (std::int64_t i = 0; i < calls; ++i) refused += caller.CallOnce() ? 1 : 0;
  return refused;
}

}  // namespace wellgyro::support
