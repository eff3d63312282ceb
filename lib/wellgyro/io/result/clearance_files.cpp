#include "wellgyro/io/result/clearance_files.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <set>
#include <stdexcept>
#include <string_view>
#include <utility>

#include <fmt/core.h>

#include "wellgyro/io/plot/clearance_plot.h"
#include "wellgyro/io/result/clearance_report_internal.h"
#include "wellgyro/io/text_internal.h"
#include "wellgyro/io/toml/model_catalogue.h"
#include "wellgyro/io/toml/named_file_internal.h"
#include "wellgyro/io/toml/program_file.h"
#include "wellgyro/io/toml/toml_internal.h"
#include "wellgyro/survey/hole/kick_off.h"

namespace wellgyro {
namespace {

/// A well as read: its stations and what surveyed them.
struct ReadWell {
  WellStations table;
  std::vector<std::shared_ptr<const ErrorModel>> models;
  std::vector<ToolLeg> legs;
  Eigen::Matrix3d cov_tie_in_W = Eigen::Matrix3d::Zero();
};

class ClearanceRun {
 public:
  explicit ClearanceRun(const ClearanceRequest& request);
  ClearanceAnswer Answer();

 private:
  ReadWell Read(const ClearanceWell& entry);
  ReadWell ReadLegs(const std::filesystem::path& path);
  std::shared_ptr<const ErrorModel> Model(const std::filesystem::path& path);
  KnownWell Known(ReadWell read, const ClearanceWell& entry, std::optional<double> kick_off);
  void CheckUnit(const ReadWell& read, const ClearanceWell& entry);
  void Place(ReadWell& read, const ClearanceWell& entry);
  Eigen::Vector3d ReferenceAt(double md) const;
  void PlaceBeside(ReadWell& read, const ClearanceWell& entry);
  OffsetResult Against(const ClearanceWell& entry);
  const OffsetResult* Judge(const std::vector<OffsetResult>& results);
  void Note(const std::string& well, const std::string& text);

