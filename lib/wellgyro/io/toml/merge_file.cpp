#include "wellgyro/io/toml/merge_file.h"

#include <algorithm>
#include <map>
#include <stdexcept>
#include <utility>

#include <fmt/core.h>

#include "wellgyro/io/exchange/well_stations.h"
#include "wellgyro/io/formats.h"
#include "wellgyro/io/toml/model_catalogue.h"
#include "wellgyro/io/toml/named_file_internal.h"
#include "wellgyro/io/toml/program_file.h"
#include "wellgyro/io/toml/toml_internal.h"
#include "wellgyro/survey/hole/kick_off.h"

namespace wellgyro {
namespace {

constexpr TomlRange kShare{.min = 0, .max = 1};

void ReadPolicy(TomlTable& table, MergePlan& plan) {
  MergePolicy& policy = plan.policy;
  policy.in_order =
      table.FindWord<bool>("choose", {{"smallest", false}, {"order", true}}).value_or(false);
  if (const auto word =
          table.FindWord<MergeMeasure>("measure", {{"horizontal", MergeMeasure::kHorizontal},
                                                   {"vertical", MergeMeasure::kVertical},
                                                   {"volume", MergeMeasure::kVolume}})) {
    policy.measure = *word;
  }
  policy.at_md = table.FindNumber("at_md_m", kAnyNumber);
  table.Read("min_gain", policy.min_gain, 1, kShare);
  table.Read("max_gap_m", policy.max_gap, 1, kPositive);
  if (const auto word = table.FindWord<OnDisagreement>(
          "on_disagreement", {{"fail", OnDisagreement::kFail}, {"note", OnDisagreement::kNote}})) {
    plan.disagreement = *word;
  }
}

class PlanReader {
 public:
  PlanReader(std::filesystem::path folder, North wanted)
      : files_(std::move(folder)), wanted_(wanted) {}

  MergePlan Read(TomlTable& root) {
    plan_.name = root.FindString("name").value_or("");
    if (auto table = root.FindTable("policy")) ReadPolicy(*table, plan_);
    if (auto table = root.FindTable("tie_in")) ReadTieIn(*table);
    if (auto table = root.FindTable("parent")) ReadParent(*table);
    std::vector<TomlTable> legs = root.FindTables("leg");
    if (legs.empty()) root.Refuse("", "a merge needs at least one [[leg]]");
    for (std::size_t i = 0; i < legs.size(); ++i) ReadLeg(legs[i], static_cast<int>(i) + 1);
    try {
      CheckLegs(plan_.legs, plan_.policy);
    } catch (const std::invalid_argument& error) {
      root.Refuse("", error.what());
    }
    FindStart();
    for (const InputFile& file : files_.all()) plan_.inputs.push_back(file);
    return std::move(plan_);
  }

 private:
  /// Two of one name are one model, so that legs of one run share its errors.
  const ErrorModel* Model(TomlTable& table) {
    const std::string name = table.Need("model", table.FindString("model"));
    const auto known = models_.find(name);
    if (known != models_.end()) return plan_.model_names.push_back(NameOf(name)), known->second;
    std::optional<ErrorModel> own = OwnModel(name);
    Result<ErrorModel> model = own ? Result<ErrorModel>(*std::move(own)) : ModelOfFile(name);
    if (!model) throw TomlError{model.fault()};
    plan_.models.push_back(std::make_shared<const ErrorModel>(*std::move(model)));
    plan_.model_names.push_back(NameOf(name));
    return models_[name] = plan_.models.back().get();
  }

  std::string NameOf(const std::string& name) const {
    return OwnModel(name) ? name : std::filesystem::absolute(files_.PathOf(name)).string();
  }

  void ReadTieIn(TomlTable& table) {
    const auto north = table.FindNumber("north_m", kAnyNumber);
    const auto east = table.FindNumber("east_m", kAnyNumber);
    const auto tvd = table.FindNumber("tvd_m", kAnyNumber);
    if ((north || east) && !tvd) table.Refuse("", "a place needs tvd_m too");
    if (tvd) start_ = Eigen::Vector3d(north.value_or(0), east.value_or(0), *tvd);
    const char* keys[] = {"sigma_north_m", "sigma_east_m", "sigma_tvd_m"};
    for (int i = 0; i < 3; ++i) {
      const double sigma = table.FindNumber(keys[i], kNotNegative).value_or(0);
      plan_.cov_tie_in_W(i, i) = sigma * sigma;
    }
  }

