#pragma once

/// @file
/// What marks the symbols that shared libraries show.

/// Marks what the shared libraries show; everything else in them is hidden. On Windows CMake's
/// WINDOWS_EXPORT_ALL_SYMBOLS does this work.
#if defined(__GNUC__) && !defined(_WIN32)
#define WELLGYRO_EXPORT __attribute__((visibility("default")))
#else
#define WELLGYRO_EXPORT
#endif
