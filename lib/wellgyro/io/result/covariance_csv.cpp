#include "wellgyro/io/result/covariance_csv.h"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/io/number_text_internal.h"
#include "wellgyro/uncertainty/ellipse.h"

namespace wellgyro {
namespace {

using Eigen::Matrix3d;

constexpr std::string_view kNev =
    "VAR_NN[m2],COV_NE[m2],COV_NV[m2],VAR_EE[m2],COV_EV[m2],VAR_VV[m2]";
constexpr std::string_view kHla =
    "VAR_HH[m2],COV_HL[m2],COV_HA[m2],VAR_LL[m2],COV_LA[m2],VAR_AA[m2]";

void AddUpper(std::string& text, const Matrix3d& c) {
  for (int row = 0; row < 3; ++row) {
    for (int column = row; column < 3; ++column) {
      text.append(",").append(Significant(c(row, column)));
    }
  }
}

/// What rounding leaves of a zero is written as one.
Matrix3d WithoutDust(Matrix3d c) {
  const double dust = 1e-13 * c.trace();
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      if (std::abs(c(row, column)) < dust) c(row, column) = 0;
    }
  }
  return c;
}

}  // namespace

std::string CovarianceCsv(const SurveyedWell& well, const PositionUncertainty& errors,
                          double confidence) {
  std::string text = "MD[m],";
  text.append(kNev).append(",").append(kHla).append(
      ",SEMI_MAJOR[m],SEMI_MINOR[m],AZI_MAJOR[deg]\n");
  for (std::size_t k = 0; k < errors.cov_p_W.size(); ++k) {
    const SurveyPoint& p = well.survey[k];
    const Matrix3d cov = WithoutDust(errors.cov_p_W[k]);
    const ErrorEllipse ellipse = HorizontalEllipse(cov, confidence);
    text += Metres(p.md);
    AddUpper(text, cov);
    AddUpper(text, WithoutDust(ToHighSide(cov, p.inclination, p.azimuth)));
    text += fmt::format(",{},{},{}\n", Metres(ellipse.semi_major), Metres(ellipse.semi_minor),
                        AngleDeg(ellipse.azimuth_major));
  }
  return text;
}

std::string TermsCsv(const SurveyedWell& well, const PositionUncertainty& errors) {
  std::string text = "MD[m],TERM,";
  text.append(kNev).append("\n");
  for (std::size_t k = 0; k < errors.cov_p_W.size(); ++k) {
    const std::string md = Metres(well.survey[k].md);
    for (const TermUncertainty& term : errors.terms) {
      text.append(md).append(",").append(term.term);
      AddUpper(text, WithoutDust(term.cov_p_W[k]));
      text += "\n";
    }
  }
  return text;
}

std::string_view KindWord(Separation::Kind kind) {
  switch (kind) {
    case Separation::Kind::kNearest:
      return "nearest";
    case Separation::Kind::kLowest:
      return "lowest";
    case Separation::Kind::kStation:
      break;
  }
  return "station";
}

std::string SeparationCsv(std::span<const Separation> separations) {
  std::string text = "MD[m],OTHER_MD[m],DISTANCE[m],N[m],E[m],V[m],SIGMA[m],SIGMAS,KIND\n";
  for (const Separation& s : separations) {
    text += fmt::format("{},{},{},{},{},{},{},{},{}\n", Metres(s.md), Metres(s.other_md),
                        Metres(s.distance), Metres(s.vector_W.x()), Metres(s.vector_W.y()),
                        Metres(s.vector_W.z()), Metres(s.sigma),
                        s.sigmas ? Significant(*s.sigmas) : std::string(), KindWord(s.kind));
  }
  return text;
}

}  // namespace wellgyro
