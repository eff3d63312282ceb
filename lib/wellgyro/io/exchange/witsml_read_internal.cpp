// WITSML trajectories, versions 1.3.1 to 2.1: elements are found by local name, wherever the
// versions put prefixes and capitals.
#include <fmt/core.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/io/exchange/survey_words_internal.h"
#include "wellgyro/io/exchange/table_build_internal.h"
#include "wellgyro/io/exchange/witsml_internal.h"
#include "wellgyro/io/exchange/witsml_row_internal.h"
#include "wellgyro/io/exchange/witsml_text_internal.h"
#include "wellgyro/io/exchange/xml_internal.h"
#include "wellgyro/io/iso_time_internal.h"
#include "wellgyro/io/text_internal.h"

namespace wellgyro {
namespace {

class WitsmlReader {
 public:
  WitsmlReader(std::string bytes, const std::string& source, const ReadOptions& options)
      : xml_(std::move(bytes), source), options_(options) {}

  SurveyTable Read() {
    const pugi::xml_node trajectory = FindTrajectory();
    Names(trajectory);
    References(trajectory);
    Existence(trajectory);
    for (const pugi::xml_node child : trajectory.children()) {
      if (LocalName(child) == "trajectoryStation") Station(child);
    }
    if (build_.table.rows() == 0) {
      xml_.Complain(FaultCode::kForeign, trajectory, "not a single station");
    }
    // After the stations, whose attributes hold less.
    Common(trajectory);
    ForgetUnknown();
    CheckEnd(ChildOf(trajectory, "mdMx"));
    if (head().offsets == North::kUnknown) head().offsets = head().azimuth.north;
    if (const auto problem = build_.Finish()) {
      xml_.Complain(problem->code, trajectory, problem->text);
    }
    return std::move(build_.table);
  }

 private:
  SurveyHead& head() { return build_.table.head; }

  void CheckEnd(pugi::xml_node deepest) {
    const auto end = Number(deepest, Quantity::kLength);
    const double last = build_.table.rows() > 0 ? build_.table.md(build_.table.rows() - 1) : 0;
    if (end && last < *end - 0.01) {
      head().notes.push_back(
          fmt::format("its stations end at MD {:.2f} m, its head says {:.2f} m", last, *end));
    }
  }

  pugi::xml_node FindTrajectory() {
    const pugi::xml_node root = xml_.root();
    const std::string name = LocalName(root);
    if (name == "trajectory") return root;
    if (name != "trajectorys") {
      xml_.Complain(FaultCode::kForeign, root, "this is XML, but no WITSML trajectory");
    }
    std::vector<pugi::xml_node> found;
    std::string names;
    bool any = false;
    for (const pugi::xml_node child : root.children()) {
      if (LocalName(child) != "trajectory") continue;
      any = true;
      const std::string called = TextOf(ChildOf(child, "name"));
      const std::string uid = ToUtf8(child.attribute("uid").value());
      AddName(called.empty() ? uid : called, names);
      const std::string& wanted = options_.trajectory;
      if (wanted.empty() || wanted == called || wanted == uid) found.push_back(child);
    }
    if (!any) xml_.Complain(FaultCode::kForeign, root, "no trajectory in it");
    if (found.empty()) {
      xml_.Complain(FaultCode::kConflict, root,
                    "no trajectory is called " + options_.trajectory + ": there are " + names);
    }
    if (found.size() > 1) {
      xml_.Complain(FaultCode::kConflict, found[1],
                    "several trajectories: " + names + "; say which by --trajectory");
    }
    return found.front();
  }

  // Mandatory elements of nothing are not names.
  void ForgetUnknown() {
    SurveyIdentity& names = head().names;
    for (std::string* name : {&names.well, &names.wellbore, &names.survey, &names.author}) {
      if (*name == witsml::kUnknown) name->clear();
    }
    if (names.created == witsml::kNoDate) names.created.clear();
  }

