#include "wellgyro/io/toml/calibration_file.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <utility>

#include <fmt/core.h>

#include "wellgyro/io/formats.h"
#include "wellgyro/io/toml/toml_internal.h"
#include "wellgyro/io/toml/toml_writer_internal.h"

namespace wellgyro {
namespace {

using Shape = FitQuantity::Shape;
constexpr std::size_t kResidualsShown = 4000;  // even

void WriteValue(TomlWriter& out, std::string_view name, Shape shape, const Eigen::MatrixXd& value) {
  if (shape == Shape::kNumber) out.Number(name, value(0, 0));
  if (shape == Shape::kVector) {
    const std::vector<double> numbers(value.data(), value.data() + value.size());
    out.Numbers(name, numbers);
  }
  if (shape == Shape::kMatrix) out.Rows(name, value);
}

// "per_T[3].S": the place and the name; -1 for any other.
std::pair<int, std::string> Split(const std::string& name) {
  constexpr std::string_view kPrefix = "per_T[";
  if (name.rfind(kPrefix, 0) != 0) return {-1, name};
  const std::size_t end = name.find("].");
  return {std::stoi(name.substr(kPrefix.size(), end - kPrefix.size())), name.substr(end + 2)};
}

void WriteResult(TomlWriter& out, const FitReport& report, bool sigma) {
  const std::string table = sigma ? "result_sigma" : "result";
  out.Table(table);
  if (sigma) out.Comment("1-sigma");
  int open = -1;
  for (const FitQuantity& quantity : report.result) {
    const auto [place, name] = Split(quantity.name);
    const Eigen::MatrixXd& value = sigma ? quantity.sigma : quantity.value;
    if (place > open) {
      out.Element(table + ".per_T");
      open = place;
    }
    if (value.size() > 0) WriteValue(out, name, quantity.shape, value);
  }
}

void WriteStatistics(TomlWriter& out, const FitReport& report) {
  out.Table("statistics");
  out.Whole("readings", report.readings);
  out.Whole("parameters", static_cast<std::int64_t>(report.parameters.size()));
  out.Whole("dof", report.dof);
  out.Flag("sigma_given", report.sigma_given);
  out.Number("chi_square", report.chi_square);
  const double band[] = {report.chi_low, report.chi_high};
  out.Numbers("chi_square_95", band);
  out.Number("scatter", report.scatter);
  out.Number("half_sum_of_squares", report.half_square_sum);
  out.Number("condition", report.condition);
  out.Number("studentised_limit", report.studentised_limit);
  out.Wholes("outlier_lines", report.outlier_lines);
  out.Texts("correlations", report.correlations);
  out.Texts("remarks", report.remarks);
}

// Of many residuals the largest, then every so many of the rest; all of them in their order.
std::vector<std::size_t> ShownResiduals(const FitReport& report) {
  std::vector<std::size_t> shown(report.residuals.size());
  std::iota(shown.begin(), shown.end(), std::size_t{0});
  if (shown.size() <= kResidualsShown) return shown;
  const auto half = static_cast<std::ptrdiff_t>(kResidualsShown / 2);
  std::nth_element(shown.begin(), shown.begin() + half, shown.end(),
                   [&](std::size_t a, std::size_t b) {
                     const auto size = [&](std::size_t i) {
                       return std::pair(-std::abs(report.residuals[i].studentised), i);
                     };
                     return size(a) < size(b);
                   });
  std::sort(shown.begin() + half, shown.end());
  const std::size_t rest = shown.size() - kResidualsShown / 2;
  std::vector<std::size_t> kept(shown.begin(), shown.begin() + half);
  for (std::size_t i = 0; i < kResidualsShown / 2; ++i) {
    kept.push_back(shown[kResidualsShown / 2 + i * rest / (kResidualsShown / 2)]);
  }
  std::sort(kept.begin(), kept.end());
  return kept;
}

void WriteResiduals(TomlWriter& out, const FitReport& report) {
  out.Table("residuals");
  out.Comment(
      "reading by reading: line of the data, channel, measured less fitted in the data's "
      "unit,\nover its own sigma, leverage");
  const std::vector<std::size_t> shown = ShownResiduals(report);
  if (shown.size() < report.residuals.size()) {
    out.Comment(fmt::format("the {} largest of {} and as many of the others, evenly",
                            kResidualsShown / 2, report.residuals.size()));
  }
  std::vector<int> lines;
  std::vector<std::string> channels;
  std::vector<double> values, studentised, leverage;
  for (const std::size_t i : shown) {
    const FitResidual& residual = report.residuals[i];
    lines.push_back(residual.line);
    channels.push_back(residual.channel);
    values.push_back(residual.value);
    studentised.push_back(residual.studentised);
    leverage.push_back(residual.leverage);
  }
  out.Wholes("line", lines);
  out.Texts("channel", channels);
  out.Numbers("value", values);
  out.Numbers("studentised", studentised);
  out.Numbers("leverage", leverage);
}

void WriteBudget(TomlWriter& out, const UncertaintyBudget& budget) {
  out.Table("budget");
  out.Comment(
      "what each source contributes to the 1-sigma of each of the covariance's parameters; the "
      "first\nsources are of type A, by the readings' scatter (JCGM 100)");
  out.Texts("sources", budget.sources);
  out.Whole("type_a", budget.n_type_a);
  out.Rows("rows", budget.contributions);
  const std::vector<double> dof(budget.dof.begin(), budget.dof.end());
  out.Numbers("dof", dof);
}

void WriteErrors(TomlWriter& out, std::string_view name, const OrthogonalityCheck::Errors& errors) {
  const double numbers[] = {errors.G_mg, errors.M_nT, errors.inclination_deg, errors.azimuth_deg};
  out.Numbers(name, numbers);
}

void WriteCheck(TomlWriter& out, const OrthogonalityCheck& check) {
  out.Table("verification");
  out.Comment("G [mg, rms], M [nT, rms], inclination [deg, rms], azimuth [deg, median]");
  out.Whole("attitudes", check.attitudes);
  out.Whole("fell_back", check.fell_back);
  WriteErrors(out, "raw", check.raw);
  WriteErrors(out, "trigonometric", check.trigonometric);
  WriteErrors(out, "affine", check.affine);
}

Eigen::MatrixXd ReadValue(TomlTable& table, const std::string& key, Shape* shape) {
  const int depth = table.Depth(key);
  if (depth == 0) {
    *shape = Shape::kNumber;
    return Eigen::MatrixXd::Constant(1, 1, table.Need(key, table.FindNumber(key, kAnyNumber)));
  }
  if (depth == 1) {
    *shape = Shape::kVector;
    const auto numbers = table.Need(key, table.FindNumbers(key, kAnyNumber));
    return Eigen::Map<const Eigen::VectorXd>(numbers.data(),
                                             static_cast<Eigen::Index>(numbers.size()));
  }
  *shape = Shape::kMatrix;
  const auto rows = table.Need(key, table.FindRows(key, table.Width(key)));
  Eigen::MatrixXd value(static_cast<Eigen::Index>(rows.size()),
                        static_cast<Eigen::Index>(rows.front().size()));
  for (Eigen::Index i = 0; i < value.rows(); ++i) {
    value.row(i) = Eigen::Map<const Eigen::RowVectorXd>(rows[static_cast<std::size_t>(i)].data(),
                                                        value.cols());
  }
  return value;
}

void ReadQuantities(TomlTable& table, const std::string& prefix, bool sigma, FitReport& report) {
  for (const std::string& key : table.Keys()) {
    if (key == "per_T") continue;
    FitQuantity quantity{prefix + key, Shape::kNumber, {}, {}};
    const Eigen::MatrixXd value = ReadValue(table, key, &quantity.shape);
    if (!sigma) {
      quantity.value = value;
      report.result.push_back(std::move(quantity));
      continue;
    }
    const auto found = std::find_if(report.result.begin(), report.result.end(),
                                    [&](const FitQuantity& q) { return q.name == quantity.name; });
    if (found == report.result.end()) table.Refuse(key, "has no value in [result]");
    found->sigma = value;
  }
  int place = 0;
  for (TomlTable& element : table.FindTables("per_T")) {
    ReadQuantities(element, fmt::format("per_T[{}].", place++), sigma, report);
  }
}

constexpr std::int64_t kMany = 1'000'000'000;  // an int holds it

void ReadStatistics(TomlTable& table, FitReport& report) {
  const auto whole = [&](std::string_view key) {
    return static_cast<int>(table.Need(key, table.FindInteger(key, 0, kMany)));
  };
  report.readings = whole("readings");
  whole("parameters");
  report.dof = whole("dof");
  report.sigma_given = table.Need("sigma_given", table.FindBool("sigma_given"));
  table.Read("chi_square", report.chi_square, 1, kNotNegative);
  const auto band = table.Need("chi_square_95", table.FindNumbers("chi_square_95", kNotNegative));
  if (band.size() != 2) table.Refuse("chi_square_95", "must be two numbers");
  report.chi_low = band[0];
  report.chi_high = band[1];
  table.Read("scatter", report.scatter, 1, kNotNegative);
  table.Read("half_sum_of_squares", report.half_square_sum, 1, kNotNegative);
  table.Read("condition", report.condition, 1, kPositive);
  table.Read("studentised_limit", report.studentised_limit, 1, kNotNegative);
  for (const double line :
       table.Need("outlier_lines", table.FindNumbers("outlier_lines", kPositive))) {
    report.outlier_lines.push_back(static_cast<int>(line));
  }
  report.correlations = table.Need("correlations", table.FindStrings("correlations"));
  report.remarks = table.Need("remarks", table.FindStrings("remarks"));
}

Eigen::MatrixXd ReadRows(TomlTable& table, std::size_t n, std::size_t width) {
  const auto rows = table.Need("rows", table.FindRows("rows", width));
  if (rows.size() != n) table.Refuse("rows", fmt::format("must be {} rows", n));
  Eigen::MatrixXd matrix(static_cast<Eigen::Index>(n), static_cast<Eigen::Index>(width));
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    matrix.row(i) = Eigen::Map<const Eigen::RowVectorXd>(rows[static_cast<std::size_t>(i)].data(),
                                                         matrix.cols());
  }
  return matrix;
}

void ReadCovariance(TomlTable& table, FitReport& report) {
  report.parameters = table.Need("parameters", table.FindStrings("parameters"));
  const std::size_t n = report.parameters.size();
  const auto values = table.Need("values", table.FindNumbers("values", kAnyNumber));
  if (values.size() != n) table.Refuse("values", fmt::format("must be {} numbers", n));
  report.values = Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(n));
  if (table.FindRows("rows", n)) report.cov = ReadRows(table, n, n);
}