  const ClearanceRequest& request_;
  ClearancePolicy policy_;
  std::filesystem::path folder_;
  std::vector<std::pair<std::filesystem::path, std::shared_ptr<const ErrorModel>>> models_;
  ClearanceWell reference_entry_;
  ReadWell reference_read_;
  std::unique_ptr<KnownWell> reference_;
  std::unique_ptr<HoleLine> line_;
  ClearanceAnswer answer_;
};

bool IsProgram(const std::filesystem::path& path) { return path.extension() == ".toml"; }

ClearanceWell EntryOf(const std::filesystem::path& path) {
  ClearanceWell entry;
  entry.name = ToUtf8(path.stem().string());
  const std::string absolute = std::filesystem::absolute(path).string();
  (IsProgram(path) ? entry.program : entry.survey) = absolute;
  return entry;
}

/// Files of one name in several folders are told apart by the folders; one file twice is a mistake.
void NameApart(std::vector<ClearanceWell>& wells, const std::filesystem::path& folder) {
  std::map<std::string, int> named;
  std::set<std::string> files;
  for (const ClearanceWell& well : wells) ++named[well.name];
  for (ClearanceWell& well : wells) {
    const std::string& file = well.survey.empty() ? well.program : well.survey;
    const auto whole = std::filesystem::absolute(folder / file).lexically_normal();
    if (!files.insert(whole.string()).second) {
      throw std::invalid_argument("offset " + file + " is named twice");
    }
    if (named[well.name] > 1) well.name = ToUtf8(file);
  }
}

ClearanceRun::ClearanceRun(const ClearanceRequest& request) : request_(request) {
  if (request.policy) {
    Result<ClearancePolicy> read = ReadClearancePolicy(*request.policy);
    if (!read) throw TomlError{read.fault()};
    policy_ = *std::move(read);
    answer_.inputs.push_back(*request.policy);
    folder_ = request.policy->parent_path();
  }
  if (request.correlation) policy_.rule.correlation = *request.correlation;
  if (request.reference) policy_.reference = EntryOf(*request.reference);
  for (const auto& path : request.offsets) policy_.offsets.push_back(EntryOf(path));
  NameApart(policy_.offsets, folder_);
  if (!policy_.reference) {
    throw std::invalid_argument(
        "no reference well is named: --reference, or [reference] in --policy");
  }
  if (policy_.offsets.empty()) {
    throw std::invalid_argument("no offset well is named: --offset, or [[offset]] in --policy");
  }
  reference_entry_ = *policy_.reference;
}

std::shared_ptr<const ErrorModel> ClearanceRun::Model(const std::filesystem::path& path) {
  for (const auto& [known, model] : models_) {
    if (known == path) return model;
  }
  InputFile input;
  Result<ErrorModel> read = FindModel(path.string(), &input);
  if (!read) throw TomlError{read.fault()};
  answer_.inputs.push_back(input.path);
  models_.emplace_back(path, std::make_shared<const ErrorModel>(*std::move(read)));
  return models_.back().second;
}

ReadWell ClearanceRun::ReadLegs(const std::filesystem::path& path) {
  Result<SurveyProgram> program =
      ReadSurveyProgram(path, request_.convergence ? North::kGrid : North::kTrue);
  if (!program) throw TomlError{program.fault()};
  ReadWell read;
  read.table = std::move(program->survey);
  answer_.inputs.push_back(path);
  for (const auto& input : PathsOf(program->inputs)) answer_.inputs.push_back(input);
  for (auto& model : program->models) read.models.push_back(std::move(model));
  read.legs = std::move(program->legs);
  read.cov_tie_in_W = program->cov_tie_in_W;
  return read;
}

ReadWell ClearanceRun::Read(const ClearanceWell& entry) {
  ReadWell read;
  if (!entry.program.empty()) {
    read = ReadLegs(folder_ / entry.program);
  } else {
    const std::filesystem::path path = folder_ / entry.survey;
    answer_.inputs.push_back(path);
    const Result<std::string> text = ReadTextFile(path);
    if (!text) throw TomlError{text.fault()};
    Result<WellStations> table =
        ParseWellStations(*text, path.string(), request_.convergence ? North::kGrid : North::kTrue);
    if (!table) throw TomlError{table.fault()};
    read.table = *std::move(table);
    if (entry.model.empty() && request_.model.empty()) {
      throw std::invalid_argument("well " + entry.name +
                                  " has no error model: name one of 'wellgyro models' or a file by "
                                  "--model, or model in the policy");
    }
    const bool named = entry.model.empty() || OwnModel(entry.model);
    const std::string& name = entry.model.empty() ? request_.model : entry.model;
    const auto model = Model(named ? std::filesystem::path(name) : folder_ / name);
    read.models.push_back(model);
    read.legs = {{model.get(), 0, read.table.stations.size(), 1}};
  }
  CheckUnit(read, entry);
  Place(read, entry);
  if (read.table.north == North::kUnknown) {
    Note(entry.name, request_.convergence ? "azimuths taken as grid" : "azimuths taken as true");
  }
  if (read.table.north == North::kTrue && request_.convergence && *request_.convergence != 0) {
    throw std::invalid_argument("well " + entry.name +
                                " has true azimuths by its header: turn them by wellgyro convert "
                                "--north grid, or leave --convergence-deg out");
  }
  if (read.table.north == North::kGrid && !request_.convergence) {
    throw std::invalid_argument("well " + entry.name +
                                " has grid azimuths: give the convergence by --convergence-deg");
  }
  return read;
}

/// Metres where nothing says so would be a guess at how far wells are apart.
void ClearanceRun::CheckUnit(const ReadWell& read, const ClearanceWell& entry) {
  if (read.table.depth_unit_stated) return;
  throw std::invalid_argument("well " + entry.name +
                              ": the unit of measured depth is not stated: say it by wellgyro "
                              "convert --depth-unit m or ft, and take its result");
}

void ClearanceRun::Place(ReadWell& read, const ClearanceWell& entry) {
  WellStations& table = read.table;
  const double md = table.stations.front().md;
  if (entry.start_W) {
    table.start_W = *entry.start_W;
  } else if (table.start_stated) {
    return;
  } else if (table.offsets) {
    table.start_W = {table.offsets->x(), table.offsets->y(), md};
    if (md != 0) Note(entry.name, "no TVD for the first station: taken to be its MD");
  } else if (md == 0) {
    table.start_W.setZero();
    Note(entry.name,
         "no place in its file: its first station is put where north, east and TVD are 0");
  } else if (entry.kick_off && reference_) {
    table.start_W = ReferenceAt(md);
    Note(entry.name, fmt::format("no place in its file: its first station is put where the "
                                 "reference is at MD {:.2f} m",
                                 md));
  } else {
    throw std::invalid_argument(fmt::format(
        "well {} begins at MD {:.2f} m and its file has no place for that: give north_m, east_m "
        "and tvd_m of its first station in the policy",
        entry.name, md));
  }
}

/// Where the reference is at a depth of its own.
Eigen::Vector3d ClearanceRun::ReferenceAt(double md) const {
  std::vector<SurveyPoint> stations = reference_read_.table.stations;
  std::vector<ToolLeg> legs = reference_read_.legs;
  const std::size_t at = StationAt(stations, legs, md);
  return SurveyWell(std::move(stations), reference_read_.table.start_W).position_W[at];
}

/// An offset where its file and the reference's say, unless the policy does.
void ClearanceRun::PlaceBeside(ReadWell& read, const ClearanceWell& entry) {
  if (entry.start_W || reference_entry_.start_W) return;
  const WellStations& reference = reference_read_.table;
  if (const auto apart = PlacesContradict(reference, read.table)) {
    throw std::invalid_argument(
        "wells " + reference_entry_.name + " and " + entry.name + " are " + *apart +
        ": give the place of the first station of each, north_m, east_m and tvd_m, in the policy");
  }
  const auto &datum = reference.datum_elevation, &own = read.table.datum_elevation;
  if (!datum || !own || std::abs(*datum - *own) < 0.005) return;
  read.table.start_W.z() += *datum - *own;
  Note(entry.name,
       fmt::format("its depths count from {:.2f} m, those of the reference from {:.2f} "
                   "m: it is put {:.2f} m {}",
                   *own, *datum, std::abs(*datum - *own), *datum > *own ? "deeper" : "higher"));
}

void ClearanceRun::Note(const std::string& well, const std::string& text) {
  const std::string note = well + ": " + text;
  if (std::ranges::find(answer_.notes, note) == answer_.notes.end()) answer_.notes.push_back(note);
}

/// With a kick-off, what lies below it, with the errors gathered from there on.
KnownWell ClearanceRun::Known(ReadWell read, const ClearanceWell& entry,
                              std::optional<double> kick_off) {
  PropagateOptions options;
  options.cov_tie_in_W = read.cov_tie_in_W;
  options.tie_on = policy_.tie_on;
  std::size_t from = 0;
  if (kick_off) {
    from = StationAt(read.table.stations, read.legs, *kick_off);
    options.cov_tie_in_W.setZero();
    if (from == 0) {
      options.tie_on = TieOn::kIndependent;
    } else {
      options.zero_at = from;
    }
  }
  KnownWell known;
  known.well = SurveyWell(std::move(read.table.stations), read.table.start_W);
  Surroundings place = request_.surroundings;
  place.convergence = request_.convergence.value_or(0);
  UncertaintyBasis basis;
  basis.legs = read.legs;
  known.errors = WellUncertainty(known.well, place, basis, options);
  if (known.errors.refusal) {
    const std::string refusal = entry.name + ": " + known.errors.refusal->text;
    auto& all = answer_.refusals;
    if (std::ranges::find(all, refusal) == all.end()) all.push_back(refusal);
  }
  for (const std::string& note : known.errors.notes) Note(entry.name, note);
  return from == 0 ? known : FromStation(known, from);
}

OffsetResult ClearanceRun::Against(const ClearanceWell& entry) {
  const auto& default_hole = policy_.offset_hole;
  const auto& hole = entry.hole.empty() ? default_hole : entry.hole;
  ReadWell read = Read(entry);
  PlaceBeside(read, entry);
  const KnownWell offset = Known(std::move(read), entry, entry.kick_off);
  const HoleLine line({&offset.well, &offset.errors}, hole);
  OffsetResult result;
  result.name = entry.name;
  result.cut_short = reference_->errors.refusal || offset.errors.refusal;
  if (!entry.kick_off) {
    result.screened_out = !MayFallBelow(*line_, line, policy_.rule, policy_.report);
    if (!result.screened_out) {
      result.rows = Separations(*line_, line, Pairing::kTwoWells, policy_.rule);
    }
  } else {
    const KnownWell below = Known(reference_read_, reference_entry_, entry.kick_off);
    const auto& own_hole =
        reference_entry_.hole.empty() ? policy_.reference_hole : reference_entry_.hole;
    const HoleLine tail({&below.well, &below.errors}, own_hole);
    result.rows = Separations(tail, line, Pairing::kTwoWells, policy_.rule);
    // At the kick-off itself both are one hole.
    std::erase_if(result.rows, [&](const Separation& s) { return s.md <= *entry.kick_off; });
  }
  std::vector<Separation> judged = result.rows;
  if (entry.judged_from) {
    std::erase_if(judged, [&](const Separation& s) { return s.md < *entry.judged_from; });
    if (judged.empty()) {
      throw std::invalid_argument("well " + entry.name +
                                  ": nothing lies below judged_from_md_m, so nothing is judged");
    }
    Note(entry.name,
         fmt::format("judged from MD {:.2f} m on, as the policy says", *entry.judged_from));
  }
  if (const Separation* lowest = Lowest(judged)) result.lowest = *lowest;
  return result;
}

/// Sets the verdict of all wells; that with the lowest factor, if one has any. Where a model ends
/// before its survey, what lies below is not known to be clear.
const OffsetResult* ClearanceRun::Judge(const std::vector<OffsetResult>& results) {
  const OffsetResult* worst = nullptr;
  for (const OffsetResult& r : results) {
    if (!r.lowest || !r.lowest->factor) continue;
    if (!worst || *r.lowest->factor < *worst->lowest->factor) worst = &r;
    if (*r.lowest->factor < policy_.stop) {
      answer_.verdict = ClearanceVerdict::kFail;
    } else if (*r.lowest->factor < policy_.alert && answer_.verdict == ClearanceVerdict::kPass) {
      answer_.verdict = ClearanceVerdict::kWarn;
    }
  }
  if (!answer_.refusals.empty() && answer_.verdict == ClearanceVerdict::kPass) {
    answer_.verdict = ClearanceVerdict::kWarn;
  }
  return worst;
}

ClearanceAnswer ClearanceRun::Answer() {
  reference_read_ = Read(reference_entry_);
  reference_ = std::make_unique<KnownWell>(Known(reference_read_, reference_entry_, std::nullopt));
  const auto& hole = reference_entry_.hole.empty() ? policy_.reference_hole : reference_entry_.hole;
  line_ = std::make_unique<HoleLine>(UncertainWell{&reference_->well, &reference_->errors}, hole);
  std::vector<OffsetResult> results;
  for (const ClearanceWell& entry : policy_.offsets) {
    if (request_.progress) request_.progress(results.size(), policy_.offsets.size());
    results.push_back(Against(entry));
  }
  const OffsetResult* const worst = Judge(results);
  std::vector<std::string> notes = answer_.notes;
  for (const std::string& why : answer_.refusals) {
    notes.push_back("nothing below is judged, as a model ends before " + why);
  }
  const std::string ladder =
      LadderSvg(reference_entry_.name, SeriesOf(results), policy_.stop, policy_.alert);
  const std::string cylinder = TravellingCylinderSvg(reference_entry_.name, SeriesOf(results));
  answer_.files = {{"clearance.csv", ClearanceCsv(results)},
                   {"wells.csv", WellsCsv(results, policy_)},
                   {"ladder.svg", ladder},
                   {"travelling_cylinder.svg", cylinder},
                   {"clearance.html", ClearanceHtml(reference_entry_.name, results, policy_, notes,
                                                    ladder, cylinder)}};
  answer_.summary =
      worst ? fmt::format(
                  "lowest separation factor {:.3f}, against {} at MD {:.2f} m, {:.2f} m "
                  "from it",
                  *worst->lowest->factor, worst->name, worst->lowest->md, worst->lowest->distance)
            : fmt::format("no offset can come below a separation factor of {:g}", policy_.report);
  return std::move(answer_);
}

}  // namespace

Result<ClearanceAnswer> AnswerClearance(const ClearanceRequest& request) {
  try {
    return ClearanceRun(request).Answer();
  } catch (const TomlError& error) {
    return error.fault;
  } catch (const std::domain_error& error) {
    throw std::invalid_argument(error.what());
  }
}

}  // namespace wellgyro
