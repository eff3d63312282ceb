#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include <fmt/format.h>

#include "wellgyro/base/result.h"
#include "wellgyro/base/time.h"
#include "wellgyro/bus/bytes_internal.h"
#include "wellgyro/bus/range_internal.h"

namespace wellgyro {

/// A named bit of a status word and the bool it stands for.
template <class Bool>
struct Bit {
  std::int32_t mask;
  Bool& on;
};
template <class Bool>
Bit(std::int32_t, Bool&) -> Bit<Bool>;

/// Reads fields one after the other. Past the end it reads zeros and goes on counting, so that at
/// the end the size that the message should have is known; the first field out of range is kept.
class FieldReader {
 public:
  /// Of a whole message, or of its beginning; the fields stand from byte `at` on.
  FieldReader(std::span<const std::byte> message, std::size_t at) : bytes_(message), at_(at) {}

  /// Microseconds since 1970 up to limits::kUtcUs; left as it was where out of range.
  void Utc(const char* name, UtcTime& time) {
    const auto us = Take<std::int64_t>();
    if (Require(IsUtc(us), name, us)) time.ns = us * 1000;
  }
  /// Any value.
  void Int(const char* /*name*/, std::int32_t& value) { value = Take<std::int32_t>(); }
  /// From 0 to limits::kCount, so that differences and sums of two stay inside 64 bits.
  template <class Integer>
  void Count(const char* name, Integer& value) {
    value = Take<Integer>();
    Require(IsCount(value), name, value);
  }
  /// In [least, most].
  template <class Integer>
  void Within(const char* name, Integer& value, Integer least, Integer most) {
    value = Take<Integer>();
    Require(value >= least && value <= most, name, value);
  }
  /// A count that is `n` where the message has such fields, else 0.
  void ZeroOr(const char* name, std::int32_t& value, std::int32_t n) {
    value = Take<std::int32_t>();
    Require(value == 0 || value == n, name, value);
  }
  /// A 32-bit word that must be 0 or 1.
  void Flag(const char* name, bool& value) {
    const auto word = Take<std::int32_t>();
    Require(word == 0 || word == 1, name, word);
    value = word == 1;
  }
  /// Bits that are not named are left alone: a released type may gain some.
  template <class... Bools>
  void Bits(const char* /*name*/, Bit<Bools>... bits) {
    const auto word = Take<std::int32_t>();
    ((bits.on = (word & bits.mask) != 0), ...);
  }
  /// An enumerator by its number; the value stays as it was where that is none of [first, last].
  template <class Enum>
  void Choice(const char* name, Enum& value, Enum first, Enum last) {
    const auto word = Take<std::int32_t>();
    const bool known =
        word >= static_cast<std::int32_t>(first) && word <= static_cast<std::int32_t>(last);
    if (Require(known, name, word)) value = static_cast<Enum>(word);
  }
  /// Non-finite values are out of range.
  template <class Real>
  void Number(const char* name, Real& value) {
    value = Take<Real>();
    Require(std::isfinite(value), name, value);
  }
  /// Finite and not negative, as a sigma or a length of time.
  void NotNegative(const char* name, double& value) {
    value = Take<double>();
    Require(std::isfinite(value) && value >= 0, name, value);
  }
  /// Where it is not present, its bytes are skipped without a look and the value is 0.
  void NumberIf(const char* name, bool present, double& value) {
    if (present) return Number(name, value);
    Take<double>();
    value = 0;
  }
  void NotNegativeIf(const char* name, bool present, double& value) {
    if (present) return NotNegative(name, value);
    Take<double>();
    value = 0;
  }
  /// As Number where present, skipped without a look where not.
  void Optional(const char* name, bool present, std::optional<double>& value) {
    present ? Number(name, value.emplace()) : NumberIf(name, false, ignored_);
  }
  void OptionalNotNegative(const char* name, bool present, std::optional<double>& value) {
    present ? NotNegative(name, value.emplace()) : NumberIf(name, false, ignored_);
  }
  /// The value stays absent where it is not present.
  void OptionalInt(const char* /*name*/, bool present, std::optional<std::int32_t>& value) {
    const auto word = Take<std::int32_t>();
    if (present) value = word;
  }
  void OptionalCount(const char* name, bool present, std::optional<std::int64_t>& value) {
    const auto count = Take<std::int64_t>();
    if (present && Require(IsCount(count), name, count)) value = count;
  }
  /// LCM's string: its length with the closing NUL, its bytes, the NUL.
  void String(const char* name, std::string& text) {
    const auto length = Take<std::int32_t>();
    if (at_ > bytes_.size()) {
      ++at_;  // at least the NUL
      return;
    }
    if (!Require(length >= 1, name, length)) {
      stopped_ = true;
      return;
    }
    const std::size_t begin = at_;
    at_ += static_cast<std::size_t>(length);
    if (at_ > bytes_.size() || stopped_) return;
    const auto* chars = reinterpret_cast<const char*>(bytes_.data() + begin);
    text.assign(chars, static_cast<std::size_t>(length) - 1);
    Require(chars[length - 1] == '\0', name, "a string without its closing NUL");
    Require(text.find('\0') == std::string::npos, name, "a string with a NUL inside");
  }

  /// LCM's bytes, of which `n` was given before.
  void Bytes(const char* /*name*/, std::vector<std::byte>& bytes, std::int32_t n) {
    const std::size_t begin = at_;
    at_ += n > 0 ? static_cast<std::size_t>(n) : 0;
    if (at_ > bytes_.size() || stopped_) return;
    bytes.assign(bytes_.begin() + static_cast<std::ptrdiff_t>(begin),
                 bytes_.begin() + static_cast<std::ptrdiff_t>(at_));
  }

  /// Call after the last field: what was wrong, size first. A string's length that makes no sense
  /// hides where the rest stands, and is reported instead of the size.
  std::optional<Fault> Finish() {
    if (!stopped_ && at_ != bytes_.size()) {
      return Fault{FaultCode::kSize,
                   fmt::format("has {} bytes, its type and counts give {}", bytes_.size(), at_),
                   {},
                   static_cast<std::int64_t>(bytes_.size() < at_ ? bytes_.size() : at_)};
    }
    return std::move(fault_);
  }

 private:
  template <class T>
  T Take() {
    field_ = at_;
    at_ += sizeof(T);
    return at_ <= bytes_.size() && !stopped_ ? Load<T>(bytes_.data() + field_) : T{};
  }

  template <class T>
  bool Require(bool good, const char* name, const T& value) {
    if (!good && !fault_) {
      fault_ = Fault{FaultCode::kRange,
                     fmt::format("{} = {} is out of range", name, value),
                     {},
                     static_cast<std::int64_t>(field_)};
    }
    return good;
  }

  std::span<const std::byte> bytes_;
  std::size_t at_;         // where the next field begins
  std::size_t field_ = 0;  // where the last one began
  bool stopped_ = false;
  double ignored_ = 0;
  std::optional<Fault> fault_;
};

}  // namespace wellgyro
