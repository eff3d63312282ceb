#include "wellgyro/uncertainty/formula_weight.h"

#include <algorithm>
#include <cmath>

namespace wellgyro {
namespace {

constexpr std::array<std::string_view, kFormulaNames> kNames = {"inc",
                                                                "azt",
                                                                "azm",
                                                                "az",
                                                                "md",
                                                                "tvd",
                                                                "incprev",
                                                                "aztprev",
                                                                "azmprev",
                                                                "azprev",
                                                                "mdprev",
                                                                "gfield",
                                                                "dip",
                                                                "bfield",
                                                                "earthrate",
                                                                "latitude",
                                                                "noisereductionfactor",
                                                                "xcltortuosity",
                                                                "rad",
                                                                "k",
                                                                "azi",
                                                                "tmd",
                                                                "dmd",
                                                                "gtot",
                                                                "mtot",
                                                                "lat",
                                                                "erot",
                                                                "mtf"};

constexpr WeightFunction kOwn = {"FORMULA", Dimension::kRatio, WeightRole::kPlain, {}, nullptr};

}  // namespace

const WeightFunction& OwnFormula() { return kOwn; }

Result<std::shared_ptr<const FormulaWeight>> FormulaWeight::Compile(const FormulaTexts& texts) {
  const std::string* const all[] = {&texts.md,   &texts.inclination, &texts.azimuth, &texts.north,
                                    &texts.east, &texts.vertical,    &texts.lateral};
  constexpr const char* kWhich[] = {"depth", "inclination", "azimuth", "north",
                                    "east",  "vertical",    "lateral"};
  auto made = std::make_shared<FormulaWeight>();
  for (std::size_t i = 0; i < made->formulas_.size(); ++i) {
    if (all[i]->empty()) continue;
    Result<Expression> read = Expression::Compile(*all[i], kNames);
    if (!read) {
      Fault fault = read.fault();
      fault.text = std::string(kWhich[i]) + ": " + fault.text;
      return fault;
    }
    if (i >= 3 && i <= 5) made->has_vector_ = true;
    if (read->Constant() == 0.0) continue;
    made->formulas_[i] = *std::move(read);
  }
  made->min_inclination_ = texts.min_inclination;
  made->max_inclination_ = texts.max_inclination;
  return std::shared_ptr<const FormulaWeight>(std::move(made));
}

Weights FormulaWeight::At(std::span<const double> values) const {
  const double inclination = values[static_cast<std::size_t>(FormulaName::kInc)];
  if (inclination < min_inclination_ || inclination > max_inclination_) return {};
  const auto value = [&](std::size_t i) { return formulas_[i] ? formulas_[i]->At(values) : 0.0; };
  Weights w{value(0), value(1), value(2)};
  if (formulas_[6]) w.azimuth += value(6) / std::sin(inclination);
  return w;
}

Eigen::Vector3d FormulaWeight::VectorAt(std::span<const double> values) const {
  const auto value = [&](std::size_t i) { return formulas_[i] ? formulas_[i]->At(values) : 0.0; };
  return {value(3), value(4), value(5)};
}

bool FormulaWeight::Uses(FormulaName name) const {
  const auto uses = [&](const std::optional<Expression>& formula) {
    return formula && formula->Uses(static_cast<std::size_t>(name));
  };
  return std::ranges::any_of(formulas_, uses);
}

bool FormulaWeight::needs_latitude() const {
  return Uses(FormulaName::kLatitude) || Uses(FormulaName::kLat) || Uses(FormulaName::kErot);
}

bool FormulaWeight::needs_field() const {
  using N = FormulaName;
  return Uses(N::kDip) || Uses(N::kBField) || Uses(N::kMtot) || Uses(N::kAzM) || Uses(N::kAzMPrev);
}

}  // namespace wellgyro
