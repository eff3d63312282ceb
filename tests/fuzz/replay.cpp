#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>

#include "fuzz/fuzz.h"

namespace {

using Input = std::vector<std::uint8_t>;

constexpr std::uint32_t kSeed = 20260101;
constexpr std::size_t kChanges = 3000;  // of each input

/// An allocation of exactly the input's size, so that the sanitizers see what lies behind it.
void Run(const Input& input) {
  Input exact(input.size());
  std::copy(input.begin(), input.end(), exact.begin());
  LLVMFuzzerTestOneInput(exact.data(), exact.size());
}

std::size_t Below(std::mt19937& random, std::size_t bound) { return bound ? random() % bound : 0; }

void Change(Input& input, const Input& other, std::mt19937& random) {
  const std::size_t at = Below(random, input.size());
  const auto place = input.begin() + static_cast<std::ptrdiff_t>(at);
  const std::size_t rest = input.size() - at;
  switch (random() % 6) {
    case 0:  // a bit
      if (rest > 0) input[at] ^= static_cast<std::uint8_t>(1u << (random() % 8));
      break;
    case 1: {  // an awkward byte, four times
      const std::uint8_t bytes[] = {0x00, 0xFF, 0x7F, 0x80, 0x01};
      const std::uint8_t byte = bytes[random() % 5];
      std::fill_n(place, std::min<std::size_t>(rest, 4), byte);
      break;
    }
    case 2:  // an end too early
      input.resize(at);
      break;
    case 3:  // something gone
      input.erase(place, place + static_cast<std::ptrdiff_t>(Below(random, rest + 1)));
      break;
    case 4: {  // a piece of another input
      const std::size_t from = Below(random, other.size());
      const std::size_t size = Below(random, other.size() - from + 1);
      const auto begin = other.begin() + static_cast<std::ptrdiff_t>(from);
      input.insert(place, begin, begin + static_cast<std::ptrdiff_t>(size));
      break;
    }
    default:  // something more
      input.insert(place, 1 + random() % 8, static_cast<std::uint8_t>(random()));
  }
}

}  // namespace

/// replay-NAME [CORPUS [RUNS [BYTES]]]: at least so many inputs, of so many bytes in all.
int main(int argc, char** argv) {
  std::vector<Input> inputs = wellgyro::fuzz::Seeds();
  if (argc > 1 && std::filesystem::is_directory(argv[1])) {
    for (const auto& entry : std::filesystem::directory_iterator(argv[1])) {
      std::ifstream file(entry.path(), std::ios::binary);
      inputs.emplace_back(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
    }
  }
  std::sort(inputs.begin(), inputs.end());
  const double runs_wanted =
      argc > 2 ? std::atof(argv[2]) : static_cast<double>(kChanges * inputs.size());
  const double bytes_wanted = argc > 3 ? std::atof(argv[3]) : 0;
  std::mt19937 random(kSeed);
  Run({});
  double runs = 0, bytes = 0;
  while (runs < runs_wanted || bytes < bytes_wanted) {
    for (const Input& input : inputs) {
      Input changed = input;
      const std::size_t times = runs < static_cast<double>(inputs.size()) ? 0 : 1 + random() % 4;
      for (std::size_t k = 0; k < times; ++k) {
        Change(changed, inputs[Below(random, inputs.size())], random);
      }
      Run(changed);
      ++runs;
      bytes += static_cast<double>(changed.size());
    }
  }
  std::printf("%zu inputs, changed and run %.0f times, %.0f bytes, seed %u\n", inputs.size(), runs,
              bytes, kSeed);
  return 0;
}
