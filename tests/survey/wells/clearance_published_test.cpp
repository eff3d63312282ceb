// The ISCWSA's standard set of well paths for clearance scenarios (r4, 17 May 2017): a reference
// well, ten offsets and a side-track, with the separation factor at every station of the reference
// by MWD Rev 4. The figures stay with their publisher; without them the test is skipped.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "wellgyro/base/units.h"
#include "wellgyro/io/toml/error_model_file.h"
#include "wellgyro/survey/wells/separation.h"

namespace wellgyro {
namespace {

using Eigen::Vector3d;
using nlohmann::json;

constexpr char kSidetrack[] = "10 - well";
constexpr double kKickOff = 900;  // [m]

/// Stations and positions as the set lists them.
SurveyedWell PublishedWell(const json& well) {
  SurveyedWell made;
  for (std::size_t i = 0; i < well["MD"].size(); ++i) {
    const auto at = [&](const char* column) { return well[column][i].get<double>(); };
    made.survey.push_back(
        {at("MD"), at("IncDeg") * units::kDeg, at("AziDeg") * units::kDeg, at("TVD")});
    made.position_W.push_back(Vector3d(at("N"), at("E"), at("TVD")));
  }
  return made;
}

struct Known {
  SurveyedWell well;
  PositionUncertainty errors;
};

Known PublishedSurvey(const json& well, const ErrorModel& model, const PropagateOptions& options) {
  const json& header = well["header"];
  Surroundings place;
  place.latitude = header["latitude"].get<double>() * units::kDeg;
  place.gravity = header["G"].get<double>();
  place.field = header["b_total"].get<double>() * units::kNanotesla;
  place.dip = header["dip"].get<double>();
  place.declination = header["declination"].get<double>();
  place.convergence = header["convergence"].get<double>();
  Known known;
  known.well = PublishedWell(well);
  known.errors = PropagateErrors(known.well.survey, place, model, options);
  return known;
}

/// Worst of sigma(high side), sigma(lateral) and sigma(along) against the set's listing, which
/// leaves the depth reference of the slot out [m].
double SigmaDifference(const Known& known, const json& well) {
  double worst = 0;
  for (std::size_t i = 1; i < known.errors.cov_p_W.size(); ++i) {
    const SurveyPoint& p = known.well.survey[i];
    const double si = std::sin(p.inclination), ci = std::cos(p.inclination);
    const double sa = std::sin(p.azimuth), ca = std::cos(p.azimuth);
    const Vector3d axes[] = {{ci * ca, ci * sa, -si}, {-sa, ca, 0}, {si * ca, si * sa, ci}};
    const char* names[] = {"sigmaH", "sigmaL", "sigmaA"};
    for (int k = 0; k < 3; ++k) {
      const double sigma = std::sqrt(axes[k].dot(known.errors.cov_p_W[i] * axes[k]));
      worst = std::max(worst, std::abs(sigma - well[names[k]][i].get<double>()));
    }
  }
  return worst;
}

TEST(ClearancePublished, IscwsaSet) {
  const auto path =
      std::filesystem::path(WELLGYRO_REFERENCE_DIR) / "wells" / "clearance_iscwsa_well_data.json";
  std::ifstream file(path);
  if (!file) GTEST_SKIP() << "no " << path;
  const json set = json::parse(file);
  const auto model =
      ReadErrorModelFile(std::filesystem::path(WELLGYRO_DATA_DIR) / "models/ISCWSA-MWD-Rev4.toml");
  ASSERT_TRUE(model);
  // "The first station's attitude error over the whole first leg", as the set was made.
  PropagateOptions whole, tied, kicked;
  whole.tie_on = kicked.tie_on = TieOn::kWhole;
  tied.tie_on = TieOn::kIndependent;

  const json& wells = set["wells"];
  const Known reference = PublishedSurvey(wells["Reference well"], *model, whole);
  const auto& survey = reference.well.survey;
  kicked.zero_at = static_cast<std::size_t>(std::ranges::find(survey, kKickOff, &SurveyPoint::md) -
                                            survey.begin());
  const Known below = PublishedSurvey(wells["Reference well"], *model, kicked);

  const HoleSection wide[] = {{1e5, 0.4572}}, narrow[] = {{1e5, 0.3048}};
  SeparationRule rule;
  rule.minima = false;
  int all = 0;
  double worst = 0, worst_sigma = 0;
  for (const auto& [name, well] : wells.items()) {
    if (!well.contains("SF")) continue;
    const bool sidetrack = name == kSidetrack;
    const Known offset = PublishedSurvey(well, *model, sidetrack ? tied : whole);
    worst_sigma = std::max(worst_sigma, SigmaDifference(offset, well));
    const Known& first = sidetrack ? below : reference;
    const auto rows =
        Separations(HoleLine({&first.well, &first.errors}, wide),
                    HoleLine({&offset.well, &offset.errors}, narrow), Pairing::kTwoWells, rule);
    const std::size_t above = sidetrack ? *kicked.zero_at : 0;
    ASSERT_EQ(rows.size() - above, well["SF"].size()) << name;
    for (std::size_t i = 0; i < well["SF"].size(); ++i) {
      const double published = well["SF"][i].get<double>();
      const double off = std::abs(rows[above + i].factor.value() - published);
      EXPECT_LE(off, std::max(0.01 * std::abs(published), 1e-3))
          << name << " MD " << rows[above + i].md << ": " << *rows[above + i].factor << " against "
          << published;
      worst = std::max(worst, off / std::max(std::abs(published), 0.1));
      ++all;
    }
  }
  EXPECT_EQ(all, 1069);
  EXPECT_LT(worst_sigma, 1e-3);
  std::printf("%d factors, worst %.2g of its own or of 0.1; sigmas within %.2g m\n", all, worst,
              worst_sigma);
}

}  // namespace
}  // namespace wellgyro
