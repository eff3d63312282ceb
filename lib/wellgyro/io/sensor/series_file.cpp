#include "wellgyro/io/sensor/series_file.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <system_error>

#include <fmt/core.h>

#include "wellgyro/io/sensor/file_kind.h"
#include "wellgyro/io/text_file.h"

namespace wellgyro {
namespace {

Fault Bad(const std::filesystem::path& path, FaultCode code, std::string text) {
  return Fault{.code = code, .text = std::move(text), .source = path.string()};
}

// Text by its first bytes: printable, and at least one digit or letter.
bool LooksLikeText(std::string_view head) {
  if (head.empty()) return false;
  return std::all_of(head.begin(), head.end(), [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return (byte >= 0x20 && byte != 0x7f) || c == '\n' || c == '\r' || c == '\t';
  });
}

template <class T>
T FromLittleEndian(const char* bytes) {
  std::array<char, sizeof(T)> raw;
  std::memcpy(raw.data(), bytes, sizeof(T));
  if constexpr (std::endian::native == std::endian::big) std::reverse(raw.begin(), raw.end());
  return std::bit_cast<T>(raw);
}

template <class T>
bool ReadNumbers(std::ifstream& file, std::int64_t count, std::vector<double>& values,
                 const std::function<void(double)>& progress) {
  constexpr std::int64_t kChunk = 1 << 17;  // numbers of one read, 1 MB of doubles
  std::vector<char> bytes(static_cast<std::size_t>(std::min(kChunk, count)) * sizeof(T));
  values.reserve(static_cast<std::size_t>(count));
  for (std::int64_t done = 0; done < count; done += kChunk) {
    const auto n = static_cast<std::size_t>(std::min(kChunk, count - done));
    if (!file.read(bytes.data(), static_cast<std::streamsize>(n * sizeof(T)))) return false;
    for (std::size_t i = 0; i < n; ++i) {
      values.push_back(static_cast<double>(FromLittleEndian<T>(bytes.data() + i * sizeof(T))));
    }
    if (progress) progress(static_cast<double>(done) / static_cast<double>(count));
  }
  return true;
}

template <class T>
void SetEnds(SampleSeries& series) {
  series.lowest = std::numeric_limits<T>::min();
  series.highest = std::numeric_limits<T>::max();
}

// Bytes that are something else read as doubles of absurd size.
bool AreReadings(const std::vector<double>& values) {
  std::size_t absurd = 0;
  for (const double y : values) {
    const double size = std::abs(y);
    absurd += size > 1e30 || (size > 0 && size < 1e-30);  // NaN counts as missing, not absurd
  }
  return absurd <= values.size() / 100;
}

std::size_t WidthOf(SeriesType type) {
  if (type == SeriesType::kF64) return 8;
  return type == SeriesType::kI32 ? 4 : 2;
}

}  // namespace

std::optional<SeriesType> SeriesTypeOf(std::string_view word) {
  if (word == "f64") return SeriesType::kF64;
  if (word == "i16") return SeriesType::kI16;
  if (word == "i32") return SeriesType::kI32;
  if (word == "csv") return SeriesType::kCsv;
  if (word == "lcm") return SeriesType::kLcm;
  return std::nullopt;
}

Result<SeriesType> SeriesTypeOfFile(const std::filesystem::path& path) {
  std::string ending = path.extension().string();
  if (!ending.empty()) ending.erase(0, 1);
  if (ending == "txt") return SeriesType::kCsv;
  if (const auto type = SeriesTypeOf(ending)) return *type;
  const Result<std::string> head = ReadTextHead(path, 1 << 16);
  if (!head) return head.fault();
  const FileIdentity identity = IdentifyBytes(*head);
  if (identity.kind == FileKind::kLcmLog) return SeriesType::kLcm;
  if (LooksLikeText(*head)) return SeriesType::kCsv;
  return Bad(path, FaultCode::kForeign,
             "its ending does not say what its samples are: give --type f64, i16, i32, csv or lcm");
}

Result<SampleSeries> ReadBinarySeries(const std::filesystem::path& path, SeriesType type,
                                      const std::function<void(double)>& progress) {
  const Result<std::string> head = ReadTextHead(path, 4096);
  if (!head) return head.fault();
  if (head->empty()) return Bad(path, FaultCode::kForeign, "this is an empty file");
  if (LooksLikeText(*head) && head->find_first_of("0123456789") != std::string::npos) {
    return Bad(path, FaultCode::kForeign, "this is text, not binary numbers: try --type csv");
  }
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  const auto size = static_cast<std::int64_t>(file.tellg());
  const auto width = static_cast<std::int64_t>(WidthOf(type));
  if (size < 0) return Bad(path, FaultCode::kIo, "cannot tell its size: it must be a plain file");
  if (size % width != 0) {
    return Bad(path, FaultCode::kSize,
               fmt::format("{} bytes do not go into whole samples of {}: cut short, or of another "
                           "--type",
                           size, width));
  }
  file.seekg(0);
  SampleSeries series;
  bool whole = false;
  switch (type) {
    case SeriesType::kI16:
      whole = ReadNumbers<std::int16_t>(file, size / width, series.values, progress);
      SetEnds<std::int16_t>(series);
      break;
    case SeriesType::kI32:
      whole = ReadNumbers<std::int32_t>(file, size / width, series.values, progress);
      SetEnds<std::int32_t>(series);
      break;
    default:
      whole = ReadNumbers<double>(file, size / width, series.values, progress);
      if (!AreReadings(series.values)) {
        return Bad(path, FaultCode::kForeign,
                   "read as float64 its numbers are absurd: is it of another --type?");
      }
  }
  if (!whole) return Bad(path, FaultCode::kIo, "reading this file failed half way");
  return series;
}

}  // namespace wellgyro
