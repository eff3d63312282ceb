#include "tool_prior.h"

#include <optional>
#include <utility>

#include <fmt/core.h>

#include "wellgyro/calibration/prior.h"
#include "wellgyro/io/atomic_file.h"
#include "wellgyro/io/sha256.h"
#include "wellgyro/io/toml/tool_file.h"

#include "report.h"

namespace wellgyro::apps {
namespace {

// Readings of this bench that the prior was made of too.
std::optional<Fault> Shared(const std::string& name, const ToolCalibration& prior,
                            const std::vector<InputFile>& inputs) {
  for (const InputFile& input : inputs) {
    if (input.role != "data" || !RestsOn(prior, input.sha256)) continue;
    return Fault{.code = FaultCode::kConflict,
                 .text = fmt::format("it rests on the readings of {} too, which would count "
                                     "twice: leave --prior out, or read the bench anew",
                                     input.name),
                 .source = name};
  }
  return std::nullopt;
}

std::optional<Fault> OfAnother(const std::string& name, const ToolCalibration& prior,
                               const ToolCalibration& tool) {
  const std::string &theirs = prior.asset_serial, &ours = tool.asset_serial;
  if (theirs.empty() || ours.empty() || theirs == ours) return std::nullopt;
  return Fault{.code = FaultCode::kConflict,
               .text = fmt::format("it is of tool {}, and this bench of {}: give the file of the "
                                   "same tool, or mend --asset-serial",
                                   theirs, ours),
               .source = name};
}

// What was known before must not contradict the bench more than once in a thousand, nor agree with
// it as only the same readings do.
std::optional<Fault> Unlikely(const std::string& name, const JoinedTool& joined) {
  constexpr double kChance = 1e-3;
  if (joined.probability < kChance) {
    return Fault{.code = FaultCode::kConflict,
                 .text = fmt::format("the bench contradicts it: chi-square {:.1f} of {}, as large "
                                     "by chance {:.1g}; the tool has changed, calibrate it "
                                     "without --prior, see calibrate history",
                                     joined.chi_square, joined.dof, joined.probability),
                 .source = name};
  }
  // Chance that independent readings differ as little. Of 16 sound benches one reached 3e-4.
  constexpr double kSame = 1e-5;
  if (joined.likeness >= kSame) return std::nullopt;
  return Fault{.code = FaultCode::kConflict,
               .text = fmt::format("it agrees with the bench better than other readings can: "
                                   "biases, sensitivities and force terms differ as little by "
                                   "chance {:.1g}; both rest on the same readings, which would "
                                   "count twice: leave --prior out",
                                   joined.likeness),
               .source = name};
}

Calibrated Joined(Calibrated before, JoinedTool joined) {
  before.tool = std::move(joined.tool);
  if (joined.members != before.members) return before;
  before.by_source = Propagated(before.by_source, joined.by_bench);
  before.by_source.Add("prior", std::move(joined.cov_by_prior));
  return before;
}

}  // namespace

Result<Calibrated> WithPrior(const std::string& name, Calibrated tool, CalibrationFile& file) {
  const Result<std::string> text = ReadTextFile(name);
  if (!text) return text.fault();
  const auto prior = ParseTool(*text, name);
  if (!prior) return prior.fault();
  if (auto fault = OfAnother(name, *prior, tool.tool)) return *std::move(fault);
  if (auto fault = Shared(name, *prior, file.inputs)) return *std::move(fault);
  JoinedTool joined = JoinPrior(tool.tool, *prior);
  if (auto fault = Unlikely(name, joined)) return *std::move(fault);
  fmt::print("prior: chi-square {:.1f} of {}, as large by chance {:.2g}\n", joined.chi_square,
             joined.dof, joined.probability);
  constexpr double kDoubtful = 1e-3;
  if (joined.likeness < kDoubtful) {
    Complain(fmt::format(
        "{} agrees with the bench as well as other readings do by chance {:.1g}: make sure that "
        "it does not rest on the same ones",
        name, joined.likeness));
  }
  file.inputs.push_back({"prior", name, name, Sha256Hex(*text)});
  file.report.remarks.push_back(fmt::format(
      "this result is of the bench's readings alone; the tool file, and the errors left in "
      "calibrated samples, hold {} as well",
      name));
  return Joined(std::move(tool), std::move(joined));
}

}  // namespace wellgyro::apps
