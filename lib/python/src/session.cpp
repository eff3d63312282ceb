#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/core.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/base/units.h"
#include "wellgyro/bus/feed.h"
#include "wellgyro/bus/log_reader.h"
#include "wellgyro/bus/surveyor_listener.h"
#include "wellgyro/earth/grid.h"
#include "wellgyro/io/exchange/exchange.h"
#include "wellgyro/io/exchange/survey_csv.h"
#include "wellgyro/io/exchange/survey_tables.h"
#include "wellgyro/io/result/diagnosis_csv.h"
#include "wellgyro/io/result/run_file.h"
#include "wellgyro/io/result/stretches_csv.h"
#include "wellgyro/io/result/summary.h"
#include "wellgyro/io/result/survey_json.h"
#include "wellgyro/io/sensor/sensor_files.h"
#include "wellgyro/io/toml/job_file.h"
#include "wellgyro/io/words.h"
#include "wellgyro/survey/surveyor.h"

#include "binding.h"

namespace wellgyro::python {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// What reaches a survey from its surveyor.
class Notes : public Sink {
 public:
  void OnFault(const Fault& fault) override {
    constexpr std::size_t kKept = 1000;
    ++count;
    if (faults.size() < kKept) faults.push_back(Sentence(fault));
  }
  std::vector<std::string> faults;
  std::int64_t count = 0;
};

/// Everything that a survey came to.
struct Outcome {
  std::shared_ptr<const JobFile> job;
  std::map<std::int32_t, Survey> tools;
  std::vector<std::string> faults;
  std::int64_t fault_count = 0;

  const Survey& Of(std::int32_t tool) const {
    const auto found = tools.find(tool);
    if (found == tools.end()) {
      throw std::invalid_argument(fmt::format("tool: no tool {} was heard of", tool));
    }
    return found->second;
  }
  std::optional<WellGrid> Grid() const {
    if (!job->job.grid) return std::nullopt;
    return WellGrid(*job->job.grid, GeodeticPoint{.latitude = job->job.well.latitude,
                                                  .longitude = job->job.well.longitude});
  }
};

/// Wherever the numbers that a sample consists of come from: arrays of one length.
struct SampleArrays {
  Input<std::int64_t, 1> t_ns;
  Input<double, 2> gyro, accel;
  std::optional<Input<std::int64_t, 1>> utc_ns, seq;
  std::optional<Input<double, 2>> mag;
  std::optional<Input<double, 1>> temperature;
  double gyro_unit = 1, accel_unit = 1;
  std::int32_t period_ns = 0, run = 0, tool = 0, session = 0;
};

/// One job being surveyed from arrays. One thread at a time pushes; the interpreter runs on.
class Session {
 public:
  explicit Session(std::shared_ptr<const JobFile> job)
      : job_(std::move(job)), surveyor_(job_->job, notes_) {}

  void PushImu(const SampleArrays& a);
  void PushDepth(const Input<std::int64_t, 1>& utc_ns, const Input<double, 1>& md,
                 const std::optional<Input<double, 1>>& sigma,
                 const std::optional<Input<bool, 1>>& stopped);
  void Adjust();
  Outcome Finish();
  Outcome Current();
  std::int64_t fault_count() const { return notes_.count; }

 private:
  void CheckOpen() const {
    if (surveyor_.finished()) throw std::invalid_argument("the survey is finished");
  }
  Outcome Take();

