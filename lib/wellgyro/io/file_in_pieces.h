#pragma once

#include <filesystem>
#include <optional>
#include <string_view>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"

namespace wellgyro {

/// A file to be written in pieces, for what is more than fits into memory, by the rules of
/// WriteFiles. What was not put in place is removed when the object ends.
class WELLGYRO_EXPORT FileInPieces {
 public:
  explicit FileInPieces(const std::filesystem::path& name);
  ~FileInPieces();
  FileInPieces(FileInPieces&& other) noexcept;
  FileInPieces& operator=(FileInPieces&&) = delete;

  /// The first call makes the folder and the temporary file.
  std::optional<Fault> Append(std::string_view bytes);
  /// On disk, and the name free for PutInPlace.
  std::optional<Fault> Sync();
  std::optional<Fault> PutInPlace();
  std::optional<Fault> Finish();  ///< both

 private:
  std::optional<Fault> Open();
  bool direct() const;

  std::filesystem::path target_, temporary_;
  int file_ = -1;
  unsigned mode_ = 0;
  bool exists_ = false;
};

}  // namespace wellgyro
