#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include "wellgyro/io/toml/calibration_file.h"

namespace wellgyro {
namespace {

// A value and its sigma, to the sigma's second digit.
std::string Number(double value, double sigma) {
  if (!(sigma > 0)) return fmt::format("{:.9g}", value);
  const double digits = std::ceil(std::log10(std::max(std::abs(value), sigma) / sigma)) + 2;
  return fmt::format("{:.{}g} +- {:.2g}", value, std::clamp(static_cast<int>(digits), 2, 16),
                     sigma);
}

std::string Quantity(const FitQuantity& quantity) {
  const auto sigma = [&](Eigen::Index i, Eigen::Index j) {
    return quantity.sigma.size() > 0 ? quantity.sigma(i, j) : 0.0;
  };
  std::string text = fmt::format("  {}", quantity.name);
  if (quantity.shape == FitQuantity::Shape::kNumber) {
    return text + fmt::format(" = {}\n", Number(quantity.value(0, 0), sigma(0, 0)));
  }
  text += "\n";
  for (Eigen::Index i = 0; i < quantity.value.rows(); ++i) {
    text += "   ";
    for (Eigen::Index j = 0; j < quantity.value.cols(); ++j) {
      text += fmt::format("  {:<26}", Number(quantity.value(i, j), sigma(i, j)));
    }
    while (text.back() == ' ') text.pop_back();
    text += "\n";
  }
  return text;
}

// "Gx 0.001, Gy 0.002": root mean square of each channel's residuals, in its unit.
std::string Scatters(const FitReport& report) {
  std::vector<std::pair<std::string, std::pair<double, int>>> sums;
  for (const FitResidual& r : report.residuals) {
    auto at = std::find_if(sums.begin(), sums.end(),
                           [&](const auto& sum) { return sum.first == r.channel; });
    if (at == sums.end()) at = sums.insert(at, {r.channel, {0.0, 0}});
    at->second.first += r.value * r.value;
    ++at->second.second;
  }
  std::string text;
  for (const auto& [channel, sum] : sums) {
    text += fmt::format("{}{} {:.3g}", text.empty() ? "" : ", ", channel,
                        std::sqrt(sum.first / sum.second));
  }
  return text;
}

std::string Fit(const FitReport& report) {
  if (report.dof == 0) return fmt::format("{} readings, none to spare\n", report.readings);
  if (!report.sigma_given) {
    return fmt::format(
        "{} readings, {} to spare; the uncertainties rest on their residuals, rms {}\n",
        report.readings, report.dof, Scatters(report));
  }
  const bool inside = report.chi_square >= report.chi_low && report.chi_square <= report.chi_high;
  return fmt::format("{} readings, {} to spare; chi-square {:.1f}, {} 95 % of {:.1f} to {:.1f}\n",
                     report.readings, report.dof, report.chi_square, inside ? "inside" : "OUTSIDE",
                     report.chi_low, report.chi_high);
}

std::string Worst(const FitReport& report) {
  const FitResidual* worst = nullptr;
  const FitResidual* levered = nullptr;
  for (const FitResidual& r : report.residuals) {
    if (!worst || std::abs(r.studentised) > std::abs(worst->studentised)) worst = &r;
    if (!levered || r.leverage > levered->leverage) levered = &r;
  }
  std::string text;
  if (worst && report.dof > 0) {
    text += fmt::format(
        "worst residual: line {}, {}, {:.3g}, {:.1f} of its sigmas ({} the limit "
        "{:.1f})\n",
        worst->line, worst->channel, worst->value, std::abs(worst->studentised),
        std::abs(worst->studentised) > report.studentised_limit ? "BEYOND" : "within",
        report.studentised_limit);
  }
  if (levered && levered->leverage > 0.95) {
    text += fmt::format(
        "line {}, {}, cannot be checked: nothing else fixes what it fixes "
        "(leverage {:.2f})\n",
        levered->line, levered->channel, levered->leverage);
  }
  return text;
}

std::string Errors(std::string_view name, const OrthogonalityCheck::Errors& e) {
  return fmt::format("  {:<14} {:>10.4g} {:>10.4g} {:>12.4g} {:>12.4g}\n", name, e.G_mg, e.M_nT,
                     e.inclination_deg, e.azimuth_deg);
}

}  // namespace

std::string CalibrationSummary(const CalibrationFile& file) {
  const FitReport& report = file.report;
  std::string text = fmt::format("{}\n", report.method);
  for (const FitQuantity& quantity : report.result) {
    // Runs at single temperatures and lists of means stand in the file.
    if (quantity.name.rfind("per_T", 0) == 0 || quantity.value.rows() > 6) continue;
    text += Quantity(quantity);
  }
  text += Fit(report) + Worst(report);
  for (const int line : report.outlier_lines) text += fmt::format("left out: line {}\n", line);
  if (file.check) {
    text += fmt::format("verification at {} attitudes\n  {:<14} {:>10} {:>10} {:>12} {:>12}\n",
                        file.check->attitudes, "", "G rms mg", "M rms nT", "inc rms deg",
                        "azi med deg");
    text += Errors("raw", file.check->raw) + Errors("trigonometric", file.check->trigonometric) +
            Errors("affine", file.check->affine);
  }
  constexpr std::size_t kShown = 6;  // lines, the first
  for (std::size_t i = 0; i < std::min(report.correlations.size(), kShown); ++i) {
    text += fmt::format("correlated: {}\n", report.correlations[i]);
  }
  if (report.correlations.size() > kShown) {
    text += fmt::format("correlated: {} more, in the file\n", report.correlations.size() - kShown);
  }
  for (const std::string& remark : report.remarks) text += fmt::format("note: {}\n", remark);
  return text;
}

}  // namespace wellgyro
