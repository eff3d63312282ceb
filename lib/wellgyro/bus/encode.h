#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/bus/message.h"

namespace wellgyro {

/// Records as the bytes of one LCM message, in place of what `bytes` held; a buffer used again is
/// not allocated again. UTC travels in whole microseconds (rounded down). What Decode would refuse
/// is the caller's mistake: std::invalid_argument naming the field and the value.
///
/// A batch holds 1 to 1000 samples of one session, run, tool and period, consecutive in seq and
/// evenly spaced on the tool's clock; otherwise std::invalid_argument. Status bits are set where
/// any sample has them; the temperature and the UTC time are those of the first sample.
WELLGYRO_EXPORT void Encode(std::span<const ImuSample> batch, std::vector<std::byte>& bytes);
WELLGYRO_EXPORT void Encode(std::span<const RawSample> batch, std::vector<std::byte>& bytes);
/// Of a window that rests on samples the duration is the tool's, otherwise that of UTC. The tool's
/// times and `samples` do not travel.
WELLGYRO_EXPORT void Encode(const StillWindow& window, std::vector<std::byte>& bytes);
/// Speed, tension and sigma travel where they are there.
WELLGYRO_EXPORT void Encode(const DepthMark& mark, std::vector<std::byte>& bytes);
/// The sample number from which it holds wins over the time.
WELLGYRO_EXPORT void Encode(const ToolMode& mode, std::vector<std::byte>& bytes);
/// Strings end at their first NUL in LCM: one inside is refused.
WELLGYRO_EXPORT void Encode(const ToolInfo& info, std::vector<std::byte>& bytes);
WELLGYRO_EXPORT void Encode(const Event& event, std::vector<std::byte>& bytes);
/// Duration and depth where the command has them.
WELLGYRO_EXPORT void Encode(const Command& command, std::vector<std::byte>& bytes);
/// In radians and metres; `tool`, `tool_time`, `pass_number` and dogleg do not travel.
WELLGYRO_EXPORT void Encode(const SentStation& station, std::vector<std::byte>& bytes);
WELLGYRO_EXPORT void Encode(const Status& status, std::vector<std::byte>& bytes);
/// Key, content and signature as they are: signing is the caller's (io/signature.h).
WELLGYRO_EXPORT void Encode(const SignedOperation& operation, std::vector<std::byte>& bytes);
WELLGYRO_EXPORT void Encode(const Glance& glance, std::vector<std::byte>& bytes);
WELLGYRO_EXPORT void Encode(const Advice& advice, std::vector<std::byte>& bytes);
WELLGYRO_EXPORT void Encode(const StationRequest& request, std::vector<std::byte>& bytes);
/// Whichever it holds.
WELLGYRO_EXPORT void Encode(const Message& message, std::vector<std::byte>& bytes);

}  // namespace wellgyro
