#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

/// What a fuzz target defines. With libFuzzer (WELLGYRO_FUZZERS, clang) it explores; in every build
/// it is replayed: its seeds, the files of corpus/NAME, and a fixed number of changes of each.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace wellgyro::fuzz {

/// Good inputs to start from.
std::vector<std::vector<std::uint8_t>> Seeds();

}  // namespace wellgyro::fuzz
