#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <thread>

#include "wellgyro/base/result.h"

namespace wellgyro::apps {

/// What came from outside, with every byte that is not plain ASCII as \xNN.
std::string Printable(std::string_view text);

/// Says what is wrong on standard error, after the program's name.
void Complain(std::string_view sentence);
void Complain(const Fault& fault);

/// The same, and gives the exit code of what cannot be used ...
int Unusable(std::string_view sentence);
int Unusable(const Fault& fault);
/// ... and of a command line that makes no sense.
int Misused(std::string_view sentence);
int Misused(const Fault& fault);

/// Share of a long piece of work, on standard error where that is a terminal, and nothing
/// elsewhere. Shown from the first second on, ten times a second at most.
class Progress {
 public:
  explicit Progress(std::string_view doing, bool shown = true);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void Show(std::int64_t done, std::int64_t all);

 private:
  std::string doing_;
  bool terminal_;
  bool shown_ = false;
  std::int64_t begin_ms_;
  std::int64_t last_ms_;
};

/// Of work that ends when it has converged: for how long it has gone on, each second, as Progress.
class Waiting {
 public:
  explicit Waiting(std::string_view doing, bool shown = true);

 private:
  std::jthread ticker_;  ///< joined at the end
};

}  // namespace wellgyro::apps
