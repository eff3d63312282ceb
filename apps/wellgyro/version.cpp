// Alone, so that a new commit compiles nothing else anew.
#include "version.h"

namespace wellgyro::apps {

const char* const kVersionText = "wellgyro " WELLGYRO_VERSION " (" WELLGYRO_COMMIT ")";

}  // namespace wellgyro::apps
