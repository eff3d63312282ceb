#include <array>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/core.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/base/units.h"
#include "wellgyro/io/result/compare_files.h"
#include "wellgyro/io/result/merge_files.h"
#include "wellgyro/io/result/taken_survey.h"
#include "wellgyro/io/toml/model_catalogue.h"
#include "wellgyro/io/words.h"
#include "wellgyro/survey/wells/compare.h"
#include "wellgyro/uncertainty/ellipse.h"

#include "binding.h"

namespace wellgyro::python {
namespace {

struct Numbers {
  std::vector<double> values;
  void Add(const std::optional<double>& v, double unit = 1) {
    values.push_back(v ? *v / unit : kNone);
  }
};

TakenSurvey OfFile(const std::string& path, const std::string& model, const PlaceArguments& place) {
  SurveyWish wish{path, model, std::nullopt};
  if (place.convergence_deg) wish.convergence = FromDegrees(*place.convergence_deg);
  return Taken(TakeSurvey(wish));
}

/// Stations in degrees; `sigmas` (n, 8): inclination and azimuth in degrees, then NN NE NV EE EV
/// VV.
TakenSurvey OfArrays(const Input<double, 1>& md, const Input<double, 1>& inclination,
                     const Input<double, 1>& azimuth, const std::array<double, 3>& start,
                     const std::string& model, const std::optional<Input<double, 2>>& sigmas) {
  TakenSurvey taken;
  std::vector<SurveyPoint> stations;
  for (std::size_t i = 0; i < md.size(); ++i) {
    stations.push_back({md.data()[i], FromDegrees(inclination.data()[i]),
                        WrapTwoPi(FromDegrees(azimuth.data()[i])), 0});
  }
  taken.well = SurveyWell(std::move(stations), Eigen::Vector3d(start.data()));
  if (!model.empty()) {
    taken.models.push_back(std::make_shared<const ErrorModel>(Taken(FindModel(model))));
    taken.legs = {{taken.models.back().get(), 0, md.size(), 1}};
  } else if (sigmas) {
    for (std::size_t i = 0; i < md.size(); ++i) {
      const double* const s = sigmas->data() + 8 * i;
      StationSigmas own{FromDegrees(s[0]), FromDegrees(s[1]), Eigen::Matrix3d::Zero()};
      own.cov_p_W << s[2], s[3], s[4], s[3], s[5], s[6], s[4], s[6], s[7];
      taken.own.push_back(own);
    }
  }
  return taken;
}

ComparedSurvey Compared(const TakenSurvey& taken, const Surroundings& place, const char* which) {
  ComparedSurvey survey;
  survey.well = taken.well;
  survey.cov_tie_in_W = taken.cov_tie_in_W;
  if (!taken.legs.empty()) {
    survey.errors = ErrorsAtStations(taken.well.survey, place, taken.legs);
  } else if (!taken.own.empty()) {
    survey.own = taken.own;
  } else {
    throw std::invalid_argument(fmt::format(
        "{}: has no covariances and sigmas of its own: an error model is expected", which));
  }
  return survey;
}

constexpr const char* kPlaceNames[] = {"md_m",
                                       "inclination_a_deg",
                                       "inclination_b_deg",
                                       "d_inclination_deg",
                                       "sigma_d_inclination_deg",
                                       "azimuth_a_deg",
                                       "azimuth_b_deg",
                                       "d_azimuth_deg",
                                       "sigma_d_azimuth_deg",
                                       "d_north_m",
                                       "d_east_m",
                                       "d_down_m",
                                       "between_north_m",
                                       "between_east_m",
                                       "between_down_m",
                                       "position_sigmas"};

nb::dict PlacesOf(const std::vector<ComparedPlace>& places) {
  Numbers columns[std::size(kPlaceNames)];
  std::vector<Eigen::Matrix3d> cov;
  constexpr double kDeg = units::kDeg;
  for (const ComparedPlace& p : places) {
    const std::pair<std::optional<double>, double> row[] = {{p.md, 1},
                                                            {p.inclination[0], kDeg},
                                                            {p.inclination[1], kDeg},
                                                            {p.inclination_difference, kDeg},
                                                            {p.sigma_inclination, kDeg},
                                                            {p.azimuth[0], kDeg},
                                                            {p.azimuth[1], kDeg},
                                                            {p.azimuth_difference, kDeg},
                                                            {p.sigma_azimuth, kDeg},
                                                            {p.position_difference_W.x(), 1},
                                                            {p.position_difference_W.y(), 1},
                                                            {p.position_difference_W.z(), 1},
                                                            {p.between_stations_W.x(), 1},
                                                            {p.between_stations_W.y(), 1},
                                                            {p.between_stations_W.z(), 1},
                                                            {p.position_sigmas, 1}};
    for (std::size_t i = 0; i < std::size(kPlaceNames); ++i) {
      columns[i].Add(row[i].first, row[i].second);
    }
    cov.push_back(p.cov_position_W);
  }
  nb::dict all;
  for (std::size_t i = 0; i < std::size(kPlaceNames); ++i) {
    all[kPlaceNames[i]] = Array(std::move(columns[i].values));
  }
  all["cov"] = Matrices(cov);
  return all;
}

nb::object ShiftOf(const std::optional<ShiftEstimate>& shift, double unit) {
  if (!shift) return nb::none();
  return nb::make_tuple(shift->value / unit, shift->sigma / unit, shift->smallest / unit);
}

nb::dict CompareThem(const TakenSurvey& a, const TakenSurvey& b, const PlaceArguments& place,
                     const std::vector<double>& at, double every, bool same_run,
                     double local_sigma_deg) {
  Comparison c;
  {
    const nb::gil_scoped_release released;
    const Surroundings surroundings = SurroundingsOf(place);
    CompareOptions options;
    options.at = at;
    options.every = every;
    options.same_run = same_run;
    options.local_sigma = FromDegrees(local_sigma_deg);
    c = Compare(Compared(a, surroundings, "a"), Compared(b, surroundings, "b"), options);
  }
  nb::dict all;
  all["places"] = PlacesOf(c.places);
  all["checks"] = ColumnsOf(c.checks);
  all["verdict"] = std::string(WordOf(c.verdict.verdict));
  all["causes"] = c.verdict.causes;
  all["notes"] = c.notes;
  all["depth_offset_m"] = ShiftOf(c.depth_offset, 1);
  all["depth_stretch_m_per_km"] = ShiftOf(c.depth_stretch, 1e-3);
  all["azimuth_offset_deg"] = ShiftOf(c.azimuth_offset, units::kDeg);
  constexpr double kSquare = units::kDeg * units::kDeg;
  all["kink_deg2_per_m"] = c.kink / kSquare;
  all["wander_deg2_per_m3"] = c.wander / kSquare;
  return all;
}

nb::dict UncertaintyOf(const TakenSurvey& taken, const PlaceArguments& place, double confidence,
                       bool terms) {
  if (taken.legs.empty()) throw std::invalid_argument("model: an error model is expected");
  PositionUncertainty errors;
  {
    const nb::gil_scoped_release released;
    PropagateOptions options;
    options.cov_tie_in_W = taken.cov_tie_in_W;
    options.terms = terms;
    errors = PropagateErrors(taken.well.survey, SurroundingsOf(place), taken.legs, options);
  }
  Numbers md, major, minor, azimuth;
  for (std::size_t k = 0; k < errors.cov_p_W.size(); ++k) {
    const ErrorEllipse e = HorizontalEllipse(errors.cov_p_W[k], confidence);
    md.Add(taken.well.survey[k].md);
    major.Add(e.semi_major);
    minor.Add(e.semi_minor);
    azimuth.Add(e.azimuth_major, units::kDeg);
  }
  nb::dict all, by_term;
  all["md_m"] = Array(std::move(md.values));
  all["semi_major_m"] = Array(std::move(major.values));
  all["semi_minor_m"] = Array(std::move(minor.values));
  all["azimuth_major_deg"] = Array(std::move(azimuth.values));
  all["cov"] = Matrices(errors.cov_p_W);
  for (const TermUncertainty& term : errors.terms) {
    by_term[term.term.c_str()] = Matrices(term.cov_p_W);
  }
  all["terms"] = by_term;
  all["notes"] = errors.notes;
  all["refusal"] = errors.refusal ? nb::object(nb::cast(errors.refusal->text)) : nb::none();
  return all;
}

nb::dict MergeThem(const std::string& text, const std::string& folder, const PlaceArguments& place,
                   const std::vector<double>& at, double every) {
  MergeAnswer answer;
  {
    const nb::gil_scoped_release released;
    MergeRequest request;
    request.plan = folder;
    request.text = text;
    request.surroundings = SurroundingsOf(place);
    if (place.convergence_deg) request.convergence = FromDegrees(*place.convergence_deg);
    request.at = at;
    request.every = every;
    answer = Taken(AnswerMerge(request));
  }
  const MergedSurvey& merged = answer.merged;
  Numbers md, inclination, azimuth, severity;
  for (std::size_t k = 0; k < merged.well.survey.size(); ++k) {
    md.Add(merged.well.survey[k].md);
    inclination.Add(merged.well.survey[k].inclination, units::kDeg);
    azimuth.Add(merged.well.survey[k].azimuth, units::kDeg);
    severity.Add(answer.table.Get(Column::kDogleg, k), units::kDegPer30m);
  }
  nb::dict all, files;
  all["md_m"] = Array(std::move(md.values));
  all["inclination_deg"] = Array(std::move(inclination.values));
  all["azimuth_deg"] = Array(std::move(azimuth.values));
  all["dogleg_deg_per_30m"] = Array(std::move(severity.values));
  all["position"] = Vectors(merged.well.position_W);
  all["cov"] = Matrices(merged.errors.cov_p_W);
  for (const OutputFile& file : answer.files) files[file.name.c_str()] = file.bytes;
  all["files"] = files;
  all["notes"] = answer.notes;
  all["verdict"] = std::string(WordOf(answer.verdict.verdict));
  all["causes"] = answer.verdict.causes;
  all["summary"] = answer.summary;
  return all;
}

}  // namespace

void AddPlanning(nb::module_& m) {
  nb::class_<TakenSurvey>(m, "KnownSurvey")
      .def_ro("notes", &TakenSurvey::notes)
      .def_prop_ro("position", [](const TakenSurvey& t) { return Vectors(t.well.position_W); });
  m.def("survey_of_file", &OfFile, nb::call_guard<nb::gil_scoped_release>());
  m.def("survey_of_arrays", &OfArrays, nb::arg("md").noconvert(),
        nb::arg("inclination").noconvert(), nb::arg("azimuth").noconvert(), nb::arg("start"),
        nb::arg("model"), nb::arg("sigmas").none());
  m.def("compare", &CompareThem);
  m.def("uncertainty", &UncertaintyOf);
  m.def("merge", &MergeThem);
  m.def("model_names", [] {
    std::vector<std::string> names;
    for (const ErrorModel& model : OwnModels()) names.push_back(model.name);
    return names;
  });
}

}  // namespace wellgyro::python