  void Names(pugi::xml_node t) {
    SurveyIdentity& names = head().names;
    names.well = TextOf(ChildOf(t, "nameWell"));
    names.wellbore = TextOf(ChildOf(t, "nameWellbore"));
    names.survey = TextOf(ChildOf(t, "name"));
    names.uid_well = ToUtf8(t.attribute("uidWell").value());
    names.uid_wellbore = ToUtf8(t.attribute("uidWellbore").value());
    names.uid_survey = ToUtf8(t.attribute("uid").value());
    if (const auto citation = ChildOf(t, "citation")) {
      names.survey = TextOf(ChildOf(citation, "title"));
      names.author = TextOf(ChildOf(citation, "originator"));
      names.created = TextOf(ChildOf(citation, "creation"));
      names.uid_survey = t.attribute("uuid").value();
    }
    if (const auto wellbore = ChildOf(t, "wellbore")) {
      names.wellbore = TextOf(ChildOf(wellbore, "title"));
      names.uid_wellbore = TextOf(ChildOf(wellbore, "uuid"));
    }
    const pugi::xml_node company = ChildOf(t, "serviceCompany");
    const pugi::xml_node title = ChildOf(company, "title");
    names.contractor = TextOf(title ? title : company);
    names.begin = TextOf(ChildOf(t, "dTimTrajStart"));
    names.end = TextOf(ChildOf(t, "dTimTrajEnd"));
    head().definitive = Flag(ChildOf(t, "definitive"));
    head().memory = Flag(ChildOf(t, "memory"));
    head().final_survey = Flag(ChildOf(t, "finalTraj"));
  }

  std::optional<bool> Flag(pugi::xml_node node) {
    const std::string text = TextOf(node);
    if (text.empty()) return std::nullopt;
    if (text == "true" || text == "1") return true;
    if (text == "false" || text == "0") return false;
    xml_.Complain(FaultCode::kSyntax, node,
                  "'" + text.substr(0, 40) + "' is neither true nor false");
  }

  void References(pugi::xml_node t) {
    SurveyHead& h = head();
    const pugi::xml_node north = ChildOf(t, "aziRef");
    if (const std::string word = TextOf(north); !word.empty() && word != "unknown") {
      const auto known = NorthOf(word);
      if (!known) {
        xml_.Complain(FaultCode::kRange, north, "azimuths from " + word + " are not read");
      }
      h.azimuth.north = *known;
    }
    h.azimuth.convergence = Number(ChildOf(t, "gridConUsed"), Quantity::kAngle);
    h.azimuth.declination = Number(ChildOf(t, "magDeclUsed"), Quantity::kAngle);
    h.grid_correction = Number(ChildOf(t, "gridCorUsed"), Quantity::kAngle);
    h.scale = Number(ChildOf(t, "gridScaleFactorUsed"), Quantity::kRatio);
    h.section_azimuth = Number(ChildOf(t, "aziVertSect"), Quantity::kAngle);
    h.section_north = Number(ChildOf(t, "dispNsVertSectOrig"), Quantity::kLength).value_or(0);
    h.section_east = Number(ChildOf(t, "dispEwVertSectOrig"), Quantity::kLength).value_or(0);
    h.datum = TextOf(ChildOf(ChildOf(t, "defaultMdDatum"), "title"));
    if (const auto tool = SurveyToolOf(TextOf(ChildOf(t, "nominalTypeSurveyTool")))) h.tool = *tool;
  }

  void Existence(pugi::xml_node t) {
    const std::string state = TextOf(ChildOf(ChildOf(t, "commonData"), "itemState"));
    const std::string existence = TextOf(ChildOf(t, "existence"));
    if (state == "plan" || existence == "planned") head().planned = true;
    if (state == "actual" || existence == "actual") head().planned = false;
  }

  void Common(pugi::xml_node t) {
    SurveyHead& h = head();
    const pugi::xml_node common = ChildOf(t, "commonData");
    if (h.names.created.empty()) h.names.created = TextOf(ChildOf(common, "dTimCreation"));
    const std::string comments = TextOf(ChildOf(common, "comments"));
    for (const pugi::xml_node holder : {common, t}) {
      for (const pugi::xml_node child : holder.children()) {
        if (LocalName(child) != "extensionNameValue") continue;
        const std::string name = TextOf(ChildOf(child, "name"));
        if (!name.starts_with(kExtension) || name == witsml::kRowExtension) continue;
        TakePair(h, name.substr(kExtension.size()), TextOf(ChildOf(child, "value")));
      }
    }
    if (!comments.empty() && h.remarks.empty()) h.remarks.push_back(comments);
  }

