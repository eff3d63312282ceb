#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"
#include "wellgyro/bus/message.h"

namespace wellgyro {

/// Bytes of one LCM message into a record. In this order: the fingerprint must be that of
/// `expected`, every count in its range, the size exactly what the counts give, every field in its
/// range (times between 1970 and 2096, numbers finite, sigmas not negative, choices known). The
/// first that is not becomes a Fault of code kFingerprint, kRange or kSize whose text names the
/// field and the value, with `channel` as source and the field's byte in the message as offset.
/// Fields that a bit or a has_ field declares absent are not looked at; unknown status bits are
/// ignored, since a released type may gain some. Never throws, whatever the bytes.
WELLGYRO_EXPORT Result<Message> Decode(MessageType expected, std::span<const std::byte> bytes,
                                       std::string_view channel = {});

/// The same for the two frequent types, into `buffer`, which grows at most to N_MAX samples and is
/// not allocated again after that. The result lies in `buffer`, whose contents a Fault leaves
/// undefined. Samples are in order of seq; the batch's temperature and status bits go to each.
///
/// With `damage`, what is no number costs its own sample only: one without a rate across or a force
/// is left out, one without a third rate or a field says that it has none. `damage` then is the
/// Fault of the first such value and counts them. Where no sample is left, it is the result's.
WELLGYRO_EXPORT Result<std::span<const ImuSample>> DecodeImuBatch(
    std::span<const std::byte> bytes, std::vector<ImuSample>& buffer, std::string_view channel = {},
    std::optional<Fault>* damage = nullptr);
WELLGYRO_EXPORT Result<std::span<const RawSample>> DecodeRawBatch(std::span<const std::byte> bytes,
                                                                  std::vector<RawSample>& buffer,
                                                                  std::string_view channel = {});

}  // namespace wellgyro
