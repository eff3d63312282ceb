#include "wellgyro/survey/wells/model_covariance.h"

#include <cstddef>
#include <stdexcept>

#include "wellgyro/earth/earth.h"
#include "wellgyro/uncertainty/error_model.h"
#include "wellgyro/uncertainty/propagate.h"

namespace wellgyro {

std::string TakeModelCovariance(const Job& job, std::vector<Station>& chosen) {
  if (!job.error_model || chosen.size() < 2) return {};
  std::vector<SurveyPoint> points;
  points.reserve(chosen.size());
  for (const Station& s : chosen) points.push_back({s.md, s.inclination, s.azimuth, s.p_WT_W.z()});
  Surroundings surroundings;
  surroundings.latitude = job.well.latitude;
  surroundings.gravity = SiteAt(job.well.latitude, job.well.datum_elevation).gravity;
  PropagateOptions options;
  options.cov_tie_in_W = job.tie_in.cov_p_WT_W;
  try {
    const PositionUncertainty model =
        PropagateErrors(points, surroundings, *job.error_model, options);
    if (model.refusal) return "the error model does not serve this well: " + model.refusal->text;
    for (std::size_t i = 0; i < chosen.size(); ++i) chosen[i].cov_p_WT_W = model.cov_p_W[i];
  } catch (const std::invalid_argument& error) {
    return std::string("the error model does not serve this well: ") + error.what();
  }
  return {};
}

}  // namespace wellgyro
