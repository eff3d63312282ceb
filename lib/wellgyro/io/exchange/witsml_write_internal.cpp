// WITSML 1.4.1.1 and 2.1 trajectories. Order matters: the schemas are sequences.
#include <algorithm>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/core.h>

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

using witsml::Cut;
using witsml::DateTime;
using witsml::kNameLength;
using witsml::Method;
using witsml::Or;
using witsml::ToolText;
using witsml::Uid;
using witsml::UuidOf;

constexpr std::string_view kNoDate = witsml::kNoDate, kUnknown = witsml::kUnknown;

// Columns that stations carry as elements of their own; the others go as extensions.
bool IsElement(Column column) {
  const auto is = [&](const NamedColumn& e) { return e.column == column; };
  return column == Column::kMd || column == Column::kUtc || column == Column::kGravity ||
         column == Column::kLatitude || column == Column::kLongitude ||
         std::any_of(kWitsmlElements.begin(), kWitsmlElements.end(), is) ||
         std::any_of(kWitsmlMatrix.begin(), kWitsmlMatrix.end(), is);
}

class WitsmlWriter {
 public:
  WitsmlWriter(const SurveyTable& table, bool version_2)
      : table_(table), head_(table.head), units_(table.head, version_2), version_2_(version_2) {
    for (const ColumnInfo& info : AllColumns()) {
      const bool matrix =
          std::any_of(kWitsmlMatrix.begin(), kWitsmlMatrix.end(),
                      [&](const NamedColumn& e) { return e.column == info.column; });
      if (matrix || IsElement(info.column) || info.column == Column::kAzimuth) {
        native_.push_back(info.column);
      }
    }
  }

  std::string Write1411();
  std::string Write21();

 private:
  std::string Tag(std::string_view name) const {
    return version_2_ ? Capital(name) : std::string(name);
  }
  void Measure(std::string_view tag, Quantity quantity, const std::optional<double>& value,
               const std::string& datum = {}) {
    if (!value) return;
    xml_.Leaf(tag, units_.Text(quantity, *value),
              {{"uom", units_.Name(quantity)}, {"datum", datum}});
  }
  /// The datum as an attribute has it, which is an identifier.
  std::string Datum() const { return head_.datum.empty() ? "" : Uid(head_.datum, ""); }
  void Flag(std::string_view name, const std::optional<bool>& value);
  void Flags();
  void Section();
  void Citation();
  void Index();
  void HeadExtensions(const std::vector<std::string_view>& native);
  bool ComesBack(std::string_view key, const std::string& value) const;
  void Extension(std::string_view name, const std::string& value, const std::string& uom,
                 std::string_view type);
  void Reference(std::string_view tag, std::string_view type, const std::string& uuid,
                 const std::string& title);
  void Station(std::size_t row);
  void StationStart(std::size_t row);
  void Elements(std::size_t row, bool after_dogleg);
  void Model(std::size_t row);
  void Matrix(std::size_t row);
  void Location(std::size_t row);
  void StationExtensions(std::size_t row);
  std::string TypeOf(RowStatus status) const;

  const SurveyTable& table_;
  const SurveyHead& head_;
  witsml::Units units_;
  bool version_2_;
  std::vector<Column> native_;             ///< what 2.1 has elements for
  std::map<std::string, int> extensions_;  ///< how many of a name there are
  XmlWriter xml_;
};

void WitsmlWriter::Extension(std::string_view name, const std::string& value,
                             const std::string& uom, std::string_view type) {
  if (version_2_) {
    xml_.Open("eml:ExtensionNameValue");
    xml_.Leaf("eml:Name", name);
    xml_.Leaf("eml:Value", Cut(value, witsml::kValueLengthOf21), {{"uom", uom}});
  } else {
    // Remarks come in numbers, identifiers may not.
    const int number = ++extensions_[std::string(name)];
    const std::string uid = std::string(name) + (number > 1 ? fmt::format("-{}", number) : "");
    xml_.Open("extensionNameValue", {{"uid", uid}});
    xml_.Leaf("name", name);
    xml_.Leaf("value", Cut(value, witsml::kValueLength), {{"uom", uom}});
    xml_.Leaf("dataType", type);
  }
  xml_.Close();
}

