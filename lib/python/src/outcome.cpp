#include "outcome.h"

#include <cmath>
#include <stdexcept>
#include <utility>

#include <fmt/core.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/base/units.h"
#include "wellgyro/io/exchange/exchange.h"
#include "wellgyro/io/exchange/survey_csv.h"
#include "wellgyro/io/result/diagnosis_csv.h"
#include "wellgyro/io/result/run_file.h"
#include "wellgyro/io/result/stretches_csv.h"
#include "wellgyro/io/result/summary.h"
#include "wellgyro/io/result/survey_json.h"
#include "wellgyro/io/words.h"

namespace wellgyro::python {

const Survey& Outcome::Of(std::int32_t tool) const {
  const auto found = tools.find(tool);
  if (found == tools.end()) {
    throw std::invalid_argument(fmt::format("tool: no tool {} was heard of", tool));
  }
  return found->second;
}

std::optional<WellGrid> Outcome::Grid() const {
  if (!job->job.grid) return std::nullopt;
  return WellGrid(*job->job.grid, GeodeticPoint{.latitude = job->job.well.latitude,
                                                .longitude = job->job.well.longitude});
}

namespace {

/// Columns of stations, in the units of their names; what an unfit station does not have is NaN.
class StationColumns {
 public:
  StationColumns(const std::vector<Station>& stations, const std::optional<WellGrid>& grid)
      : stations_(stations), grid_(grid) {}

  nb::dict Columns() {
    Whole("run", [](const Station& s) { return s.run; });
    Word("pass_", [](const Station& s) { return std::string(WordOf(s.pass)); });
    Word("status", [](const Station& s) { return std::string(WordOf(s.status)); });
    Whole("revision", [](const Station& s) { return s.revision; });
    Whole("tool", [](const Station& s) { return s.tool; });
    Whole("utc_ns", [](const Station& s) { return s.utc.ns; });
    Number("md_m", [](const Station& s) { return s.md; });
    Number("inclination_deg", [](const Station& s) { return ToDegrees(s.inclination); });
    Number("azimuth_true_deg", [](const Station& s) { return ToDegrees(s.azimuth); });
    Number("toolface_deg", [](const Station& s) { return ToDegrees(s.toolface); });
    Number("tvd_m", [](const Station& s) { return s.p_WT_W.z(); });
    Number("north_m", [](const Station& s) { return s.p_WT_W.x(); });
    Number("east_m", [](const Station& s) { return s.p_WT_W.y(); });
    Number("dogleg_deg_per_30m",
           [](const Station& s) { return s.dogleg_severity / units::kDegPer30m; });
    Sigma("sigma_md_m", 0, 1);
    Sigma("sigma_inclination_deg", 1, units::kDeg);
    Sigma("sigma_azimuth_deg", 2, units::kDeg);
    Word("kind", [](const Station& s) { return std::string(WordOf(s.kind)); });
    Word("quality", [](const Station& s) { return QualityText(s.quality); });
    if (grid_) AddGrid();
    AddCovariances();
    return columns_;
  }

 private:
  template <class Of>
  void Number(const char* name, Of of) {
    std::vector<double> values;
    for (const Station& s : stations_) values.push_back(of(s));
    columns_[name] = Array(std::move(values));
  }
  template <class Of>
  void Whole(const char* name, Of of) {
    std::vector<std::int64_t> values;
    for (const Station& s : stations_) values.push_back(of(s));
    columns_[name] = Array(std::move(values));
  }
  template <class Of>
  void Word(const char* name, Of of) {
    nb::list values;
    for (const Station& s : stations_) values.append(of(s));
    columns_[name] = values;
  }
  void Sigma(const char* name, int i, double unit) {
    Number(name, [=](const Station& s) {
      return Has(s.quality, Quality::kUnfit) ? kNone : std::sqrt(s.cov_md_inc_azi(i, i)) / unit;
    });
  }
  void AddGrid() {
    std::vector<double> azimuth, northing, easting;
    for (const Station& s : stations_) {
      const GridPoint p = grid_->At(s.p_WT_W.x(), s.p_WT_W.y());
      azimuth.push_back(ToDegrees(WrapTwoPi(s.azimuth - p.convergence)));
      northing.push_back(p.northing);
      easting.push_back(p.easting);
    }
    columns_["azimuth_grid_deg"] = Array(std::move(azimuth));
    columns_["northing_m"] = Array(std::move(northing));
    columns_["easting_m"] = Array(std::move(easting));
  }
  void AddCovariances() {
    std::vector<Eigen::Matrix3d> cov, cov_tangent;
    std::vector<Eigen::Vector3d> tangent;
    for (const Station& s : stations_) {
      const bool unfit = Has(s.quality, Quality::kUnfit);
      tangent.push_back(s.tangent_L);
      cov.push_back(unfit ? Eigen::Matrix3d::Constant(kNone) : s.cov_p_WT_W);
      cov_tangent.push_back(unfit ? Eigen::Matrix3d::Constant(kNone) : s.cov_tangent_L);
    }
    columns_["cov"] = Matrices(cov);
    columns_["tangent"] = Vectors(tangent);
    columns_["cov_tangent"] = Matrices(cov_tangent);
  }

