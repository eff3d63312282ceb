#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"

namespace wellgyro {

/// A file to be written, named relative to its folder.
struct OutputFile {
  std::string name;
  std::string bytes;
};

/// Writes `files` into `folder`, which is made if need be, so that at every moment each name holds
/// either its old or its whole new bytes: temporary files first, on disk, then renamed in the given
/// order. Nothing is renamed when one cannot be written. Links are followed, modes kept, pipes and
/// devices written to as they are; temporary files that a killed process left of the same names are
/// removed. Gives the Fault, if any.
WELLGYRO_EXPORT std::optional<Fault> WriteFiles(const std::filesystem::path& folder,
                                                std::span<const OutputFile> files);

/// One such file in pieces, for what is more than fits into memory. What was not put in place by
/// Finish is removed when the object ends.
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