  std::mutex busy_;
  std::shared_ptr<const JobFile> job_;
  Notes notes_;
  Surveyor surveyor_;
  std::map<std::int32_t, std::int64_t> next_seq_;
  std::int64_t next_mark_ = 0;
};

/// Names the first number that is none.
template <class Array>
void CheckFinite(const char* name, const Array& array) {
  const double* const data = array.data();
  const std::size_t columns = array.ndim() > 1 ? array.shape(1) : 1;
  for (std::size_t i = 0; i < array.size(); ++i) {
    if (std::isfinite(data[i])) continue;
    const std::string place =
        array.ndim() > 1 ? fmt::format("{}, {}", i / columns, i % columns) : fmt::format("{}", i);
    throw std::invalid_argument(
        fmt::format("{}[{}] is {}: finite numbers are expected", name, place, data[i]));
  }
}

void Session::PushImu(const SampleArrays& a) {
  const std::lock_guard lock(busy_);
  CheckOpen();
  CheckFinite("gyro", a.gyro);
  CheckFinite("accel", a.accel);
  if (a.mag) CheckFinite("mag", *a.mag);
  const std::size_t n = a.t_ns.size(), axes = a.gyro.shape(1);
  std::int64_t& next = next_seq_[a.tool];
  ImuSample sample;
  sample.stamp.session = a.session;
  sample.stamp.run = a.run;
  sample.stamp.tool = a.tool;
  sample.stamp.period_ns = a.period_ns;
  sample.has_gz = axes == 3;
  sample.has_mag = a.mag.has_value();
  for (std::size_t i = 0; i < n; ++i) {
    sample.stamp.tool_time = {a.t_ns.data()[i]};
    sample.stamp.utc = {a.utc_ns ? a.utc_ns->data()[i] : a.t_ns.data()[i]};
    sample.stamp.seq = a.seq ? a.seq->data()[i] : next++;
    if (a.temperature) sample.stamp.temperature = static_cast<float>(a.temperature->data()[i]);
    const double* const w = a.gyro.data() + axes * i;
    sample.w_IT_T = a.gyro_unit * Eigen::Vector3d(w[0], w[1], axes == 3 ? w[2] : 0);
    sample.f_T = a.accel_unit * Eigen::Vector3d(a.accel.data() + 3 * i);
    if (a.mag) sample.b_T = Eigen::Vector3d(a.mag->data() + 3 * i);
    surveyor_.Push(sample);
  }
}

void Session::PushDepth(const Input<std::int64_t, 1>& utc_ns, const Input<double, 1>& md,
                        const std::optional<Input<double, 1>>& sigma,
                        const std::optional<Input<bool, 1>>& stopped) {
  const std::lock_guard lock(busy_);
  CheckOpen();
  CheckFinite("md", md);
  if (sigma) CheckFinite("sigma", *sigma);
  DepthMark mark;
  for (std::size_t i = 0; i < md.size(); ++i) {
    mark.utc = {utc_ns.data()[i]};
    mark.seq = next_mark_++;
    mark.md = md.data()[i];
    if (sigma) mark.sigma = sigma->data()[i];
    if (stopped) mark.stopped = stopped->data()[i];
    surveyor_.Push(mark);
  }
}

void Session::Adjust() {
  const std::lock_guard lock(busy_);
  CheckOpen();
  surveyor_.Adjust();
}

Outcome Session::Take() {
  Outcome outcome{job_, {}, notes_.faults, notes_.count};
  for (const std::int32_t tool : surveyor_.tools()) outcome.tools[tool] = surveyor_.Current(tool);
  if (outcome.tools.empty()) outcome.tools[0] = surveyor_.Current(0);
  return outcome;
}

Outcome Session::Finish() {
  const std::lock_guard lock(busy_);
  CheckOpen();
  surveyor_.Finish();
  return Take();
}

Outcome Session::Current() {
  const std::lock_guard lock(busy_);
  return Take();
}

/// Says how far it is, a hundred times in all; an exception of the caller's ends the work.
class Teller {
 public:
  explicit Teller(nb::object callback) : callback_(std::move(callback)) {}
  ~Teller() {
    const nb::gil_scoped_acquire held;
    callback_.reset();
  }
  void Say(double share) {
    if (share < next_ && share < 1) return;
    next_ = share + 0.01;
    const nb::gil_scoped_acquire held;
    if (PyErr_CheckSignals() != 0) throw nb::python_error();
    if (!callback_.is_none()) callback_(share);
  }

 private:
  nb::object callback_;
  double next_ = 0;
};

Outcome FromLog(const std::shared_ptr<const JobFile>& job, const std::string& path,
                nb::object callback) {
  Teller teller(std::move(callback));
  const nb::gil_scoped_release released;
  Result<LogReader> reader = LogReader::Open(path);
  if (!reader) throw FileError{Sentence(reader.fault())};
  Notes notes;
  Surveyor surveyor(job->job, notes);
  SurveyorListener listener(surveyor, notes);
  Feed feed(job->job.channels, listener);
  std::error_code ignored;
  const double size = std::max(1.0, static_cast<double>(std::filesystem::file_size(path, ignored)));
  LogEvent event;
  while (!surveyor.finished() && reader->Next(event)) {
    feed.Take(event.channel, event.data, event.data_offset);
    teller.Say(0.9 * static_cast<double>(event.data_offset) / size);
  }
  surveyor.Finish();
  teller.Say(1);
  Outcome outcome{job, {}, {}, notes.count};
  for (const Fault& fault : reader->Faults()) outcome.faults.push_back(Sentence(fault));
  outcome.fault_count += static_cast<std::int64_t>(outcome.faults.size());
  outcome.faults.insert(outcome.faults.end(), notes.faults.begin(), notes.faults.end());
  for (const std::int32_t tool : surveyor.tools()) outcome.tools[tool] = surveyor.Current(tool);
  if (outcome.tools.empty()) outcome.tools[0] = surveyor.Current(0);
  return outcome;
}

Outcome FromTables(const std::shared_ptr<const JobFile>& job, const std::vector<std::string>& paths,
                   nb::object callback) {
  Teller teller(std::move(callback));
  const nb::gil_scoped_release released;
  Notes notes;
  Surveyor surveyor(job->job, notes);
  const std::vector<std::filesystem::path> files(paths.begin(), paths.end());
  Taken(PushSensorFiles(files, job->job, surveyor, notes,
                        [&](double share) { teller.Say(0.9 * share); }));
  surveyor.Finish();
  teller.Say(1);
  Outcome outcome{job, {}, notes.faults, notes.count};
  for (const std::int32_t tool : surveyor.tools()) outcome.tools[tool] = surveyor.Current(tool);
  if (outcome.tools.empty()) outcome.tools[0] = surveyor.Current(0);
  return outcome;
}

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
    std::vector<Eigen::Matrix3d> cov, tangent;
    for (const Station& s : stations_) {
      const bool unfit = Has(s.quality, Quality::kUnfit);
      cov.push_back(unfit ? Eigen::Matrix3d::Constant(kNone) : s.cov_p_WT_W);
      tangent.push_back(unfit ? Eigen::Matrix3d::Constant(kNone) : s.cov_tangent_W);
    }
    columns_["cov"] = Matrices(cov);
    columns_["cov_tangent"] = Matrices(tangent);
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

void AddJob(nb::module_& m) {
  m.def("report", &ReportHtml);
  nb::class_<JobFile>(m, "Job")
      .def_prop_ro("name", [](const JobFile& j) { return j.job.well.name; })
      .def_prop_ro("tool_serial",
                   [](const JobFile& j) { return j.job.tool ? j.job.tool->asset_serial : ""; })
      .def_prop_ro("latitude_deg", [](const JobFile& j) { return ToDegrees(j.job.well.latitude); })
      .def_prop_ro("files", [](const JobFile& j) {
        std::vector<std::string> names;
        for (const InputFile& file : j.files) names.push_back(file.name);
        return names;
      });
  m.def("read_job",
        [](const std::string& path) { return std::make_shared<JobFile>(Taken(ReadJob(path))); });
  m.def("parse_job",
        [](const std::string& text, const std::string& source, const std::string& folder) {
          return std::make_shared<JobFile>(Taken(ParseJob(text, source, folder)));
        });
}

}  // namespace

