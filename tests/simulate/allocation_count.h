#pragma once

namespace wellgyro {

/// Calls of operator new in this program so far.
long AllocationCount();

}  // namespace wellgyro
