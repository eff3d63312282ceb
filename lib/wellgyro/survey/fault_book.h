#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/survey/surveyor.h"

namespace wellgyro {

/// Keeps the first faults and counts them all.
class WELLGYRO_EXPORT FaultBook : public Sink {
 public:
  static constexpr std::size_t kKept = 1000;  ///< some 0.3 MB; all are counted

  void OnFault(const Fault& fault) override {
    ++count_;
    if (faults_.size() < kKept) faults_.push_back(fault);
  }
  const std::vector<Fault>& faults() const { return faults_; }
  std::int64_t count() const { return count_; }

 private:
  std::vector<Fault> faults_;
  std::int64_t count_ = 0;
};

}  // namespace wellgyro
