#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>

/// LCM's byte order, big-endian, at any alignment.
namespace wellgyro {

template <std::size_t kSize>
using UintOf = std::conditional_t<kSize == 8, std::uint64_t, std::uint32_t>;

constexpr std::uint32_t Swap(std::uint32_t v) { return __builtin_bswap32(v); }
constexpr std::uint64_t Swap(std::uint64_t v) { return __builtin_bswap64(v); }

template <class T>
T Load(const std::byte* from) {
  UintOf<sizeof(T)> bits;
  std::memcpy(&bits, from, sizeof bits);
  if constexpr (std::endian::native == std::endian::little) bits = Swap(bits);
  return std::bit_cast<T>(bits);
}

template <class T>
void Store(std::byte* to, T value) {
  auto bits = std::bit_cast<UintOf<sizeof(T)>>(value);
  if constexpr (std::endian::native == std::endian::little) bits = Swap(bits);
  std::memcpy(to, &bits, sizeof bits);
}

}  // namespace wellgyro