  // A number with its unit in @uom; nothing when the element is not there.
  std::optional<double> Number(pugi::xml_node node, Quantity quantity) {
    if (!node) return std::nullopt;
    const std::string text = TextOf(node);
    const auto number = NumberOf(text);
    if (!number) {
      xml_.Complain(FaultCode::kSyntax, node, "'" + text.substr(0, 40) + "' is not a number");
    }
    const std::string uom = node.attribute("uom").value();
    const auto factor = FactorOf(quantity, uom == "Euc" ? "" : uom);
    if (!factor) {
      xml_.Complain(FaultCode::kSyntax, node, "unit '" + uom + "' is not known for this element");
    }
    return ValueOf(quantity, *number, *factor);
  }

  // The depth itself, which 2.1 puts one level deeper.
  static pugi::xml_node Inner(pugi::xml_node node, std::string_view name) {
    const pugi::xml_node inner = ChildOf(node, name);
    return inner ? inner : node;
  }

  RowStatus StatusOf(pugi::xml_node s) {
    const std::string type = TextOf(ChildOf(s, "typeTrajStation"));
    if (TextOf(ChildOf(s, "statusTrajStation")) == "rejected") return RowStatus::kUnused;
    if (type == "tie in point") return RowStatus::kTieIn;
    if (type == "interpolated") return RowStatus::kInterpolated;
    if (type == "extrapolated") return RowStatus::kProjected;
    return head().planned == true ? RowStatus::kPlanned : RowStatus::kSurveyed;
  }

  void Station(pugi::xml_node s) {
    const pugi::xml_node md = Inner(ChildOf(s, "md"), "measuredDepth");
    const auto depth = Number(md, Quantity::kLength);
    const auto inclination = Number(ChildOf(s, "incl"), Quantity::kAngle);
    auto azimuth = Number(ChildOf(s, "azi"), Quantity::kDirection);
    const auto unwrapped = Number(ChildOf(s, "azi"), Quantity::kAngle);
    if (unwrapped && !AzimuthOf(*unwrapped, 1)) azimuth.reset();
    if (!depth) xml_.Complain(FaultCode::kSyntax, s, "no md");
    if (!inclination) xml_.Complain(FaultCode::kSyntax, s, "no incl");
    if (build_.table.rows() == 0) Units(s, md);
    if (const auto problem = build_.Add(*depth, *inclination, azimuth, StatusOf(s))) {
      xml_.Complain(problem->code, md, problem->text);
    }
    build_.Set(TextColumn::kUid, ToUtf8(s.attribute("uid").value()));
    if (const auto utc = UtcOf(TextOf(ChildOf(s, "dTimStn")))) build_.Set(Column::kUtc, *utc);
    for (const NamedColumn& e : kWitsmlElements) {
      if (e.column == Column::kInclination || e.column == Column::kAzimuth) continue;
      const pugi::xml_node node = Inner(ChildOf(s, e.name), "verticalDepth");
      Keep(e.column, Number(node, InfoOf(e.column).quantity));
    }
    Keep(Column::kGravity,
         Number(ChildOf(ChildOf(s, "valid"), "gravTotalFieldCalc"), Quantity::kAcceleration));
    Keep(Column::kLatitude, Number(ChildOf(s, "originalLatitude"), Quantity::kAngle));
    Keep(Column::kLongitude, Number(ChildOf(s, "originalLongitude"), Quantity::kAngle));
    Matrix(ChildOf(s, "matrixCov"));
    Models(s);
    for (const pugi::xml_node child : s.children()) {
      const std::string name = LocalName(child);
      if (name == "location") Location(child);
      if (name == "extensionNameValue") Extension(child);
    }
  }

  void Keep(Column column, const std::optional<double>& value) {
    if (value) build_.Set(column, *value);
  }

