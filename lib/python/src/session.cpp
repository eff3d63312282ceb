#include <cmath>
#include <cstdint>
#include <filesystem>
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
#include "wellgyro/bus/feed.h"
#include "wellgyro/bus/log_reader.h"
#include "wellgyro/bus/survey_log.h"
#include "wellgyro/io/sensor/sensor_files.h"
#include "wellgyro/io/toml/job_file.h"
#include "wellgyro/survey/fault_book.h"
#include "wellgyro/survey/surveyor.h"

#include "binding.h"
#include "outcome.h"

namespace wellgyro::python {
namespace {

/// What reaches a survey from its surveyor.
class Notes : public Sink {
 public:
  void OnFault(const Fault& fault) override {
    ++count;
    if (faults.size() < FaultBook::kKept) faults.push_back(SentenceOf(fault));
  }
  std::vector<std::string> faults;
  std::int64_t count = 0;
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
  if (!reader) throw FileError{SentenceOf(reader.fault())};
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
  for (const Fault& fault : reader->Faults()) outcome.faults.push_back(SentenceOf(fault));
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

void AddSurveys(nb::module_& m) {
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
  AddSurveys(m);
}

}  // namespace wellgyro::python
