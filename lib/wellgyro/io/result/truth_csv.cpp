#include "wellgyro/io/result/truth_csv.h"

#include <algorithm>
#include <cstdint>
#include <iterator>

#include <fmt/format.h>

#include "wellgyro/base/angle.h"

namespace wellgyro {

std::string TruthCsv(const Truth& truth, double step) {
  std::string text = "T[s],MD[m],INC[deg],AZI_TRUE[deg],GTF[deg],TVD[m],N[m],E[m]\n";
  for (std::int64_t k = 0;; ++k) {
    const double time = std::min(static_cast<double>(k) * step, truth.seconds());
    const TruthState s = truth.At(time);
    fmt::format_to(std::back_inserter(text),
                   "{:.3f},{:.4f},{:.6f},{:.6f},{:.6f},{:.4f},{:.4f},{:.4f}\n", s.time, s.md,
                   ToDegrees(s.inclination), ToDegrees(s.azimuth), ToDegrees(s.toolface),
                   s.p_WT_W.z(), s.p_WT_W.x(), s.p_WT_W.y());
    if (time >= truth.seconds()) return text;
  }
}

}  // namespace wellgyro