  void Units(pugi::xml_node s, pugi::xml_node md) {
    if (const auto unit = LengthUnitOf(md.attribute("uom").value())) head().md_unit = *unit;
    if (const auto unit = CurvatureUnitOf(ChildOf(s, "dls").attribute("uom").value())) {
      head().curvature_unit = *unit;
    }
    const std::string datum = ToUtf8(md.attribute("datum").value());
    if (!datum.empty()) head().datum = datum;
    if (const std::string method = TextOf(ChildOf(s, "calcAlgorithm")); !method.empty()) {
      head().method = method;
    }
  }

  void Matrix(pugi::xml_node matrix) {
    // Covariances may be stated at several sigma.
    const double sigma = Number(ChildOf(matrix, "sigma"), Quantity::kRatio).value_or(1);
    if (!(sigma > 0)) xml_.Complain(FaultCode::kRange, matrix, "sigma is not positive");
    for (const NamedColumn& e : kWitsmlMatrix) {
      const Quantity quantity = InfoOf(e.column).quantity;
      auto value = Number(ChildOf(matrix, e.name), quantity);
      if (value && quantity == Quantity::kArea) *value /= sigma * sigma;
      Keep(e.column, value);
    }
  }

  void Models(pugi::xml_node s) {
    if (const auto tool = SurveyToolOf(TextOf(ChildOf(s, "typeSurveyTool")))) {
      head().tool = *tool;
    }
    pugi::xml_node model = ChildOf(s, "iscwsaToolErrorModel");
    if (!model) model = ChildOf(s, "toolErrorModel");
    const pugi::xml_node title = ChildOf(model, "title");
    std::string name = TextOf(title ? title : model);
    std::string uid = model.attribute("uidRef").value();
    if (title) uid = TextOf(ChildOf(model, "uuid"));
    if (name.empty()) name = TextOf(ChildOf(s, "modelToolError"));
    if (name.empty()) return;
    if (head().error_model.empty()) {
      head().error_model = name;
      head().error_model_uid = uid;
    }
    if (name != head().error_model) build_.Set(TextColumn::kErrorModel, name);
  }

  void Location(pugi::xml_node location) {
    const std::string crs = TextOf(ChildOf(location, "wellCRS"));
    Keep(Column::kLatitude, Number(ChildOf(location, "latitude"), Quantity::kAngle));
    Keep(Column::kLongitude, Number(ChildOf(location, "longitude"), Quantity::kAngle));
    const pugi::xml_node easting = ChildOf(location, "easting");
    if (!easting) return;
    if (const auto unit = LengthUnitOf(easting.attribute("uom").value())) head().grid_unit = *unit;
    if (!crs.empty()) head().crs = crs;
    Keep(Column::kEasting, Number(easting, Quantity::kGridLength));
    Keep(Column::kNorthing, Number(ChildOf(location, "northing"), Quantity::kGridLength));
  }

  void Extension(pugi::xml_node extension) {
    const std::string name = TextOf(ChildOf(extension, "name"));
    const pugi::xml_node value = ChildOf(extension, "value");
    if (name == "c_earthRateCalc") {
      return Keep(Column::kEarthRateMeasured, Number(value, Quantity::kRate));
    }
    if (name == witsml::kRowExtension) {
      return witsml::UnpackRow(TextOf(value), build_.table, build_.table.rows() - 1);
    }
    if (!name.starts_with(kExtension)) return;
    const std::string key = name.substr(kExtension.size());
    if (key == "STATUS") {
      if (const auto status = RowStatusOf(TextOf(value))) {
        build_.SetStatus(*status);
      }
      return;
    }
    for (const TextColumnInfo& info : AllTextColumns()) {
      if (info.csv == key) return build_.Set(info.column, TextOf(value));
    }
    for (const ColumnInfo& info : AllColumns()) {
      if (info.csv != key) continue;
      const auto unit = LengthUnitOf(value.attribute("uom").value());
      if (info.column == Column::kDown && unit) head().grid_unit = *unit;
      return Keep(info.column, Number(value, info.quantity));
    }
  }

  XmlFile xml_;
  const ReadOptions& options_;
  TableBuilder build_;
};

}  // namespace

SurveyTable ReadWitsml(std::string bytes, const std::string& source, const ReadOptions& options) {
  return WitsmlReader(std::move(bytes), source, options).Read();
}

}  // namespace wellgyro
