#include "wellgyro/io/result/taken_survey.h"

#include <stdexcept>
#include <utility>

#include "wellgyro/io/exchange/columns_internal.h"
#include "wellgyro/io/exchange/exchange.h"
#include "wellgyro/io/exchange/well_stations.h"
#include "wellgyro/io/sha256.h"
#include "wellgyro/io/toml/model_catalogue.h"
#include "wellgyro/io/toml/program_file.h"
#include "wellgyro/io/toml/toml_internal.h"

namespace wellgyro {
namespace {

constexpr Column kNevColumns[3][3] = {{Column::kVarNN, Column::kCovNE, Column::kCovNV},
                                      {Column::kCovNE, Column::kVarEE, Column::kCovEV},
                                      {Column::kCovNV, Column::kCovEV, Column::kVarVV}};

std::optional<StationSigmas> SigmasOf(const SurveyTable& table, std::size_t row) {
  StationSigmas own;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const auto value = table.Get(kNevColumns[i][j], row);
      if (!value) return std::nullopt;
      own.cov_p_W(i, j) = *value;
    }
  }
  const auto inclination = table.Get(Column::kSigmaInclination, row);
  const auto azimuth = table.Get(Column::kSigmaAzimuth, row);
  if (!inclination || !azimuth) return std::nullopt;
  own.inclination = *inclination;
  own.azimuth = *azimuth;
  return own;
}

void CheckNorth(const WellStations& table, const SurveyWish& wish, TakenSurvey& taken) {
  const std::string name = wish.path.string();
  if (table.north == North::kGrid && !wish.convergence) {
    throw std::invalid_argument(name + ": azimuths are grid: the convergence is needed");
  }
  if (table.north == North::kTrue && wish.convergence && *wish.convergence != 0) {
    throw std::invalid_argument(
        name + ": azimuths are true by its header; with a convergence they would be grid");
  }
  if (table.north == North::kUnknown) {
    taken.notes.push_back(
        name + (wish.convergence ? ": azimuths taken as grid" : ": azimuths taken as true"));
  }
  if (!table.depth_unit_stated) {
    taken.notes.push_back(name + ": the header names no unit of depth: metres");
  }
  taken.north = wish.convergence ? North::kGrid : North::kTrue;
}

void Place(WellStations table, const SurveyWish& wish, TakenSurvey& taken) {
  Eigen::Vector3d start = table.start_stated ? table.start_W : Eigen::Vector3d::Zero();
  if (!table.start_stated && table.stations.front().md != 0) {
    start.z() = table.stations.front().md;
    taken.notes.push_back(wish.path.string() +
                          ": no place of the first station: taken to be below the "
                          "well head by its MD");
  }
  taken.well = SurveyWell(std::move(table.stations), start);
}

North Wanted(const SurveyWish& wish) { return wish.convergence ? North::kGrid : North::kTrue; }

void TakeProgram(const SurveyWish& wish, TakenSurvey& taken) {
  if (!wish.model.empty()) {
    throw std::invalid_argument(wish.path.string() + ": a program names its models itself");
  }
  Result<SurveyProgram> program = ReadSurveyProgram(wish.path, Wanted(wish));
  if (!program) throw TomlError{program.fault()};
  CheckNorth(program->survey, wish, taken);
  for (auto& model : program->models) taken.models.push_back(std::move(model));
  taken.legs = std::move(program->legs);
  taken.cov_tie_in_W = program->cov_tie_in_W;
  taken.inputs = std::move(program->inputs);
  Place(std::move(program->survey), wish, taken);
}

/// The first of the columns of OwnSigmas that is not there; empty where all are.
std::string Lacking(const SurveyTable& table) {
  for (const Column column :
       {Column::kVarNN, Column::kCovNE, Column::kCovNV, Column::kVarEE, Column::kCovEV,
        Column::kVarVV, Column::kSigmaInclination, Column::kSigmaAzimuth}) {
    if (!table.Has(column)) return std::string(InfoOf(column).csv);
  }
  return {};
}

/// Variances and sigmas of the stations of a file, where it has them for every one.
std::vector<StationSigmas> OwnSigmas(std::string_view text, const std::string& source,
                                     std::string& lacks) {
  std::vector<StationSigmas> own;
  const Result<SurveyTable> table = ParseSurvey(text, source);
  if (!table) return own;
  lacks = Lacking(*table);
  for (std::size_t row = 0; row < table->rows(); ++row) {
    if (table->status(row) == RowStatus::kUnused) continue;
    const auto sigmas = SigmasOf(*table, row);
    if (!sigmas) return {};
    own.push_back(*sigmas);
  }
  return own;
}

TakenSurvey Take(const SurveyWish& wish) {
  TakenSurvey taken;
  if (wish.path.extension() == ".toml") {
    TakeProgram(wish, taken);
    return taken;
  }
  const Result<std::string> text = ReadTextFile(wish.path);
  if (!text) throw TomlError{text.fault()};
  taken.inputs.push_back({"survey", wish.path.string(), wish.path, Sha256Hex(*text)});
  Result<WellStations> table = ParseWellStations(*text, wish.path.string(), Wanted(wish));
  if (!table) throw TomlError{table.fault()};
  CheckNorth(*table, wish, taken);
  if (wish.model.empty()) {
    taken.own = OwnSigmas(*text, wish.path.string(), taken.lacks);
    if (taken.own.size() != table->stations.size()) taken.own.clear();
  } else {
    InputFile input;
    Result<ErrorModel> model = FindModel(wish.model, &input);
    if (!model) throw TomlError{model.fault()};
    if (!input.name.empty()) taken.inputs.push_back(std::move(input));
    taken.models.push_back(std::make_shared<const ErrorModel>(*std::move(model)));
    taken.legs = {{taken.models.back().get(), 0, table->stations.size(), 1}};
  }
  Place(*std::move(table), wish, taken);
  return taken;
}

}  // namespace

Result<TakenSurvey> TakeSurvey(const SurveyWish& wish) {
  try {
    return Take(wish);
  } catch (const TomlError& error) {
    return error.fault;
  }
}

}  // namespace wellgyro
