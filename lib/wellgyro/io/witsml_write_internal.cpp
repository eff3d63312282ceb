// WITSML 1.4.1.1 and 2.1 trajectories. Order matters: the schemas are sequences.
#include <algorithm>
#include <array>

#include <fmt/core.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/base/units.h"
#include "wellgyro/io/iso_time_internal.h"
#include "wellgyro/io/sha256.h"
#include "wellgyro/io/survey_words_internal.h"
#include "wellgyro/io/table_build_internal.h"
#include "wellgyro/io/text_internal.h"
#include "wellgyro/io/witsml_internal.h"
#include "wellgyro/io/xml_internal.h"

namespace wellgyro {
namespace {

constexpr std::string_view kNoDate = "1970-01-01T00:00:00.000Z";

// Columns that stations carry as elements of their own; the others go as extensions.
bool IsElement(Column column) {
  const auto is = [&](const WitsmlElement& e) { return e.column == column; };
  return column == Column::kMd || column == Column::kUtc || column == Column::kGravity ||
         column == Column::kLatitude || column == Column::kLongitude ||
         std::any_of(kWitsmlElements.begin(), kWitsmlElements.end(), is) ||
         std::any_of(kWitsmlMatrix.begin(), kWitsmlMatrix.end(), is);
}

class Units {
 public:
  Units(const SurveyHead& head, bool version_2) : head_(head), version_2_(version_2) {}

  std::string Name(Quantity quantity) const {
    switch (quantity) {
      case Quantity::kLength:
        return Length(head_.md_unit);
      case Quantity::kGridLength:
        return Length(head_.grid_unit);
      case Quantity::kAngle:
      case Quantity::kDirection:
        return "dega";
      case Quantity::kCurvature:
        return Curvature();
      case Quantity::kArea:
        return head_.md_unit == LengthUnit::kFoot ? "ft2" : "m2";
      case Quantity::kAcceleration:
        return "m/s2";
      case Quantity::kRate:
        return "dega/h";
      case Quantity::kTemperature:
        return "degC";
      case Quantity::kTime:
        return "s";
      default:
        return "";
    }
  }

  std::string Text(Quantity quantity, double value) const {
    // There is no area in US survey feet.
    if (quantity == Quantity::kArea && head_.md_unit == LengthUnit::kUsFoot) return Exact(value);
    return Exact(quantity, value, head_);
  }

 private:
  std::string Length(LengthUnit unit) const {
    if (unit == LengthUnit::kUsFoot) return version_2_ ? "ft[US]" : "ftUS";
    return std::string(WordOf(unit));
  }

  std::string Curvature() const {
    switch (head_.curvature_unit) {
      case CurvatureUnit::kDegPer30m:
        return version_2_ ? "1/30 dega/m" : "dega/30m";
      case CurvatureUnit::kDegPer100ft:
        return version_2_ ? "0.01 dega/ft" : "dega/100ft";
      case CurvatureUnit::kDegPerMetre:
        return "dega/m";
      case CurvatureUnit::kDegPerFoot:
        return "dega/ft";
      default:
        return "rad/m";
    }
  }

