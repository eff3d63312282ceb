#pragma once

#include <string>

#include "wellgyro/base/export.h"
#include "wellgyro/record/channels.h"

namespace wellgyro {

/// Where a survey says how it stands, once a second, for screens: beside its status, under that
/// channel's name with _GLANCE behind it.
WELLGYRO_EXPORT std::string GlanceChannel(const Channels& channels);

/// Where it says what the run had best do, if it was asked to: the same with _ADVICE.
WELLGYRO_EXPORT std::string AdviceChannel(const Channels& channels);

}  // namespace wellgyro
