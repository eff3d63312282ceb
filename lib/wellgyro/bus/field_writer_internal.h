#pragma once

#include <cmath>
#include <cstdint>
#include <iterator>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "wellgyro/base/time.h"
#include "wellgyro/bus/bytes_internal.h"
#include "wellgyro/bus/field_reader_internal.h"
#include "wellgyro/bus/range_internal.h"

namespace wellgyro {

/// Writes fields one after the other; the mirror of FieldReader. Throws std::invalid_argument,
/// naming the field, for what a reader would refuse.
class FieldWriter {
 public:
  explicit FieldWriter(std::vector<std::byte>& bytes) : bytes_(bytes) {}

  /// Whole microseconds since 1970, rounded down; up to limits::kUtcUs.
  void Utc(const char* name, UtcTime time) {
    const std::int64_t us = time.ns / 1000;
    Require(IsUtc(us) && time.ns >= 0, name, time.ns);
    Put(us);
  }
  /// Any value.
  void Int(const char* /*name*/, std::int32_t value) { Put(value); }
  /// From 0 to limits::kCount.
  template <class Integer>
  void Count(const char* name, Integer value) {
    Require(IsCount(value), name, value);
    Put(value);
  }
  /// In [least, most].
  template <class Integer>
  void Within(const char* name, Integer value, Integer least, Integer most) {
    Require(value >= least && value <= most, name, value);
    Put(value);
  }
  /// A count of values that a message has for all of its `n` samples or for none.
  void ZeroOr(const char* name, std::int32_t value, std::int32_t n) {
    Require(value == 0 || value == n, name, value);
    Put(value);
  }
  /// A 32-bit 0 or 1, as LCM has no type for it that every language reads alike.
  void Flag(const char* /*name*/, bool value) { Put(std::int32_t{value}); }
  /// A word of status bits; those that are not named are 0.
  template <class... Bools>
  void Bits(const char* /*name*/, Bit<Bools>... bits) {
    std::int32_t word = 0;
    ((word |= bits.on ? bits.mask : 0), ...);
    Put(word);
  }
  /// An enumerator by its number, in [first, last].
  template <class Enum>
  void Choice(const char* name, Enum value, Enum first, Enum last) {
    const auto word = static_cast<std::int32_t>(value);
    Require(value >= first && value <= last, name, word);
    Put(word);
  }
  /// Finite: NaN and infinity do not travel.
  template <class Real>
  void Number(const char* name, Real value) {
    Require(std::isfinite(value), name, value);
    Put(value);
  }
  /// Finite and not negative, as a sigma or a length of time.
  void NotNegative(const char* name, double value) {
    Require(std::isfinite(value) && value >= 0, name, value);
    Put(value);
  }
  /// 0 where it is not present, whatever the record holds there.
  void NumberIf(const char* name, bool present, double value) {
    Number(name, present ? value : 0.0);
  }
  void NotNegativeIf(const char* name, bool present, double value) {
    NotNegative(name, present ? value : 0.0);
  }
  /// 0 where it is absent; the flag for it is a field of its own.
  void Optional(const char* name, bool /*present*/, const std::optional<double>& value) {
    Number(name, value.value_or(0.0));
  }
  void OptionalNotNegative(const char* name, bool /*present*/, const std::optional<double>& value) {
    NotNegative(name, value.value_or(0.0));
  }
  void OptionalInt(const char* /*name*/, bool /*present*/,
                   const std::optional<std::int32_t>& value) {
    Put(value.value_or(0));
  }
  void OptionalCount(const char* name, bool /*present*/, const std::optional<std::int64_t>& value) {
    Count(name, value.value_or(std::int64_t{0}));
  }
  /// LCM's string: its length with the closing NUL, its bytes, the NUL. Below kStringMax, without a
  /// NUL inside.
  void String(const char* name, const std::string& text) {
    Require(text.size() < kStringMax, name, text.size());
    Require(text.find('\0') == std::string::npos, name, "a string with a NUL inside");
    Put(static_cast<std::int32_t>(text.size() + 1));
    const auto* bytes = reinterpret_cast<const std::byte*>(text.c_str());
    bytes_.insert(bytes_.end(), bytes, bytes + text.size() + 1);
  }

  /// Bytes whose number `n` was written before.
  void Bytes(const char* name, const std::vector<std::byte>& bytes, std::int32_t n) {
    Require(std::ssize(bytes) == n, name, bytes.size());
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
  }

 private:
  /// [bytes]: far above any text of ours, and LCM's lengths, int32, hold it.
  static constexpr std::size_t kStringMax = std::size_t{1} << 24;

  template <class T>
  void Put(T value) {
    bytes_.resize(bytes_.size() + sizeof value);
    Store(bytes_.data() + bytes_.size() - sizeof value, value);
  }

  template <class T>
  static void Require(bool good, const char* name, const T& value) {
    if (!good) throw std::invalid_argument(fmt::format("{} = {} is out of range", name, value));
  }

  std::vector<std::byte>& bytes_;
};

}  // namespace wellgyro
