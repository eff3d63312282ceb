#include "wellgyro/noise/sample_series.h"

#include <algorithm>

namespace wellgyro {

void RatesFromPhases(SampleSeries& series) {
  auto& x = series.values;
  for (std::size_t i = 1; i < x.size(); ++i) x[i - 1] = (x[i] - x[i - 1]) / series.period;
  if (!x.empty()) x.pop_back();
  if (series.temperature.size() > x.size()) series.temperature.resize(x.size());
  // A phase that is missing takes the rates on both sides with it.
  for (auto* list : {&series.gaps, &series.saturated}) {
    for (auto& gap : *list) gap.begin = std::max<std::int64_t>(0, gap.begin - 1);
    for (std::size_t g = 1; g < list->size(); ++g) {
      (*list)[g].begin = std::max((*list)[g].begin, (*list)[g - 1].end);
    }
  }
  series.lowest.reset();
  series.highest.reset();
}

}  // namespace wellgyro
