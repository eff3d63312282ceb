#pragma once

#include <gmock/gmock.h>

/// What the tests share stands in a namespace that is called as GoogleTest's: inside wellgyro the
/// names of both are in reach.
namespace wellgyro::testing {
using namespace ::testing;
}
