#pragma once

#include <filesystem>
#include <string>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"

namespace wellgyro {

/// Keeps a file or folder, which must exist, to this program, as long as the object lives; the
/// system lets go of it whatever ends the program. An advisory lock of the system (flock): it binds
/// programs that ask for it, on file systems that have it.
class WELLGYRO_EXPORT FileLock {
 public:
  /// kConflict when another program holds it.
  static Result<FileLock> Take(const std::filesystem::path& path);
  ~FileLock();
  FileLock(FileLock&& other) noexcept;
  FileLock& operator=(FileLock&& other) noexcept;

 private:
  explicit FileLock(int descriptor) : descriptor_(descriptor) {}
  int descriptor_ = -1;
};

}  // namespace wellgyro
