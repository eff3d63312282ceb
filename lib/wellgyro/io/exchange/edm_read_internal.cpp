// Definitive surveys in exports of Landmark's Engineer's Data Model: attributes of elements
// CD_DEFINITIVE_SURVEY_STATION, lengths in feet, angles in degrees, wherever they stand in the
// file.
#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "wellgyro/base/units.h"
#include "wellgyro/io/exchange/table_build_internal.h"
#include "wellgyro/io/exchange/xml_internal.h"
#include "wellgyro/io/text_internal.h"

namespace wellgyro {
namespace {

constexpr std::string_view kStation = "CD_DEFINITIVE_SURVEY_STATION";
constexpr std::string_view kHeader = "CD_DEFINITIVE_SURVEY_HEADER";
constexpr double kFoot2 = units::kFoot * units::kFoot;

struct Attribute {
  const char* name;
  Column column;
  double factor;
};
constexpr std::array kAttributes{
    Attribute{"tvd", Column::kTvd, units::kFoot},
    Attribute{"offset_north", Column::kNorth, units::kFoot},
    Attribute{"offset_east", Column::kEast, units::kFoot},
    Attribute{"dogleg_severity", Column::kDogleg, units::kDegPer100ft},
    Attribute{"covariance_xx", Column::kVarNN, kFoot2},
    Attribute{"covariance_xy", Column::kCovNE, kFoot2},
    Attribute{"covariance_xz", Column::kCovNV, kFoot2},
    Attribute{"covariance_yy", Column::kVarEE, kFoot2},
    Attribute{"covariance_yz", Column::kCovEV, kFoot2},
    Attribute{"covariance_zz", Column::kVarVV, kFoot2},
};

class EdmReader {
 public:
  EdmReader(std::string bytes, const std::string& source, const ReadOptions& options)
      : xml_(std::move(bytes), source), options_(options) {}

  SurveyTable Read() {
    Collect(xml_.root());
    const std::string id = ChosenSurvey();
    std::vector<std::pair<double, pugi::xml_node>> stations;
    for (const pugi::xml_node node : stations_) {
      if (IdOf(node) == id) stations.emplace_back(Needed(node, "md"), node);
    }
    std::stable_sort(stations.begin(), stations.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    for (const auto& [md, node] : stations) Station(md, node);
    if (const auto problem = build_.Finish()) {
      xml_.Complain(problem->code, xml_.root(), problem->text);
    }
    Names(id);
    SurveyHead& head = build_.table.head;
    head.md_unit = head.grid_unit = LengthUnit::kFoot;
    head.curvature_unit = CurvatureUnit::kDegPer100ft;
    if (!options_.depth_unit) {
      head.notes.emplace_back(
          "its lengths are taken as feet, as EDM stores them: --depth-unit m if they are not");
    }
    return std::move(build_.table);
  }

 private:
  void Collect(pugi::xml_node node) {
    for (const pugi::xml_node child : node.children()) {
      const std::string_view name = child.name();
      if (name == kStation) stations_.push_back(child);
      if (name == kHeader) headers_.push_back(child);
      if (name == "CD_WELL") wells_.push_back(child);
      if (name == "CD_WELLBORE") wellbores_.push_back(child);
      Collect(child);
    }
  }

  static std::string Value(pugi::xml_node node, const char* name) {
    return std::string(Trim(ToUtf8(node.attribute(name).value())));
  }
  static std::string IdOf(pugi::xml_node node) {
    return Value(node, "well_id") + "/" + Value(node, "wellbore_id") + "/" +
           Value(node, "def_survey_header_id");
  }

  std::string NameOf(const std::string& id) const {
    for (const pugi::xml_node header : headers_) {
      if (IdOf(header) == id) return Value(header, "name");
    }
    return {};
  }

  std::string ChosenSurvey() {
    std::vector<std::string> ids;
    for (const pugi::xml_node node : stations_) {
      if (std::find(ids.begin(), ids.end(), IdOf(node)) == ids.end()) ids.push_back(IdOf(node));
    }
    std::string names;
    std::vector<std::string> found;
    for (const std::string& id : ids) {
      const std::string name = NameOf(id);
      AddName(name.empty() ? id : name, names);
      const std::string& wanted = options_.trajectory;
      if (wanted.empty() || wanted == name || wanted == id) found.push_back(id);
    }
    if (found.size() != 1) {
      xml_.Complain(FaultCode::kConflict, xml_.root(),
                    "surveys in it: " + names + "; say which by --trajectory");
    }
    return found.front();
  }

  double Needed(pugi::xml_node node, const char* name) const {
    const auto number = Number(node, name);
    if (!number) xml_.Complain(FaultCode::kSyntax, node, std::string("no ") + name);
    return *number;
  }

  std::optional<double> Number(pugi::xml_node node, const char* name) const {
    const std::string text = Value(node, name);
    if (text.empty()) return std::nullopt;
    const auto number = NumberOf(text);
    if (!number) {
      xml_.Complain(FaultCode::kSyntax, node, "'" + text.substr(0, 40) + "' is not a number");
    }
    return number;
  }

  void Station(double md, pugi::xml_node node) {
    const auto inclination = Number(node, "inclination"), azimuth = Number(node, "azimuth");
    const auto problem = build_.Add(
        md * units::kFoot, inclination ? InclinationOf(*inclination, units::kDeg) : std::nullopt,
        azimuth ? AzimuthOf(*azimuth, units::kDeg) : std::nullopt);
    if (problem) xml_.Complain(problem->code, node, problem->text);
    for (const Attribute& a : kAttributes) {
      if (const auto value = Number(node, a.name)) build_.Set(a.column, *value * a.factor);
    }
  }

  void Names(const std::string& id) {
    SurveyHead& head = build_.table.head;
    head.names.survey = NameOf(id);
    for (const pugi::xml_node header : headers_) {
      if (IdOf(header) == id) head.planned = Value(header, "phase") == "PLAN";
    }
    for (const pugi::xml_node well : wells_) {
      if (!id.starts_with(Value(well, "well_id") + "/")) continue;
      head.names.well = Value(well, "well_common_name");
      head.names.uwi = Value(well, "well_uwi");
    }
    for (const pugi::xml_node bore : wellbores_) {
      const std::string start = Value(bore, "well_id") + "/" + Value(bore, "wellbore_id") + "/";
      if (id.starts_with(start)) head.names.wellbore = Value(bore, "wellbore_name");
    }
  }

  XmlFile xml_;
  const ReadOptions& options_;
  TableBuilder build_;
  std::vector<pugi::xml_node> stations_, headers_, wells_, wellbores_;
};

}  // namespace

bool IsEdm(std::string_view bytes) { return bytes.find(kStation) != std::string_view::npos; }

SurveyTable ReadEdm(std::string bytes, const std::string& source, const ReadOptions& options) {
  return EdmReader(std::move(bytes), source, options).Read();
}

}  // namespace wellgyro
