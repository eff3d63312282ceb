#include "wellgyro/survey/run/run_now.h"

#include "wellgyro/survey/surveyor.h"

namespace wellgyro {

RunNow NowOf(const Surveyor& surveyor, std::int32_t tool) { return surveyor.Now(tool); }

}  // namespace wellgyro
