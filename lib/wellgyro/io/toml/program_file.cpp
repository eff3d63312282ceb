#include "wellgyro/io/toml/program_file.h"

#include <map>
#include <utility>

#include <fmt/core.h>

#include "wellgyro/io/formats.h"
#include "wellgyro/io/toml/model_catalogue.h"
#include "wellgyro/io/toml/named_file_internal.h"
#include "wellgyro/io/toml/toml_internal.h"

namespace wellgyro {
namespace {

class ProgramReader {
 public:
  ProgramReader(std::filesystem::path folder, North wanted)
      : files_(std::move(folder)), wanted_(wanted) {}

  SurveyProgram Read(TomlTable& root) {
    std::vector<TomlTable> legs = root.FindTables("leg");
    if (legs.empty()) root.Refuse("", "a program needs at least one [[leg]]");
    if (auto table = root.FindTable("tie_in")) ReadTieIn(*table);
    for (std::size_t i = 0; i < legs.size(); ++i) ReadLeg(legs[i], static_cast<int>(i) + 1);
    if (program_.survey.stations.size() < 2) {
      root.Refuse("", "the legs hold fewer than two stations");
    }
    program_.inputs = files_.all();
    return std::move(program_);
  }

 private:
  const ErrorModel* Model(TomlTable& table) {
    const std::string name = table.Need("model", table.FindString("model"));
    if (const auto known = models_.find(name); known != models_.end()) return known->second;
    std::optional<ErrorModel> own = OwnModel(name);
    Result<ErrorModel> model =
        own ? Result<ErrorModel>(*std::move(own))
            : ParseModel(files_.Take("model", name.substr(0, name.find('#'))),
                         files_.PathOf(name).string());
    if (!model) throw TomlError{model.fault()};
    program_.models.push_back(std::make_unique<const ErrorModel>(*std::move(model)));
    return models_[name] = program_.models.back().get();
  }

  void ReadTieIn(TomlTable& table) {
    Eigen::Vector3d start;
    start.x() = table.FindNumber("north_m", kAnyNumber).value_or(0);
    start.y() = table.FindNumber("east_m", kAnyNumber).value_or(0);
    const auto tvd = table.FindNumber("tvd_m", kAnyNumber);
    start.z() = tvd.value_or(0);
    if (tvd) program_.survey.start_W = start;
    program_.survey.start_stated = tvd.has_value();
    if (!tvd && (table.Has("north_m") || table.Has("east_m"))) {
      table.Refuse("", "a place needs tvd_m too");
    }
    const char* keys[] = {"sigma_north_m", "sigma_east_m", "sigma_tvd_m"};
    for (int i = 0; i < 3; ++i) {
      const double sigma = table.FindNumber(keys[i], kNotNegative).value_or(0);
      program_.cov_tie_in_W(i, i) = sigma * sigma;
    }
  }

  void ReadLeg(TomlTable& table, int number) {
    const std::string name = table.Need("survey", table.FindString("survey"));
    const Result<WellStations> survey =
        ParseWellStations(files_.Take("survey", name), files_.PathOf(name).string(), wanted_);
    if (!survey) throw TomlError{survey.fault()};
    ToolLeg leg;
    leg.model = Model(table);
    leg.run = static_cast<int>(table.FindInteger("run", 0, 1000000).value_or(number));
    const auto from = table.FindNumber("from_md_m", kAnyNumber);
    const auto to = table.FindNumber("to_md_m", kAnyNumber);
    WellStations& all = program_.survey;
    if (number == 1) {
      all.north = survey->north;
      all.depth_unit_stated = survey->depth_unit_stated;
      all.map = survey->map;
      all.datum_elevation = survey->datum_elevation;
      if (!all.start_stated) {
        all.start_W = survey->start_W;
        all.start_stated = survey->start_stated;
      }
    } else if (all.north != survey->north) {
      table.Refuse("survey", "its azimuths are of another north than those of the first leg");
    }
    leg.begin = all.stations.size();
    for (const SurveyPoint& p : survey->stations) {
      const bool is_first = all.stations.empty();
      if (from && (is_first ? p.md < *from : p.md <= *from)) continue;
      if (to && p.md > *to) continue;
      if (!is_first && p.md <= all.stations.back().md) {
        if (leg.begin == all.stations.size() && !from) continue;  // it overlaps the leg before
        table.Refuse("", fmt::format("station at MD {} m is not below the leg before it", p.md));
      }
      all.stations.push_back(p);
    }
    leg.end = all.stations.size();
    if (leg.end == leg.begin) table.Refuse("", "the leg has no station in its range");
    program_.legs.push_back(leg);
  }

  NamedFiles files_;
  North wanted_;
  SurveyProgram program_;
  std::map<std::string, const ErrorModel*> models_;
};

}  // namespace

Result<SurveyProgram> ReadSurveyProgram(const std::filesystem::path& path, North wanted) {
  const Result<std::string> text = ReadTextFile(path);
  if (!text) return text.fault();
  const auto read = [&](TomlTable& root) {
    return ProgramReader(path.parent_path(), wanted).Read(root);
  };
  return ReadTomlText<SurveyProgram>(*text, path.string(), formats::kProgram, read);
}

}  // namespace wellgyro