  const std::vector<Station>& stations_;
  const std::optional<WellGrid>& grid_;
  nb::dict columns_;
};

nb::dict RunsOf(const Survey& survey) {
  nb::list verdict, remark;
  std::vector<std::int64_t> run, samples, lost;
  for (const RunSummary& r : survey.runs) {
    run.push_back(r.run);
    samples.push_back(r.samples);
    lost.push_back(r.samples_lost);
    verdict.append(std::string(WordOf(r.verdict.verdict)));
    remark.append(r.remark);
  }
  nb::dict columns;
  columns["run"] = Array(std::move(run));
  columns["samples"] = Array(std::move(samples));
  columns["samples_lost"] = Array(std::move(lost));
  columns["verdict"] = verdict;
  columns["remark"] = remark;
  return columns;
}

std::string CsvOf(const Outcome& o, std::int32_t tool, const std::string& name) {
  const Survey& survey = o.Of(tool);
  const std::optional<WellGrid> grid = o.Grid();
  if (name == "survey.csv") return SurveyCsv(survey.chosen, grid ? &*grid : nullptr);
  if (name == "passes.csv") return PassesCsv(survey.passes, grid ? &*grid : nullptr);
  if (name == "diagnosis.csv") return DiagnosisCsv(survey);
  if (name == "reliability.csv") return ReliabilityCsv(survey);
  if (name == "stretches.csv") return StretchesCsv(survey);
  return ChecksCsv(survey.checks);
}

/// The survey as the program exports it: head, covariances and verdict, with every digit.
std::string ExportOf(const Outcome& o, std::int32_t tool) {
  const Survey& survey = o.Of(tool);
  const std::optional<WellGrid> grid = o.Grid();
  SurveyTable table = TableOfSurvey(o.job->job, survey.chosen, grid ? &*grid : nullptr);
  table.head.remarks.push_back(VerdictText(survey.verdict));
  return WriteSurvey(table, SurveyFormat::kCsv, {.preamble = true});
}

/// As the program's survey.json, but for what only a program knows: channels, tools, its name.
std::string JsonOf(const Outcome& o, std::int32_t tool) {
  RunRecord record;
  record.program = "wellgyro for Python " WELLGYRO_VERSION;
  record.inputs = o.job->files;
  ResultTexts texts;
  for (OutputFile& file : ResultFiles(record, {.name = "Python"}, o.job->job, o.Of(tool))) {
    texts[file.name] = std::move(file.bytes);
  }
  return Taken(SurveyJson(texts));
}

}  // namespace

void AddOutcome(nb::module_& m) {
  nb::class_<Outcome>(m, "Outcome")
      .def("tools",
           [](const Outcome& o) {
             std::vector<std::int32_t> tools;
             for (const auto& [tool, survey] : o.tools) tools.push_back(tool);
             return tools;
           })
      .def("stations",
           [](const Outcome& o, std::int32_t tool) {
             const std::optional<WellGrid> grid = o.Grid();
             return StationColumns(o.Of(tool).chosen, grid).Columns();
           })
      .def("passes",
           [](const Outcome& o, std::int32_t tool) {
             const std::optional<WellGrid> grid = o.Grid();
             return StationColumns(o.Of(tool).passes, grid).Columns();
           })
      .def("checks",
           [](const Outcome& o, std::int32_t tool) { return ColumnsOf(o.Of(tool).checks); })
      .def("runs", [](const Outcome& o, std::int32_t tool) { return RunsOf(o.Of(tool)); })
      .def("verdict",
           [](const Outcome& o, std::int32_t tool) {
             return std::string(WordOf(o.Of(tool).verdict.verdict));
           })
      .def("causes", [](const Outcome& o, std::int32_t tool) { return o.Of(tool).verdict.causes; })
      .def("unusable", [](const Outcome& o, std::int32_t tool) { return o.Of(tool).unusable; })
      .def("csv", &CsvOf)
      .def("survey_json", &JsonOf)
      .def("export", &ExportOf)
      .def_ro("faults", &Outcome::faults)
      .def_ro("fault_count", &Outcome::fault_count);
}

}  // namespace wellgyro::python