UncertaintyBudget ReadBudget(TomlTable& table, std::size_t n) {
  UncertaintyBudget budget;
  budget.sources = table.Need("sources", table.FindStrings("sources"));
  const auto n_sources = static_cast<std::int64_t>(budget.sources.size());
  budget.n_type_a = table.Need("type_a", table.FindInteger("type_a", 0, n_sources));
  budget.contributions = ReadRows(table, n, budget.sources.size());
  const auto dof = table.Need("dof", table.FindNumbers("dof", kPositive));
  if (dof.size() != n) table.Refuse("dof", fmt::format("must be {} numbers", n));
  budget.dof = Eigen::Map<const Eigen::VectorXd>(dof.data(), static_cast<Eigen::Index>(n));
  return budget;
}

void ReadResiduals(TomlTable& table, FitReport& report) {
  const auto lines = table.Need("line", table.FindNumbers("line", kPositive));
  const auto channels = table.Need("channel", table.FindStrings("channel"));
  const auto column = [&](std::string_view key) {
    auto numbers = table.Need(key, table.FindNumbers(key, kAnyNumber));
    if (numbers.size() != lines.size()) {
      table.Refuse(key, fmt::format("must be {} numbers, as many as lines", lines.size()));
    }
    return numbers;
  };
  if (channels.size() != lines.size()) table.Refuse("channel", "must be as many as lines");
  const auto values = column("value"), studentised = column("studentised");
  const auto leverage = column("leverage");
  for (std::size_t i = 0; i < lines.size(); ++i) {
    report.residuals.push_back(
        {static_cast<int>(lines[i]), channels[i], values[i], studentised[i], leverage[i]});
  }
}

