#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/io/toml/job_file.h"
#include "wellgyro/record/operations.h"
#include "wellgyro/survey/surveyor.h"

namespace wellgyro {

/// What `operation` signs, for a survey of `well`: proto/operation_t.lcm.
WELLGYRO_EXPORT std::vector<std::byte> SignedBytes(const SignedOperation& operation,
                                                   const std::string& well);

/// Lets through to a surveyor what people order if they may, and keeps what became of each order.
/// Where the job lists keys, an order must be signed by one of them, within kFresh of the samples'
/// time, so that nobody can send again what he heard on another day; an order repeated under the
/// same key, session and id is one order. Unsigned orders are obeyed where the job lists no keys.
/// It rests on messages alone, so that a log gives what the live stream gave.
class WELLGYRO_EXPORT OperationGate {
 public:
  /// What clocks of a rig and the time to type an order may come to. An order overheard and sent
  /// again within it is the same order by its id.
  static constexpr Duration kFresh{600'000'000'000};
  static constexpr std::size_t kKept = 1000;    ///< records
  static constexpr std::size_t kWaitMax = 100;  ///< signed orders before the first sample

  /// `event`: an event that is obeyed; of a command the surveyor itself says when it was.
  using Tell = std::function<void(const OperationRecord&, bool event)>;

  /// `job` and `surveyor` must outlive this object; `tell` hears each new record.
  OperationGate(const JobFile& job, Surveyor& surveyor, Tell tell = {})
      : spec_(job.operations),
        well_(job.job.well.name),
        surveyor_(surveyor),
        tell_(std::move(tell)) {}

  void Take(const SignedOperation& operation);
  void Take(const Command& command);
  void Take(const Event& event);
  /// False: it must not be used.
  bool Take(const ToolMode& mode);
  bool Take(const ToolInfo& info);

  /// Samples or averages came up to this time: what waited for the time is looked at now.
  void HeardAt(UtcTime utc);

  const std::vector<OperationRecord>& records() const { return records_; }
  std::int64_t obeyed() const { return obeyed_; }
  std::int64_t refused() const { return refused_; }
  bool finish_obeyed() const { return finish_; }

 private:
  void Judge(const SignedOperation& operation);
  const OperatorKey* KeyOf(const SignedOperation& operation) const;
  OperationRecord RecordOf(const SignedOperation& operation, std::string effect) const;
  std::string WhyForged(const SignedOperation& operation) const;
  std::string WhyNot(const SignedOperation& operation) const;
  bool IsNew(const std::string& key, std::int32_t session, std::int32_t id);
  bool TakeOfTool(const char* kind, UtcTime utc, std::int32_t session);
  void Obey(OperationRecord record, const Command& command);
  void Obey(OperationRecord record, const Event& event);
  void ObeyContent(OperationRecord record, const SignedOperation& operation);
  void Refuse(OperationRecord record, const std::string& why);
  void Keep(OperationRecord record, bool event = false);

  const OperationSpec& spec_;
  const std::string& well_;
  Surveyor& surveyor_;
  Tell tell_;
  std::optional<UtcTime> heard_;
  std::deque<SignedOperation> waiting_;
  std::set<std::tuple<std::string, std::int32_t, std::int32_t>> known_;
  std::vector<OperationRecord> records_;
  std::tuple<std::string, std::int32_t, std::int32_t, std::string> refused_last_;
  std::int64_t obeyed_ = 0, refused_ = 0;
  std::set<std::string> told_of_tool_;
  bool finish_ = false;
};

}  // namespace wellgyro