  /// The legs of the parent's program down to the kick-off, where a station is put in if there is
  /// none.
  void ReadParent(TomlTable& table) {
    const std::string name = table.Need("program", table.FindString("program"));
    const double kick_off =
        table.Need("kick_off_md_m", table.FindNumber("kick_off_md_m", kPositive));
    Result<SurveyProgram> program = ReadSurveyProgram(files_.PathOf(name), wanted_);
    if (!program) throw TomlError{program.fault()};
    std::vector<SurveyPoint>& stations = program->survey.stations;
    try {
      const std::size_t at = StationAt(stations, program->legs, kick_off);
      stations.resize(at + 1);
    } catch (const std::domain_error& error) {
      table.Refuse("kick_off_md_m", error.what());
    }
    for (std::size_t i = 0; i < program->legs.size(); ++i) {
      const ToolLeg& leg = program->legs[i];
      if (leg.begin >= stations.size()) break;
      MergeLeg kept;
      kept.name = fmt::format("{} {}", std::filesystem::path(name).stem().string(), i + 1);
      const std::size_t end = std::min(leg.end, stations.size());
      kept.stations.assign(stations.begin() + static_cast<std::ptrdiff_t>(leg.begin),
                           stations.begin() + static_cast<std::ptrdiff_t>(end));
      kept.model = leg.model;
      kept.run = leg.run;
      kept.kept = true;
      plan_.legs.push_back(std::move(kept));
      plan_.model_names.push_back(ModelNameIn(*program, leg, name));
    }
    for (auto& model : program->models) plan_.models.push_back(std::move(model));
    for (InputFile& input : program->inputs) plan_.inputs.push_back(std::move(input));
    if (program->survey.start_stated && !start_) start_ = program->survey.start_W;
    kick_off_ = kick_off;
  }

  /// What a program of ours may name the model by, which it gave by name or by file.
  static std::string ModelNameIn(const SurveyProgram& program, const ToolLeg& leg,
                                 const std::string& name) {
    if (OwnModel(leg.model->name)) return leg.model->name;
    const auto is_model = [](const InputFile& input) { return input.role == "model"; };
    if (std::ranges::count_if(program.inputs, is_model) == 1) {
      const auto file = std::ranges::find_if(program.inputs, is_model);
      return std::filesystem::absolute(file->path).string();
    }
    return fmt::format("{} of {}", leg.model->name, name);
  }

  /// A name that is neither a model's nor a file's is refused with those that there are.
  Result<ErrorModel> ModelOfFile(const std::string& name) {
    const std::string file = name.substr(0, name.find('#'));
    const bool is_file = std::filesystem::exists(files_.PathOf(file));
    if (!is_file && !std::filesystem::exists(file)) return FindModel(name);
    return ParseModel(files_.Take("model", file), files_.PathOf(name).string());
  }

  void ReadLeg(TomlTable& table, int number) {
    const std::string name = table.Need("survey", table.FindString("survey"));
    const Result<WellStations> survey =
        ParseWellStations(files_.Take("survey", name), files_.PathOf(name).string(), wanted_);
    if (!survey) throw TomlError{survey.fault()};
    MergeLeg leg;
    leg.name = table.FindString("name").value_or(std::filesystem::path(name).stem().string());
    for (const MergeLeg& other : plan_.legs) {
      if (other.name == leg.name) leg.name += fmt::format(" {}", number);
    }
    leg.model = Model(table);
    leg.run = static_cast<int>(table.FindInteger("run", 0, 1000000).value_or(number));
    leg.left_out = table.FindString("left_out").value_or("");
    const auto from = table.FindNumber("from_md_m", kAnyNumber);
    const auto to = table.FindNumber("to_md_m", kAnyNumber);
    for (const SurveyPoint& p : survey->stations) {
      const bool wanted = (!from || p.md >= *from) && (!to || p.md <= *to);
      if (wanted && (!kick_off_ || p.md > *kick_off_)) leg.stations.push_back(p);
    }
    if (leg.stations.empty()) table.Refuse("", "the leg has no station in its range");
    const bool whole = leg.stations.front().md == survey->stations.front().md;
    if (whole && survey->start_stated) starts_[leg.stations.front().md] = survey->start_W;
    if (survey->north == North::kUnknown) {
      plan_.notes.push_back(leg.name + (wanted_ == North::kGrid ? ": azimuths taken as grid"
                                                                : ": azimuths taken as true"));
    }
    if (wanted_ == North::kTrue && survey->north == North::kGrid) {
      table.Refuse("survey", "its azimuths are grid: the convergence is needed");
    }
    plan_.legs.push_back(std::move(leg));
  }

  void FindStart() {
    double first = plan_.legs.front().stations.front().md;
    for (const MergeLeg& leg : plan_.legs) {
      if (leg.left_out.empty()) first = std::min(first, leg.stations.front().md);
    }
    const auto stated = starts_.find(first);
    if (start_) {
      plan_.start_W = *start_;
    } else if (stated != starts_.end()) {
      plan_.start_W = stated->second;
    } else if (first != 0) {
      plan_.start_W.z() = first;
      plan_.notes.emplace_back(
          "no place of the first station: taken to be below the well head by "
          "its MD");
    }
  }

  NamedFiles files_;
  North wanted_;
  MergePlan plan_;
  std::optional<Eigen::Vector3d> start_;
  std::optional<double> kick_off_;
  std::map<double, Eigen::Vector3d> starts_;
  std::map<std::string, const ErrorModel*> models_;
};

}  // namespace

Result<MergePlan> ReadMergePlan(const std::filesystem::path& path, North wanted) {
  const Result<std::string> text = ReadTextFile(path);
  if (!text) return text.fault();
  return ParseMergePlan(*text, path.string(), path.parent_path(), wanted);
}

Result<MergePlan> ParseMergePlan(std::string_view text, const std::string& source,
                                 const std::filesystem::path& folder, North wanted) {
  const auto read = [&](TomlTable& root) { return PlanReader(folder, wanted).Read(root); };
  return ReadTomlText<MergePlan>(text, source, formats::kMerge, read);
}

}  // namespace wellgyro
