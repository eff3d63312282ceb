#include <cstdlib>
#include <span>
#include <string>

#include <sys/mman.h>
#include <unistd.h>

#include "wellgyro/bus/log_reader.h"

#include "fuzz/fuzz.h"

// The input is a log. Every byte of it must be in an event, in a gap or in the cut end.

namespace wellgyro {
namespace {

void Require(bool good) {
  if (!good) std::abort();
}

void Check(const std::string& path, std::size_t size) {
  Result<LogReader> reader = LogReader::Open(path);
  if (!reader) return Require(!reader.fault().text.empty());
  LogEvent event;
  std::int64_t used = 0;
  unsigned sum = 0;
  while (reader->Next(event)) {
    used += 28 + static_cast<std::int64_t>(event.channel.size() + event.data.size());
    for (const std::byte b : event.data) sum += std::to_integer<unsigned>(b);
  }
  const LogHealth& health = reader->health();
  const std::int64_t cut = health.cut ? health.cut->length : 0;
  Require(used + health.lost_bytes + cut == static_cast<std::int64_t>(size));
  Require(health.bytes == static_cast<std::int64_t>(size));
  Require(sum < ~0u);
  Require(reader->Faults().empty() == (health.lost_bytes == 0 && !health.cut));
}

void Append(std::vector<std::uint8_t>& log, std::uint8_t number, const std::string& channel,
            std::uint8_t size) {
  log.insert(log.end(), {0xED, 0xA1, 0xDA, 0x01, 0, 0, 0, 0, 0, 0, 0, number});
  log.insert(log.end(), 8, number);
  log.insert(log.end(), {0, 0, 0, static_cast<std::uint8_t>(channel.size()), 0, 0, 0, size});
  log.insert(log.end(), channel.begin(), channel.end());
  for (std::uint8_t i = 0; i < size; ++i) log.push_back(static_cast<std::uint8_t>(0xE0 + i));
}

}  // namespace

namespace fuzz {

std::vector<std::vector<std::uint8_t>> Seeds() {
  std::vector<std::vector<std::uint8_t>> seeds(2);
  for (std::uint8_t i = 0; i < 5; ++i) {
    Append(seeds[0], i, "WELLGYRO_IMU", static_cast<std::uint8_t>(30 * i));
    Append(seeds[1], static_cast<std::uint8_t>(3 * i), "X", 20);
  }
  return seeds;
}

}  // namespace fuzz
}  // namespace wellgyro

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const int file = memfd_create("log", MFD_CLOEXEC);
  if (file < 0 || ::write(file, data, size) != static_cast<ssize_t>(size)) std::abort();
  wellgyro::Check("/proc/self/fd/" + std::to_string(file), size);
  ::close(file);
  return 0;
}