void WitsmlWriter::HeadExtensions(const std::vector<std::string_view>& native) {
  for (const auto& [key, value] : PairsOf(head_)) {
    const bool own = std::find(native.begin(), native.end(), key) != native.end();
    if (own && ComesBack(key, value)) continue;
    Extension(std::string(kExtension) + key, value, "", "string");
  }
}

// Whether the element of a fact gives it back as it is.
bool WitsmlWriter::ComesBack(std::string_view key, const std::string& value) const {
  if (key == "method") return !Method(value).empty();
  if (key == "begin" || key == "end" || key == "created") return DateTime(value) == value;
  if (version_2_) return key != "survey" || Cut(value, 256) == value;
  if (key == "datum") return Uid(value, "") == value;
  return Cut(value, kNameLength) == value;
}

void WitsmlWriter::Reference(std::string_view tag, std::string_view type, const std::string& uuid,
                             const std::string& title) {
  xml_.Open(tag);
  xml_.Leaf("eml:Uuid", UuidOf(uuid, title, head_));
  xml_.Leaf("eml:QualifiedType", type);
  xml_.Leaf("eml:Title", title);
  xml_.Close();
}

std::string WitsmlWriter::TypeOf(RowStatus status) const {
  if (status == RowStatus::kTieIn) return "tie in point";
  // 1.4.1.1 has no value of its own for a measured station.
  if (!version_2_) return "unknown";
  if (status == RowStatus::kInterpolated) return "interpolated";
  if (status == RowStatus::kProjected) return "extrapolated";
  return "MD INCL and AZI";
}

void WitsmlWriter::StationStart(std::size_t row) {
  const std::string uid = Uid(table_.Get(TextColumn::kUid, row), fmt::format("s-{:06}", row));
  extensions_.clear();
  xml_.Open(Tag("trajectoryStation"), {{"uid", uid}});
  const auto utc = table_.Get(Column::kUtc, row);
  if (version_2_) {
    const std::string created = Or(DateTime(head_.names.created), kNoDate);
    xml_.Leaf("eml:Creation", created);
    xml_.Leaf("eml:LastUpdate", created);
    const std::string more = witsml::PackedRow(table_, row, native_);
    if (!more.empty()) Extension(witsml::kRowExtension, more, "", "string");
    xml_.Open("eml:Md");
    Measure("eml:MeasuredDepth", Quantity::kLength, table_.md(row));
    xml_.Close();
    Measure("OriginalLatitude", Quantity::kAngle, table_.Get(Column::kLatitude, row));
    Measure("OriginalLongitude", Quantity::kAngle, table_.Get(Column::kLongitude, row));
  }
  if (utc) xml_.Leaf(Tag("dTimStn"), IsoUtc(*utc));
  xml_.Leaf(Tag("typeTrajStation"), TypeOf(table_.status(row)));
  std::string tool = ToolText(head_.tool);
  // The list of values of 1.4.1.1 has two blanks here.
  if (!version_2_ && head_.tool == SurveyTool::kGyroMwd) tool = "gyroscopic  MWD";
  xml_.LeafIf(Tag("typeSurveyTool"), tool);
  xml_.LeafIf(Tag("calcAlgorithm"), Method(head_.method));
  if (!version_2_) Measure("md", Quantity::kLength, table_.md(row), Datum());
}

void WitsmlWriter::Elements(std::size_t row, bool after_dogleg) {
  for (const NamedColumn& e : kWitsmlElements) {
    if ((e.column == Column::kGravityRef) != after_dogleg) continue;
    const auto value = table_.Get(e.column, row);
    if (!value) continue;
    if (e.column == Column::kTvd && version_2_) {
      xml_.Open("Tvd", {{"xsi:type", "eml:DatumVerticalDepth"}});
      Measure("eml:VerticalDepth", Quantity::kLength, value);
      xml_.Close();
      continue;
    }
    const bool datum = e.column == Column::kTvd;
    Measure(Tag(e.name), InfoOf(e.column).quantity, value, datum ? Datum() : "");
  }
}

