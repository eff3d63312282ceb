#include "wellgyro/io/toml/job_file.h"

#include <memory>
#include <set>
#include <string>
#include <utility>

#include "wellgyro/io/exchange/survey_csv.h"
#include "wellgyro/io/formats.h"
#include "wellgyro/io/toml/coefficients_internal.h"
#include "wellgyro/io/toml/error_model_file.h"
#include "wellgyro/io/toml/job_numbers_internal.h"
#include "wellgyro/io/toml/job_sections_internal.h"
#include "wellgyro/io/toml/named_file_internal.h"
#include "wellgyro/io/toml/toml_internal.h"
#include "wellgyro/io/toml/tool_file.h"
#include "wellgyro/survey/job_rules.h"
#include "wellgyro/survey/unstated_errors.h"
#include "wellgyro/uncertainty/error_model.h"

namespace wellgyro {
namespace {

TieIn TieInOfSurvey(const std::string& text, const std::string& source) {
  const auto stations = ParseSurveyCsv(text, source);
  if (!stations) throw TomlError{stations.fault()};
  if (stations->empty()) {
    throw TomlError{{.code = FaultCode::kRange,
                     .text = "has no station to tie on to",
                     .source = source,
                     .line = 1}};
  }
  const Station& last = stations->back();
  if (Has(last.quality, Quality::kUnfit)) {
    throw TomlError{{.code = FaultCode::kRange,
                     .text = "ends in a station that its own survey calls unfit: not to tie on to",
                     .source = source,
                     .line = static_cast<int>(stations->size()) + 1}};
  }
  return {.md = last.md,
          .north = last.p_WT_W.x(),
          .east = last.p_WT_W.y(),
          .tvd = last.p_WT_W.z(),
          .inclination = last.inclination,
          .azimuth = last.azimuth,
          .cov_p_WT_W = last.cov_p_WT_W};
}

class JobReader {
 public:
  explicit JobReader(NamedFiles& files) : files_(files) {}

  JobFile Read(TomlTable& root) {
    Job& job = file_.job;
    const TomlTable well = root.Need("well", root.FindTable("well"));
    ReadWell(well, job);
    if (auto table = root.FindTable("identity")) job.identity = table->Verbatim();
    if (auto table = root.FindTable("grid")) {
      if (!well.Has("longitude_deg")) {
        well.RefuseAbsent("longitude_deg", "is missing; [grid] needs it");
      }
      TakeGrid(*table);
    }
    if (auto table = root.FindTable("tie_in")) TakeTieIn(*table);
    job.noise_stated = root.Has("noise");
    if (auto table = root.FindTable("noise")) TakeNoise(*table);
    if (!job.noise_stated) job.noise = NoiseUnlessStated();
    if (auto table = root.FindTable("tool")) TakeTool(*table);
    auto errors = root.FindTable("errors");
    job.errors = PriorsOfJob(errors ? &*errors : nullptr, job.tool ? &*job.tool : nullptr);
    if (auto table = root.FindTable("error_model")) TakeErrorModel(*table);
    if (auto table = root.FindTable("channels")) job.channels = ReadChannels(*table);
    if (auto table = root.FindTable("alignment")) ReadAlignment(*table, job);
    if (auto table = root.FindTable("attitude")) job.attitude = ReadAttitude(*table);
    if (auto table = root.FindTable("stations")) ReadStations(*table, job);
    if (auto table = root.FindTable("depth")) ReadDepth(*table, job);
    if (auto table = root.FindTable("string")) ReadNumbers(*table, "string", job);
    if (auto table = root.FindTable("magnetic")) ReadMagnetic(*table, job);
    if (auto table = root.FindTable("acceptance")) ReadNumbers(*table, "acceptance", job);
    file_.operations = ReadOperations(root);
    for (const TomlTable& table : root.FindTables("run")) ReadRun(table, job.runs);
    for (const TomlTable& table : root.FindTables("event")) job.events.push_back(ReadEvent(table));
    return std::move(file_);
  }

 private:
  void TakeGrid(TomlTable& table) {
    ReadGrid(table, file_.job);
    if (const auto complaint = FindWellHeadComplaint(file_.job)) table.Refuse("", *complaint);
  }

  void TakeTieIn(TomlTable& table) {
    if (const auto name = table.FindString("survey")) {
      const std::string text = files_.Take("tie_in", *name);
      file_.job.tie_in = TieInOfSurvey(text, files_.PathOf(*name).string());
    } else {
      ReadTieIn(table, file_.job);
    }
  }

  void TakeNoise(TomlTable& table) {
    if (const auto name = table.FindString("file")) {
      file_.job.noise = NoiseOfFile(*name, files_);
    } else {
      file_.job.noise = ReadCoefficients(table);
    }
  }

  void TakeTool(TomlTable& table) {
    const std::string name = table.Need("file", table.FindString("file"));
    const std::string text = files_.Take("tool", name, true);
    Result<ToolCalibration> tool = ParseTool(text, files_.PathOf(name).string());
    if (!tool) throw TomlError{tool.fault()};
    file_.job.tool = *std::move(tool);
  }

  void TakeErrorModel(TomlTable& table) {
    const std::string name = table.Need("file", table.FindString("file"));
    const std::string text = files_.Take("error_model", name, true);
    Result<ErrorModel> model = ReadErrorModel(text, files_.PathOf(name).string());
    if (!model) throw TomlError{model.fault()};
    file_.job.error_model = std::make_shared<const ErrorModel>(*std::move(model));
  }

  NamedFiles& files_;
  JobFile file_;
};

}  // namespace

Result<JobFile> ParseJob(std::string_view text, const std::filesystem::path& source,
                         const std::filesystem::path& folder) {
  NamedFiles files(folder);
  files.Note("job", source, text);
  Result<JobFile> file =
      ReadTomlText<JobFile>(text, source.string(), formats::kJob,
                            [&](TomlTable& root) { return JobReader(files).Read(root); });
  if (file) file->files = files.all();
  return file;
}

std::set<std::string> KeysAskedOfJob(std::string_view text, const std::filesystem::path& folder) {
  NamedFiles files(folder);
  TomlDocument document(text, "job", formats::kJob);
  TomlTable root(document);
  try {
    JobReader(files).Read(root);
  } catch (const TomlError&) {
    // A file that it names is not there: what was asked for until then stands.
  }
  return document.asked();
}

Result<JobFile> ReadJob(const std::filesystem::path& path) {
  const Result<std::string> text = ReadTextFile(path);
  if (!text) return text.fault();
  return ParseJob(*text, path, path.parent_path());
}

}  // namespace wellgyro