void AddSession(nb::module_& m) {
  AddJob(m);
  AddOutcome(m);
  nb::class_<Session>(m, "Session")
      .def("__init__", [](Session* self, std::shared_ptr<JobFile> job) { new (self) Session(job); })
      .def(
          "push_imu",
          [](Session& s, Input<std::int64_t, 1> t_ns, Input<double, 2> gyro, Input<double, 2> accel,
             std::optional<Input<std::int64_t, 1>> utc_ns,
             std::optional<Input<std::int64_t, 1>> seq, std::optional<Input<double, 2>> mag,
             std::optional<Input<double, 1>> temperature, double gyro_unit, double accel_unit,
             std::int32_t period_ns, std::int32_t run, std::int32_t tool, std::int32_t session) {
            const SampleArrays arrays{t_ns, gyro,        accel,     utc_ns,     seq,
                                      mag,  temperature, gyro_unit, accel_unit, period_ns,
                                      run,  tool,        session};
            const nb::gil_scoped_release released;
            s.PushImu(arrays);
          },
          nb::arg("t_ns").noconvert(), nb::arg("gyro").noconvert(), nb::arg("accel").noconvert(),
          nb::arg("utc_ns").none(), nb::arg("seq").none(), nb::arg("mag").none(),
          nb::arg("temperature").none(), nb::arg("gyro_unit"), nb::arg("accel_unit"),
          nb::arg("period_ns"), nb::arg("run"), nb::arg("tool"), nb::arg("session"))
      .def(
          "push_depth",
          [](Session& s, Input<std::int64_t, 1> utc_ns, Input<double, 1> md,
             std::optional<Input<double, 1>> sigma, std::optional<Input<bool, 1>> stopped) {
            const nb::gil_scoped_release released;
            s.PushDepth(utc_ns, md, sigma, stopped);
          },
          nb::arg("utc_ns").noconvert(), nb::arg("md").noconvert(), nb::arg("sigma").none(),
          nb::arg("stopped").none())
      .def("adjust", &Session::Adjust, nb::call_guard<nb::gil_scoped_release>())
      .def("finish", &Session::Finish, nb::call_guard<nb::gil_scoped_release>())
      .def("current", &Session::Current, nb::call_guard<nb::gil_scoped_release>())
      .def_prop_ro("fault_count", &Session::fault_count);
  m.def(
      "survey_log",
      [](const std::shared_ptr<JobFile>& job, const std::string& path, nb::object callback) {
        return FromLog(job, path, std::move(callback));
      },
      nb::arg("job"), nb::arg("path"), nb::arg("progress").none());
  m.def(
      "survey_tables",
      [](const std::shared_ptr<JobFile>& job, const std::vector<std::string>& paths,
         nb::object callback) { return FromTables(job, paths, std::move(callback)); },
      nb::arg("job"), nb::arg("paths"), nb::arg("progress").none());
  m.def("is_sensor_table", [](const std::string& path) { return IsSensorTable(path); });
}

}  // namespace wellgyro::python