OrthogonalityCheck ReadCheck(TomlTable& table) {
  OrthogonalityCheck check;
  const auto whole = [&](std::string_view key) {
    return static_cast<int>(table.Need(key, table.FindInteger(key, 0, kMany)));
  };
  check.attitudes = whole("attitudes");
  check.fell_back = whole("fell_back");
  for (const auto& [key, errors] :
       {std::pair("raw", &check.raw), std::pair("trigonometric", &check.trigonometric),
        std::pair("affine", &check.affine)}) {
    const auto numbers = table.Need(key, table.FindNumbers(key, kNotNegative));
    if (numbers.size() != 4) table.Refuse(key, "must be four numbers");
    *errors = {numbers[0], numbers[1], numbers[2], numbers[3]};
  }
  return check;
}

CalibrationFile TakeCalibration(TomlTable& root) {
  CalibrationFile file;
  FitReport& report = file.report;
  report.method = root.Need("method", root.FindString("method"));
  root.Read("program", file.program);
  file.references = root.FindStrings("references").value_or(std::vector<std::string>{});
  for (TomlTable& table : root.FindTables("data")) {
    InputFile& input = file.inputs.emplace_back();
    input.role = table.Need("role", table.FindString("role"));
    input.name = table.Need("file", table.FindString("file"));
    input.sha256 = table.Need("sha256", table.FindString("sha256"));
  }
  auto result = root.Need("result", root.FindTable("result"));
  ReadQuantities(result, "", false, report);
  if (auto sigma = root.FindTable("result_sigma")) ReadQuantities(*sigma, "", true, report);
  auto statistics = root.Need("statistics", root.FindTable("statistics"));
  ReadStatistics(statistics, report);
  if (auto table = root.FindTable("verification")) file.check = ReadCheck(*table);
  auto covariance = root.Need("covariance", root.FindTable("covariance"));
  ReadCovariance(covariance, report);
  if (auto table = root.FindTable("budget")) {
    report.budget = ReadBudget(*table, report.parameters.size());
  }
  auto residuals = root.Need("residuals", root.FindTable("residuals"));
  ReadResiduals(residuals, report);
  return file;
}

}  // namespace

std::string CalibrationToml(const CalibrationFile& file) {
  const FitReport& report = file.report;
  TomlWriter out;
  out.Text("format", formats::kCalibration);
  out.Text("method", report.method);
  out.Text("program", file.program);
  out.Texts("references", file.references);
  for (const InputFile& input : file.inputs) {
    out.Element("data");
    out.Text("role", input.role);
    out.Text("file", input.name);
    out.Text("sha256", input.sha256);
  }
  WriteResult(out, report, false);
  WriteResult(out, report, true);
  WriteStatistics(out, report);
  if (file.check) WriteCheck(out, *file.check);
  out.Table("covariance");
  out.Texts("parameters", report.parameters);
  const std::vector<double> values(report.values.begin(), report.values.end());
  out.Numbers("values", values);
  if (report.cov.size() > 0) out.Rows("rows", report.cov);
  if (!report.budget.sources.empty()) WriteBudget(out, report.budget);
  WriteResiduals(out, report);
  return out.text();
}

Result<CalibrationFile> ParseCalibration(std::string_view text, const std::string& source) {
  return ReadTomlText<CalibrationFile>(text, source, formats::kCalibration, TakeCalibration);
}

}  // namespace wellgyro
