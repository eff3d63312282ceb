#pragma once

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "wellgyro/bus/log_reader.h"

#include "support/scratch.h"

namespace wellgyro::test {

using Bytes = std::vector<std::byte>;

/// A file of the running test, removed at its end.
class TestFile {
 public:
  explicit TestFile(const std::string& name = "log") : path_((folder_.path() / name).string()) {}

  const std::string& path() const { return path_; }

  const std::string& Fill(const Bytes& bytes) const {
    std::FILE* file = std::fopen(path_.c_str(), "wb");
    if (file == nullptr ||
        (!bytes.empty() && std::fwrite(bytes.data(), bytes.size(), 1, file) != 1)) {
      ADD_FAILURE() << "cannot write " << path_;
    }
    if (file != nullptr) std::fclose(file);
    return path_;
  }

  Bytes Contents() const {
    Bytes bytes(std::filesystem::file_size(path_));
    std::FILE* file = std::fopen(path_.c_str(), "rb");
    if (file == nullptr ||
        (!bytes.empty() && std::fread(bytes.data(), bytes.size(), 1, file) != 1)) {
      ADD_FAILURE() << "cannot read " << path_;
    }
    if (file != nullptr) std::fclose(file);
    return bytes;
  }

 private:
  support::Scratch folder_;
  std::string path_;
};

/// An event with storage of its own.
struct Kept {
  std::int64_t number = 0;
  std::int64_t received_us = 0;
  std::string channel;
  Bytes data;

  friend bool operator==(const Kept&, const Kept&) = default;
  friend void PrintTo(const Kept& kept, std::ostream* out) {
    *out << kept.number << " on " << kept.channel << " with " << kept.data.size() << " bytes";
  }
};

struct Read {
  std::vector<Kept> events;
  LogHealth health;
  std::vector<Fault> faults;
};

inline Read ReadAll(LogReader& reader) {
  Read read;
  LogEvent event;
  while (reader.Next(event)) {
    read.events.push_back({event.number, event.received_us, std::string(event.channel),
                           Bytes(event.data.begin(), event.data.end())});
  }
  read.health = reader.health();
  read.faults = reader.Faults();
  return read;
}

}  // namespace wellgyro::test