void WitsmlWriter::Model(std::size_t row) {
  const std::string model = Or(table_.Get(TextColumn::kErrorModel, row), head_.error_model);
  if (model.empty()) return;
  const std::string uid = model == head_.error_model ? head_.error_model_uid : "";
  if (version_2_) {
    Reference("ToolErrorModel", "witsml21.ToolErrorModel", uid, model);
  } else {
    xml_.Leaf("iscwsaToolErrorModel", Cut(model, kNameLength), {{"uidRef", Uid(uid, model)}});
  }
}

void WitsmlWriter::Matrix(std::size_t row) {
  const auto has = [&](Column c) { return table_.Get(c, row).has_value(); };
  bool any = false, whole = true;
  for (const NamedColumn& e : kWitsmlMatrix) {
    any = any || has(e.column);
    whole = whole && (has(e.column) || InfoOf(e.column).quantity == Quantity::kLength);
  }
  // 2.1 wants all of it, biases and sigma too.
  if (!any || (version_2_ && !whole)) return;
  xml_.Open(Tag("matrixCov"));
  for (const NamedColumn& e : kWitsmlMatrix) {
    auto value = table_.Get(e.column, row);
    if (version_2_ && !value) value = 0;
    Measure(Tag(e.name), InfoOf(e.column).quantity, value);
  }
  if (version_2_) xml_.Leaf("Sigma", "1");
  xml_.Close();
}

void WitsmlWriter::Location(std::size_t row) {
  const auto latitude = table_.Get(Column::kLatitude, row);
  const auto longitude = table_.Get(Column::kLongitude, row);
  if (latitude && longitude) {
    xml_.Open("location", {{"uid", "geographic"}});
    xml_.Leaf("wellCRS", "geographic", {{"uidRef", "geographic"}});
    Measure("latitude", Quantity::kAngle, latitude);
    Measure("longitude", Quantity::kAngle, longitude);
    xml_.Close();
  }
  const auto easting = table_.Get(Column::kEasting, row);
  const auto northing = table_.Get(Column::kNorthing, row);
  if (easting && northing) {
    xml_.Open("location", {{"uid", "projected"}});
    xml_.Leaf("wellCRS", Cut(Or(head_.crs, "unknown"), kNameLength), {{"uidRef", "projected"}});
    Measure("easting", Quantity::kGridLength, easting);
    Measure("northing", Quantity::kGridLength, northing);
    xml_.Close();
  }
}

// 2.1 allows a station one extension only, PackedRow's, so that these are for 1.4.1.1.
void WitsmlWriter::StationExtensions(std::size_t row) {
  if (const auto rate = table_.Get(Column::kEarthRateMeasured, row)) {
    Extension("c_earthRateCalc", units_.Text(Quantity::kRate, *rate), "dega/h", "double");
  }
  for (const ColumnInfo& info : AllColumns()) {
    const auto value = table_.Get(info.column, row);
    if (!value || IsElement(info.column) || info.column == Column::kEarthRateMeasured ||
        info.column == Column::kNorthing || info.column == Column::kEasting) {
      continue;
    }
    Extension(std::string(kExtension) + std::string(info.csv), units_.Text(info.quantity, *value),
              units_.Name(info.quantity), "double");
  }
  for (const TextColumnInfo& info : AllTextColumns()) {
    const std::string& text = table_.Get(info.column, row);
    if (text.empty() || info.column == TextColumn::kUid || info.column == TextColumn::kErrorModel) {
      continue;
    }
    Extension(std::string(kExtension) + std::string(info.csv), text, "", "string");
  }
  const RowStatus status = table_.status(row);
  const bool told = status == RowStatus::kSurveyed || status == RowStatus::kTieIn ||
                    status == RowStatus::kUnused ||
                    (status == RowStatus::kPlanned && head_.planned == true);
  if (!told) {
    Extension(std::string(kExtension) + "STATUS", std::string(WordOf(status)), "", "string");
  }
}