  const SurveyHead& head_;
  bool version_2_;
};

// A UUID that the same survey gets again: the head of a hash of what it names.
std::string UuidOf(const std::string& given, std::string_view what, const SurveyHead& head) {
  const auto hexadecimal = [](char c) {
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f') || (c >= 'A' && c <= 'F');
  };
  if (given.size() == 36 && given[8] == '-' && given[13] == '-' && given[18] == '-' &&
      given[23] == '-' && std::count_if(given.begin(), given.end(), hexadecimal) == 32) {
    return given;
  }
  std::string hash = Sha256Hex(fmt::format("{}\n{}\n{}\n{}\n{}", what, given, head.names.well,
                                           head.names.wellbore, head.names.survey));
  hash[12] = '8';
  hash[16] = '8';
  return fmt::format("{}-{}-{}-{}-{}", hash.substr(0, 8), hash.substr(8, 4), hash.substr(12, 4),
                     hash.substr(16, 4), hash.substr(20, 12));
}

std::string Or(const std::string& text, std::string_view otherwise) {
  return text.empty() ? std::string(otherwise) : text;
}

// Identifiers of 1.4.1.1 have no blanks and 64 characters at most.
std::string Uid(const std::string& text, std::string_view otherwise) {
  std::string uid = Or(text, otherwise).substr(0, 64);
  for (char& c : uid) c = c > ' ' && c < 0x7F && c != ',' ? c : '-';
  return uid;
}

// xsd:dateTime of a day or an instant; nothing when it is neither.
std::string DateTime(const std::string& text) {
  if (UtcOf(text)) return text;
  const std::string midnight = text + "T00:00:00.000Z";
  return UtcOf(midnight) ? midnight : std::string();
}

// The schemas' list; another method goes as an extension.
std::string Method(const std::string& method) {
  constexpr std::array<std::string_view, 8> kMethods{
      "average angle", "balanced tangential", "constant tool face",  "custom",
      "inertial",      "minimum curvature",   "radius of curvature", "tangential"};
  const std::string lower = Lower(method);
  return std::find(kMethods.begin(), kMethods.end(), lower) == kMethods.end() ? "" : lower;
}

std::string Word(bool value) { return value ? "true" : "false"; }

std::string CapitalOf(std::string_view name) {
  std::string capital(name);
  capital[0] = static_cast<char>(capital[0] & ~0x20);
  return capital;
}

class WitsmlWriter {
 public:
  WitsmlWriter(const SurveyTable& table, bool version_2)
      : table_(table), head_(table.head), units_(table.head, version_2), version_2_(version_2) {}

  std::string Write1411();
  std::string Write21();

