#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "wellgyro/base/result.h"

namespace wellgyro {

/// The bytes of a file from a cursor on: all at once from a memory map, or as many as were asked
/// for from a pipe.
class LogSource {
 public:
  /// A regular file is mapped, a FIFO or - is read. A Fault where it cannot be opened.
  static Result<LogSource> Open(const std::string& path);
  ~LogSource();
  LogSource(LogSource&& other) noexcept;
  LogSource& operator=(LogSource&&) = delete;

  /// What is there from the cursor on. Grow and Drop move it.
  std::span<const std::byte> view() const { return view_; }

  /// At least `size` bytes in view(); false when the file ends before.
  bool Grow(std::size_t size) { return view_.size() >= size || Read(size); }

  /// Moves the cursor on by `size`, which is in view.
  void Drop(std::size_t size) {
    view_ = view_.subspan(size);
    offset_ += static_cast<std::int64_t>(size);
  }

  /// Of the cursor in the file.
  std::int64_t offset() const { return offset_; }

  /// Why reading stopped, when it was not the end of the file.
  const std::optional<Fault>& fault() const { return fault_; }

 private:
  LogSource() = default;
  std::optional<Fault> Map(int descriptor, std::size_t size);
  bool Read(std::size_t size);
  void MakeRoom(std::size_t size);

  std::string path_;
  std::span<const std::byte> view_;
  std::int64_t offset_ = 0;
  std::span<std::byte> map_;
  int descriptor_ = -1;  // of a pipe
  std::vector<std::byte> buffer_;
  std::optional<Fault> fault_;
};

}  // namespace wellgyro