void WitsmlWriter::Station(std::size_t row) {
  StationStart(row);
  Elements(row, false);
  if (!version_2_) Model(row);
  Elements(row, true);
  const bool rejected = table_.status(row) == RowStatus::kUnused;
  xml_.Leaf(Tag("statusTrajStation"), rejected ? "rejected" : "position");
  if (const auto gravity = table_.Get(Column::kGravity, row)) {
    xml_.Open(Tag("valid"));
    Measure(Tag("gravTotalFieldCalc"), Quantity::kAcceleration, gravity);
    xml_.Close();
  }
  Matrix(row);
  if (version_2_) {
    Model(row);
  } else {
    Location(row);
    StationExtensions(row);
  }
  xml_.Close();
}

void WitsmlWriter::Section() {
  if (!head_.section_azimuth) return;
  Measure(Tag("aziVertSect"), Quantity::kAngle, head_.section_azimuth);
  Measure(Tag("dispNsVertSectOrig"), Quantity::kLength, head_.section_north);
  Measure(Tag("dispEwVertSectOrig"), Quantity::kLength, head_.section_east);
}

void WitsmlWriter::Flag(std::string_view name, const std::optional<bool>& value) {
  if (value) xml_.Leaf(Tag(name), *value ? "true" : "false");
}

void WitsmlWriter::Flags() {
  Flag("definitive", head_.definitive);
  Flag("memory", head_.memory);
  Flag("finalTraj", head_.final_survey);
}

std::string WitsmlWriter::Write1411() {
  xml_.Open("trajectorys",
            {{"xmlns", "http://www.witsml.org/schemas/1series"}, {"version", "1.4.1.1"}});
  const SurveyIdentity& names = head_.names;
  xml_.Open("trajectory", {{"uidWell", Uid(names.uid_well, Or(names.well, "well"))},
                           {"uidWellbore", Uid(names.uid_wellbore, Or(names.wellbore, "wellbore"))},
                           {"uid", Uid(names.uid_survey, "survey")}});
  xml_.Leaf("nameWell", Cut(Or(names.well, kUnknown), kNameLength));
  xml_.Leaf("nameWellbore", Cut(Or(names.wellbore, kUnknown), kNameLength));
  xml_.Leaf("name", Cut(Or(names.survey, kUnknown), kNameLength));
  xml_.LeafIf("dTimTrajStart", DateTime(names.begin));
  xml_.LeafIf("dTimTrajEnd", DateTime(names.end));
  Measure("mdMn", Quantity::kLength, table_.md(0), Datum());
  Measure("mdMx", Quantity::kLength, table_.md(table_.rows() - 1), Datum());
  xml_.LeafIf("serviceCompany", Cut(names.contractor, kNameLength));
  Measure("magDeclUsed", Quantity::kAngle, head_.azimuth.declination);
  Measure("gridCorUsed", Quantity::kAngle, head_.grid_correction);
  Measure("gridConUsed", Quantity::kAngle, head_.azimuth.convergence);
  Section();
  Flags();
  xml_.Leaf("aziRef", std::string(WordOf(head_.azimuth.north)) + " north");
  for (std::size_t row = 0; row < table_.rows(); ++row) Station(row);
  xml_.Open("commonData");
  xml_.LeafIf("dTimCreation", DateTime(names.created));
  if (head_.planned) xml_.Leaf("itemState", *head_.planned ? "plan" : "actual");
  xml_.LeafIf("comments", JoinedRemarks(head_));
  HeadExtensions({"well", "wellbore", "survey", "begin", "end", "created", "contractor",
                  "north_reference", "grid_convergence_deg", "declination_deg", "datum", "method",
                  "section_azimuth_deg", "tool", "error_model"});
  xml_.Close();
  xml_.Close();
  xml_.Close();
  return xml_.Take();
}

void WitsmlWriter::Citation() {
  xml_.Open("eml:Citation");
  xml_.Leaf("eml:Title", Cut(Or(head_.names.survey, kUnknown), 256));
  xml_.Leaf("eml:Originator", Cut(Or(head_.names.author, kUnknown), 64));
  xml_.Leaf("eml:Creation", Or(DateTime(head_.names.created), kNoDate));
  xml_.Leaf("eml:Format", "wellgyro:wellgyro:1");
  xml_.LeafIf("eml:Description", JoinedRemarks(head_));
  xml_.Close();
}

