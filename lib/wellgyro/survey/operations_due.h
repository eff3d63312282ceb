#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <set>
#include <utility>
#include <variant>
#include <vector>

#include "wellgyro/base/time.h"
#include "wellgyro/record/operations.h"
#include "wellgyro/record/sample.h"
#include "wellgyro/survey/surveyor.h"

namespace wellgyro {

/// What holds from an instant on, for the tool's stream to obey when it gets there.
using Operation = std::variant<ToolMode, Event, Command>;

/// What one tool's stream has still to obey, by time; and what of it has been obeyed before.
class OperationsDue {
 public:
  /// `sink` must outlive this object.
  OperationsDue(std::int32_t tool, Sink& sink) : tool_(tool), sink_(sink) {}

  /// Of too many, the latest is left out; modes do not take the place of what people say.
  void Push(const Operation& operation);
  /// Something is to be obeyed before the sample of this stamp and UTC, or one before it.
  bool Any(const SampleStamp& stamp, UtcTime utc) const;
  /// Takes away the next of what is to be obeyed before this sample.
  std::optional<Operation> Next(const SampleStamp& stamp, UtcTime utc);
  /// Takes away what holds though no sample reaches its time any more: all but commands.
  std::vector<Operation> TakeUncommanded();
  /// Takes away the commands, which are all that is left then.
  std::vector<Operation> TakeCommands();
  /// False: it has come before, of this session by this number. 0 is no number.
  bool IsNew(const Event& event);
  bool IsNew(const Command& command);

 private:
  struct Due {
    UtcTime utc;
    Operation operation;
  };
  /// Session and number: another console may count the same.
  using Numbers = std::set<std::pair<std::int32_t, std::int32_t>>;

  bool MakeRoom(const Due& due);
  static bool IsDue(const Due& due, const SampleStamp& stamp, UtcTime utc);

  std::int32_t tool_;
  Sink& sink_;
  std::vector<Due> due_;   ///< by time
  std::size_t modes_ = 0;  ///< of these; counted anew, a flood of tools would cost its square
  Numbers commands_, events_;
};

}  // namespace wellgyro