 private:
  std::string Tag(std::string_view name) const {
    return version_2_ ? CapitalOf(name) : std::string(name);
  }
  void Measure(std::string_view tag, Quantity quantity, const std::optional<double>& value,
               const std::string& datum = {}) {
    if (!value) return;
    xml_.Leaf(tag, units_.Text(quantity, *value),
              {{"uom", units_.Name(quantity)}, {"datum", datum}});
  }
  void HeadExtensions(const std::vector<std::string_view>& native);
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
  Units units_;
  bool version_2_;
  XmlWriter xml_;
};

void WitsmlWriter::Extension(std::string_view name, const std::string& value,
                             const std::string& uom, std::string_view type) {
  if (version_2_) {
    xml_.Open("eml:ExtensionNameValue");
    xml_.Leaf("eml:Name", name);
    xml_.Leaf("eml:Value", value, {{"uom", uom}});
  } else {
    xml_.Open("extensionNameValue", {{"uid", std::string(name)}});
    xml_.Leaf("name", name);
    xml_.Leaf("value", value, {{"uom", uom}});
    xml_.Leaf("dataType", type);
  }
  xml_.Close();
}

void WitsmlWriter::HeadExtensions(const std::vector<std::string_view>& native) {
  for (const auto& [key, value] : PairsOf(head_)) {
    const bool own = std::find(native.begin(), native.end(), key) != native.end();
    if (own && !(key == "method" && Method(value).empty())) continue;
    Extension(std::string(kExtension) + key, value, "", "string");
  }
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
  xml_.Open(Tag("trajectoryStation"), {{"uid", uid}});
  const auto utc = table_.Get(Column::kUtc, row);
  if (version_2_) {
    const std::string created = Or(DateTime(head_.names.created), kNoDate);
    xml_.Leaf("eml:Creation", created);
    xml_.Leaf("eml:LastUpdate", created);
    xml_.Open("eml:Md");
    Measure("eml:MeasuredDepth", Quantity::kLength, table_.md(row));
    xml_.Close();
    Measure("OriginalLatitude", Quantity::kAngle, table_.Get(Column::kLatitude, row));
    Measure("OriginalLongitude", Quantity::kAngle, table_.Get(Column::kLongitude, row));
  }
  if (utc) xml_.Leaf(Tag("dTimStn"), IsoUtc(*utc));
  xml_.Leaf(Tag("typeTrajStation"), TypeOf(table_.status(row)));
  std::string tool(WordOf(head_.tool));
  if (head_.tool == SurveyTool::kInclinationOnly) tool.clear();
  // The list of values of 1.4.1.1 has two blanks here.
  if (!version_2_ && head_.tool == SurveyTool::kGyroMwd) tool = "gyroscopic  MWD";
  xml_.LeafIf(Tag("typeSurveyTool"), tool);
  xml_.LeafIf(Tag("calcAlgorithm"), Method(head_.method));
  if (!version_2_) Measure("md", Quantity::kLength, table_.md(row), head_.datum);
}

void WitsmlWriter::Elements(std::size_t row, bool after_dogleg) {
  for (const WitsmlElement& e : kWitsmlElements) {
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
    Measure(Tag(e.name), InfoOf(e.column).quantity, value, datum ? head_.datum : "");
  }
}

void WitsmlWriter::Model(std::size_t row) {
  const std::string model = Or(table_.Get(TextColumn::kErrorModel, row), head_.error_model);
  if (model.empty()) return;
  const std::string uid = model == head_.error_model ? head_.error_model_uid : "";
  if (version_2_) {
    Reference("ToolErrorModel", "witsml21.ToolErrorModel", uid, model);
  } else {
    xml_.Leaf("iscwsaToolErrorModel", model, {{"uidRef", Uid(uid, model)}});
  }
}

void WitsmlWriter::Matrix(std::size_t row) {
  const auto has = [&](Column c) { return table_.Get(c, row).has_value(); };
  bool any = false, whole = true;
  for (const WitsmlElement& e : kWitsmlMatrix) {
    any = any || has(e.column);
    whole = whole && (has(e.column) || InfoOf(e.column).quantity == Quantity::kLength);
  }
  // 2.1 wants all of it, biases and sigma too.
  if (!any || (version_2_ && !whole)) return;
  xml_.Open(Tag("matrixCov"));
  for (const WitsmlElement& e : kWitsmlMatrix) {
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
    xml_.Leaf("wellCRS", Or(head_.crs, "unknown"), {{"uidRef", "projected"}});
    Measure("easting", Quantity::kGridLength, easting);
    Measure("northing", Quantity::kGridLength, northing);
    xml_.Close();
  }
}

// 2.1 allows a station one extension only, so that these are for 1.4.1.1.
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

std::string WitsmlWriter::Write1411() {
  xml_.Open("trajectorys",
            {{"xmlns", "http://www.witsml.org/schemas/1series"}, {"version", "1.4.1.1"}});
  const SurveyIdentity& names = head_.names;
  xml_.Open("trajectory", {{"uidWell", Uid(names.uid_well, Or(names.well, "well"))},
                           {"uidWellbore", Uid(names.uid_wellbore, Or(names.wellbore, "wellbore"))},
                           {"uid", Uid(names.uid_survey, "survey")}});
  xml_.Leaf("nameWell", Or(names.well, "unknown"));
  xml_.Leaf("nameWellbore", Or(names.wellbore, Or(names.well, "unknown")));
  xml_.Leaf("name", Or(names.survey, "survey"));
  xml_.LeafIf("dTimTrajStart", DateTime(names.begin));
  xml_.LeafIf("dTimTrajEnd", DateTime(names.end));
  Measure("mdMn", Quantity::kLength, table_.md(0), head_.datum);
  Measure("mdMx", Quantity::kLength, table_.md(table_.rows() - 1), head_.datum);
  xml_.LeafIf("serviceCompany", names.contractor);
  Measure("magDeclUsed", Quantity::kAngle, head_.azimuth.declination);
  Measure("gridCorUsed", Quantity::kAngle, head_.grid_correction);
  Measure("gridConUsed", Quantity::kAngle, head_.azimuth.convergence);
  Measure("aziVertSect", Quantity::kAngle, head_.section_azimuth);
  if (head_.section_azimuth) {
    Measure("dispNsVertSectOrig", Quantity::kLength, head_.section_north);
    Measure("dispEwVertSectOrig", Quantity::kLength, head_.section_east);
  }
  if (head_.definitive) xml_.Leaf("definitive", Word(*head_.definitive));
  if (head_.memory) xml_.Leaf("memory", Word(*head_.memory));
  if (head_.final_survey) xml_.Leaf("finalTraj", Word(*head_.final_survey));
  xml_.Leaf("aziRef", std::string(WordOf(head_.azimuth.north)) + " north");
  for (std::size_t row = 0; row < table_.rows(); ++row) Station(row);
  xml_.Open("commonData");
  xml_.LeafIf("dTimCreation", DateTime(names.created));
  if (head_.planned) xml_.Leaf("itemState", *head_.planned ? "plan" : "actual");
  HeadExtensions({"well", "wellbore", "survey", "begin", "end", "created", "contractor",
                  "north_reference", "grid_convergence_deg", "declination_deg", "datum", "method",
                  "section_azimuth_deg", "tool", "error_model"});
  xml_.Close();
  xml_.Close();
  xml_.Close();
  return xml_.Take();
}

std::string WitsmlWriter::Write21() {
  const SurveyIdentity& names = head_.names;
  xml_.Open("Trajectory", {{"xmlns", "http://www.energistics.org/energyml/data/witsmlv2"},
                           {"xmlns:eml", "http://www.energistics.org/energyml/data/commonv2"},
                           {"xmlns:xsi", "http://www.w3.org/2001/XMLSchema-instance"},
                           {"schemaVersion", "2.1"},
                           {"uuid", UuidOf(names.uid_survey, "trajectory", head_)}});
  xml_.Open("eml:Citation");
  xml_.Leaf("eml:Title", Or(names.survey, "survey"));
  xml_.Leaf("eml:Originator", Or(names.author, "unknown"));
  xml_.Leaf("eml:Creation", Or(DateTime(names.created), kNoDate));
  xml_.Leaf("eml:Format", "wellgyro:wellgyro:1");
  xml_.Close();
  if (head_.planned) xml_.Leaf("eml:Existence", *head_.planned ? "planned" : "actual");
  HeadExtensions({"survey", "begin", "end", "created", "contractor", "wellbore", "north_reference",
                  "grid_convergence_deg", "declination_deg", "datum", "method",
                  "section_azimuth_deg", "tool", "error_model", "grid_scale"});
  xml_.Leaf("eml:ActiveStatus", "inactive");
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
  if (!names.contractor.empty()) {
    Reference("ServiceCompany", "eml23.BusinessAssociate", "", names.contractor);
  }
  xml_.LeafIf("DTimTrajEnd", DateTime(names.end));
  xml_.LeafIf("DTimTrajStart", DateTime(names.begin));
  if (head_.definitive) xml_.Leaf("Definitive", Word(*head_.definitive));
  if (head_.memory) xml_.Leaf("Memory", Word(*head_.memory));
  if (head_.final_survey) xml_.Leaf("FinalTraj", Word(*head_.final_survey));
  if (!head_.datum.empty()) {
    Reference("DefaultMdDatum", "eml23.ReferencePoint", "", head_.datum);
    Reference("DefaultTvdDatum", "eml23.ReferencePoint", "", head_.datum);
  }
  for (std::size_t row = 0; row < table_.rows(); ++row) Station(row);
  Reference("Wellbore", "witsml21.Wellbore", names.uid_wellbore,
            Or(names.wellbore, Or(names.well, "unknown")));
  Measure("MagDeclUsed", Quantity::kAngle, head_.azimuth.declination);
  std::string tool(WordOf(head_.tool));
  if (head_.tool == SurveyTool::kInclinationOnly) tool.clear();
  xml_.LeafIf("NominalCalcAlgorithm", Method(head_.method));
  xml_.LeafIf("NominalTypeSurveyTool", tool);
  Measure("GridConUsed", Quantity::kAngle, head_.azimuth.convergence);
  if (head_.scale) xml_.Leaf("GridScaleFactorUsed", Exact(*head_.scale), {{"uom", "Euc"}});
  Measure("AziVertSect", Quantity::kAngle, head_.section_azimuth);
  if (head_.section_azimuth) {
    Measure("DispNsVertSectOrig", Quantity::kLength, head_.section_north);
    Measure("DispEwVertSectOrig", Quantity::kLength, head_.section_east);
  }
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
