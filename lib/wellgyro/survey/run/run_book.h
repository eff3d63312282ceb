#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/record/operations.h"
#include "wellgyro/survey/job.h"

namespace wellgyro {

/// Which run an instant belongs to, from what the job and the events say; and each run's verdict.
/// A run lasts until the next begins, so that a foresight on deck belongs to the run before it.
///
/// Numbers that nobody gave count on from the run before, and what was logged before the first
/// RUN_BEGIN is run 1; so the answers for an instant depend on what has been said, not on the order
/// in which it came.
class WELLGYRO_EXPORT RunBook {
 public:
  explicit RunBook(const std::vector<RunSpec>& runs);

  /// RUN_BEGIN opens the run event.run (0: the next), RUN_END closes it; with what = "misrun" it is
  /// one. Other events are not for this book.
  void Take(const Event& event);
  /// Samples of this instant exist.
  void HeardAt(UtcTime utc);

  /// `told` where the source knows its run (> 0), else the run that began last.
  std::int32_t RunAt(UtcTime utc, std::int32_t told) const {
    return told > 0 ? told : begins_.empty() ? 1 : RunBegunBy(utc);
  }

  /// The job says that the run had ended by then: samples from there to the next run's begin are
  /// no run's. A RUN_END of a person ends none, because what follows on deck still belongs to it.
  bool Ended(std::int32_t run, UtcTime utc) const {
    return !specs_.empty() && EndedBySpec(run, utc);
  }

  /// Some run begins or, by the job, ends behind `first` and not behind `last`.
  bool Changes(UtcTime first, UtcTime last) const;

  bool misrun(std::int32_t run) const;
  std::string remark(std::int32_t run) const;

 private:
  std::int32_t RunBegunBy(UtcTime utc) const;
  bool EndedBySpec(std::int32_t run, UtcTime utc) const;

  struct Begin {
    UtcTime utc;
    std::int32_t number = 0;  ///< 0: the next
    bool of_job = false;
    std::string remark;
  };
  struct End {
    UtcTime utc;
    std::int32_t told = 0;
    bool misrun = false;
    std::string remark;
  };

  std::vector<RunSpec> specs_;  ///< of the job
  std::vector<Begin> begins_;   ///< by time
  std::vector<End> ends_;
  std::optional<UtcTime> heard_;  ///< the earliest sample
};

}  // namespace wellgyro
