#pragma once

#include <memory>
#include <mutex>
#include <string>
#include <thread>

namespace wellgyro::apps {

/// Standard error of a program that must not wait for who reads it: a thread of its own writes.
/// What is said is kept, up to 64 KiB, until it is read; what finds no room is counted, and the
/// count is said as soon as there is room. Any thread may speak.
class Voice {
 public:
  Voice();
  ~Voice();  ///< ends
  Voice(const Voice&) = delete;
  Voice& operator=(const Voice&) = delete;

  /// A line that stays.
  void Say(std::string line);
  /// A line in place of the one shown before: on a terminal it lives below what was said, elsewhere
  /// it takes the place of one that was not written yet.
  void Show(std::string line);

  /// Waits a second at most for what is not written yet. Where that is not read, standard error
  /// leads nowhere from then on, so that the program's last words do not hold it up either.
  void End();

  bool on_terminal() const;

 private:
  struct State;
  void Close();

  std::shared_ptr<State> state_;  ///< outlives a thread that nobody reads
  std::thread thread_;
  std::once_flag ended_;
};

}  // namespace wellgyro::apps
