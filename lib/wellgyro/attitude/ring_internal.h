#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace wellgyro::increment {

/// Elements by their number since the beginning, of which the youngest are kept.
template <class T>
class Ring {
 public:
  /// A power of two.
  explicit Ring(std::size_t capacity) : items_(capacity) {}
  ~Ring() = default;
  Ring(const Ring&) = delete;
  Ring(Ring&&) = default;
  Ring& operator=(Ring&&) = default;
  /// What is there, and nothing of what stood there before; of one of the same capacity.
  Ring& operator=(const Ring& other) {
    begin_ = other.begin_;
    end_ = other.end_;
    for (std::uint64_t k = begin_; k < end_; ++k) (*this)[k] = other[k];
    return *this;
  }
  std::uint64_t begin() const { return begin_; }
  std::uint64_t end() const { return end_; }
  bool full() const { return end_ - begin_ == items_.size(); }
  bool empty() const { return end_ == begin_; }
  T& operator[](std::uint64_t k) { return items_[k & (items_.size() - 1)]; }
  const T& operator[](std::uint64_t k) const { return items_[k & (items_.size() - 1)]; }
  const T& front() const { return (*this)[begin_]; }
  const T& back() const { return (*this)[end_ - 1]; }
  void Push(const T& item) { (*this)[end_++] = item; }
  /// The next element, which still holds what stood in its place.
  T& Append() { return (*this)[end_++]; }
  void DropBefore(std::uint64_t k) { begin_ = k; }

 private:
  std::vector<T> items_;
  std::uint64_t begin_ = 0, end_ = 0;
};

}  // namespace wellgyro::increment
