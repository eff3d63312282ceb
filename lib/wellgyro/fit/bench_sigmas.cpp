#include "wellgyro/fit/bench_sigmas.h"

#include <fmt/core.h>

#include "wellgyro/base/units.h"

namespace wellgyro {

std::optional<double> BenchSigma::Of(const ToolFitSetup& setup) const {
  const std::optional<double> value =
      std::visit([&](const auto& member) -> std::optional<double> { return setup.*member; }, held);
  return value ? *value / unit : value;
}

void BenchSigma::Take(double value, ToolFitSetup& setup) const {
  std::visit([&](const auto& member) { setup.*member = value * unit; }, held);
}

std::span<const BenchSigma> BenchSigmas() {
  using S = ToolFitSetup;
  static constexpr BenchSigma kAll[] = {
      {"level-deg", units::kDeg, "1 sigma of a bench's tilt", &S::sigma_level},
      {"north-sigma-deg", units::kDeg, "1 sigma of a bench's north", &S::sigma_north},
      {"inclination-sigma-deg", units::kDeg, "1 sigma of a stand's zero of inclination",
       &S::sigma_inclination},
      {"latitude-sigma-deg", units::kDeg, "1 sigma of the latitude", &S::sigma_latitude},
      {"seat-arcsec", units::kArcsec, "1 sigma of the tool's seat on the rate table",
       &S::sigma_axis},
      {"rate-scale-ppm", 1e-6, "1 sigma of the scale of the rate table's rates",
       &S::sigma_rate_scale},
      {"drift-deg-per-h", 1, "1 sigma of a gyro's drift from the middle to the end of a table",
       &S::sigma_drift},
      {"second-order-ug-per-g2", 1e-6,
       "1 sigma of accelerometers' second order where the positions do not tell it",
       &S::sigma_second_order},
      {"anisoelastic-deg-per-h-per-g2", 1,
       "1 sigma of gyros' anisoelasticity where the positions do not tell it",
       &S::sigma_anisoelastic},
      {"wobble-arcsec", units::kArcsec, "1 sigma of each reading's attitude", &S::sigma_wobble},
      {"sigma-accel", 1, "1 sigma of an accelerometer's reading, its unit", &S::sigma_accel},
      {"sigma-deg-per-h", 1, "1 sigma of a gyro's reading at rest", &S::sigma_gyro},
      {"sigma-table-deg-per-h", 1, "1 sigma of one on the rate table", &S::sigma_gyro_table},
  };
  return kAll;
}

std::vector<std::string> BenchReferences(std::span<const std::string> site,
                                         const ToolFitSetup& setup,
                                         const std::set<std::string, std::less<>>& stated) {
  std::vector<std::string> references;
  bool gravity = false;
  for (const std::string& said : site) {
    references.push_back(said + " (stated)");
    gravity = gravity || said.rfind("gravity-", 0) == 0;
  }
  if (!gravity) {
    references.push_back(fmt::format("gravity {:.6g} m/s2 ({})", setup.reference.gravity_mps2,
                                     setup.reference.gravity_mps2 == units::kStandardGravity
                                         ? "standard, default"
                                         : "normal at the latitude and sea level, default"));
  }
  const auto how = [&](std::string_view name) {
    return stated.find(name) != stated.end() ? "stated" : "default";
  };
  for (const BenchSigma& sigma : BenchSigmas()) {
    const std::optional<double> value = sigma.Of(setup);
    references.push_back(
        value ? fmt::format("{} {:.4g} (1 sigma, {})", sigma.name, *value, how(sigma.name))
              : fmt::format("{} found from the readings", sigma.name));
  }
  constexpr std::string_view kDegree = "max-degree";
  references.push_back(fmt::format("{} {} ({})", kDegree, setup.max_degree, how(kDegree)));
  return references;
}

}  // namespace wellgyro