void WitsmlWriter::Index() {
  const std::string unit = units_.Name(Quantity::kLength);
  xml_.Open("eml:Index");
  xml_.Leaf("eml:IndexKind", "measured depth");
  xml_.Leaf("eml:Uom", unit);
  xml_.Leaf("eml:Direction", "increasing");
  xml_.Close();
  xml_.Open("eml:MdInterval");
  xml_.Leaf("eml:MdMin", units_.Text(Quantity::kLength, table_.md(0)));
  xml_.Leaf("eml:MdMax", units_.Text(Quantity::kLength, table_.md(table_.rows() - 1)));
  xml_.Leaf("eml:Uom", unit);
  xml_.Close();
}

std::string WitsmlWriter::Write21() {
  const SurveyIdentity& names = head_.names;
  xml_.Open("Trajectory", {{"xmlns", "http://www.energistics.org/energyml/data/witsmlv2"},
                           {"xmlns:eml", "http://www.energistics.org/energyml/data/commonv2"},
                           {"xmlns:xsi", "http://www.w3.org/2001/XMLSchema-instance"},
                           {"schemaVersion", "2.1"},
                           {"uuid", UuidOf(names.uid_survey, "trajectory", head_)}});
  Citation();
  if (head_.planned) xml_.Leaf("eml:Existence", *head_.planned ? "planned" : "actual");
  HeadExtensions({"survey", "begin", "end", "created", "contractor", "wellbore", "north_reference",
                  "grid_convergence_deg", "declination_deg", "datum", "method",
                  "section_azimuth_deg", "tool", "error_model", "grid_scale"});
  xml_.Leaf("eml:ActiveStatus", "inactive");
  Index();
  if (!names.contractor.empty()) {
    Reference("ServiceCompany", "eml23.BusinessAssociate", "", names.contractor);
  }
  xml_.LeafIf("DTimTrajEnd", DateTime(names.end));
  xml_.LeafIf("DTimTrajStart", DateTime(names.begin));
  Flags();
  if (!head_.datum.empty()) {
    Reference("DefaultMdDatum", "eml23.ReferencePoint", "", head_.datum);
    Reference("DefaultTvdDatum", "eml23.ReferencePoint", "", head_.datum);
  }
  for (std::size_t row = 0; row < table_.rows(); ++row) Station(row);
  Reference("Wellbore", "witsml21.Wellbore", names.uid_wellbore, Or(names.wellbore, kUnknown));
  Measure("MagDeclUsed", Quantity::kAngle, head_.azimuth.declination);
  xml_.LeafIf("NominalCalcAlgorithm", Method(head_.method));
  xml_.LeafIf("NominalTypeSurveyTool", ToolText(head_.tool));
  Measure("GridConUsed", Quantity::kAngle, head_.azimuth.convergence);
  if (head_.scale) xml_.Leaf("GridScaleFactorUsed", Exact(*head_.scale), {{"uom", "Euc"}});
  Section();
  xml_.Leaf("AziRef", std::string(WordOf(head_.azimuth.north)) + " north");
  xml_.Close();
  return xml_.Take();
}

// Offsets of one north, azimuths of another, would be read as one.
void CheckNorths(const SurveyTable& table) {
  NeedNorth(table, "WITSML");
  if (table.rows() == 0) Lacks("WITSML", "a station");
  const bool offsets = table.Has(Column::kNorth) && table.head.offsets != North::kUnknown;
  if (offsets && table.head.offsets != table.head.azimuth.north) {
    Lacks("WITSML", "offsets and azimuths of the same north");
  }
}

}  // namespace

std::string WriteWitsml1411(const SurveyTable& table) {
  CheckNorths(table);
  return WitsmlWriter(table, false).Write1411();
}

std::string WriteWitsml21(const SurveyTable& table) {
  CheckNorths(table);
  return WitsmlWriter(table, true).Write21();
}

}  // namespace wellgyro
