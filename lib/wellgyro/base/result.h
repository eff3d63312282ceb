#pragma once

#include <cassert>
#include <cstdint>
#include <string>
#include <utility>
#include <variant>

#include "wellgyro/base/export.h"

/// @file
/// A value, or what was wrong with foreign data that should have given it.
namespace wellgyro {

/// What kind of thing was wrong with bytes that came from outside.
enum class FaultCode {
  kIo,           ///< the system refused to read or write
  kForeign,      ///< not a file or message of ours at all
  kFingerprint,  ///< message type other than expected
  kSize,         ///< size does not follow from the counts
  kRange,        ///< a value outside what it can be
  kSyntax,       ///< text that cannot be parsed
  kDamaged,      ///< bytes lost or skipped in a log
  kLost,         ///< samples missing by their sequence numbers
  kLate,         ///< arrived after its time had been used
  kOrder,        ///< time or sequence going backwards
  kConflict,     ///< two sources contradict each other
};

/// Something foreign that could not be used, with its place. Unset places are -1 or 0.
struct Fault {
  FaultCode code = FaultCode::kForeign;
  std::string text = {};     ///< one sentence: what is wrong and, where known, what to do
  std::string source = {};   ///< file or channel
  std::int64_t offset = -1;  ///< byte in the source
  int line = 0;              ///< from 1
  int column = 0;            ///< from 1
};

/// The fault for people, with its place as far as it is known: "job.toml:12:3: sentence".
WELLGYRO_EXPORT std::string SentenceOf(const Fault& fault);

/// A value, or the Fault that stands in its place; shaped as std::expected<T, Fault> of C++23.
/// Asking for the value of a failed result is our own mistake and is asserted.
template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : held_(std::move(value)) {}      // NOLINT(google-explicit-constructor)
  Result(Fault fault) : held_(std::move(fault)) {}  // NOLINT(google-explicit-constructor)

  bool has_value() const { return held_.index() == 0; }
  explicit operator bool() const { return has_value(); }

  const T& value() const& { return assert(has_value()), std::get<0>(held_); }
  T& value() & { return assert(has_value()), std::get<0>(held_); }
  T&& value() && { return assert(has_value()), std::get<0>(std::move(held_)); }
  const T& operator*() const& { return value(); }
  T& operator*() & { return value(); }
  T&& operator*() && { return std::move(*this).value(); }
  const T* operator->() const { return &value(); }
  T* operator->() { return &value(); }

  const Fault& fault() const { return assert(!has_value()), std::get<1>(held_); }

 private:
  std::variant<T, Fault> held_;
};

}  // namespace wellgyro
