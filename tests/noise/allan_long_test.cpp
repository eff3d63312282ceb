// What takes minutes: a thousand logs of a million samples, a log of a hundred million. Figures are
// printed; run as tests/run --long, or .build/release/tests/noise/test-noise-long.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "wellgyro/math/random.h"
#include "wellgyro/noise/allan_variance.h"
#include "wellgyro/noise/noise_fit.h"

#include "noise/noise_maker.h"

namespace wellgyro {
namespace {

constexpr int kLogs = 1000;
constexpr std::size_t kSamples = 1'000'000;
constexpr double kPeriod = 0.01;

// The peer table of the literature survey: (deg/h) sqrt(s), deg/h, deg/h/sqrt(s).
constexpr double kN = 0.6;
constexpr double kB = 0.08;
constexpr double kK = 0.006;

struct Tally {
  std::vector<double> ratio;  // fitted over true, of all logs
  int observable = 0;
  int inside = 0;        // the 95 % interval holds the truth, of the observable
  int inside_sigma = 0;  // value +- 1.96 sigma does
  int bound_holds = 0;   // of the others

  void Take(const TermFit& term, double fitted, double truth) {
    ratio.push_back(truth > 0 ? fitted / truth : fitted);
    if (term.observable) {
      ++observable;
      inside += term.lower95 <= truth && truth <= term.upper95;
      inside_sigma += std::abs(term.value - truth) <= 1.96 * term.sigma;
    } else {
      bound_holds += truth <= term.upper95;
    }
  }
  double Median() const {
    auto sorted = ratio;
    std::nth_element(sorted.begin(), sorted.begin() + kLogs / 2, sorted.end());
    return sorted[kLogs / 2];
  }
  double Coverage() const { return static_cast<double>(inside) / std::max(1, observable); }
  void Print(const char* name) const {
    std::printf(
        "  %s: median %.4f, observable in %d, interval holds in %.1f %%, +-1.96 sigma in "
        "%.1f %%, bound of the others in %d of %d\n",
        name, Median(), observable, 100 * Coverage(), 100. * inside_sigma / std::max(1, observable),
        bound_holds, kLogs - observable);
  }
};

PerTerm<Tally> FitThousand(const NoiseCoefficients& truth, std::uint64_t first_seed) {
  PerTerm<Tally> tallies{};
  PerTerm<double> true_value{};
  true_value[NoiseTerm::kAngleRandomWalk] = truth.angle_random_walk;
  true_value[NoiseTerm::kBiasInstability] = truth.bias_instability;
  true_value[NoiseTerm::kRateRandomWalk] = truth.rate_random_walk;
  const auto factors = OctaveFactors(kSamples);
  for (int pair = 0; pair < kLogs / 2; ++pair) {
    const auto seed = first_seed + static_cast<std::uint64_t>(pair);
    const auto logs = test::LogPair(kSamples, kPeriod, truth, seed);
    for (const auto* log : {&logs.first, &logs.second}) {
      NoiseFitOptions options;  // one seed for all would err the same way a thousand times
      options.seed = 2 * seed + (log == &logs.second);
      const auto fit = FitNoise(AllanVariance(*log, kPeriod, factors), options);
      if (!fit) {
        ADD_FAILURE() << fit.fault().text;
        continue;
      }
      for (const auto term : kAllNoiseTerms) {
        tallies[term].Take(fit->term[term], fit->model.coefficient[term], true_value[term]);
      }
    }
  }
  return tallies;
}

TEST(AllanLong, FitsAThousandLogsWithoutBiasAndWithHonestIntervals) {
  NoiseCoefficients truth;
  truth.angle_random_walk = kN;
  truth.bias_instability = kB;
  truth.rate_random_walk = kK;
  const auto tallies = FitThousand(truth, 20000);
  const auto& n = tallies[NoiseTerm::kAngleRandomWalk];
  const auto& b = tallies[NoiseTerm::kBiasInstability];
  const auto& k = tallies[NoiseTerm::kRateRandomWalk];
  std::printf("%d logs of %zu samples, N %g, B %g, K %g, seeds from 20000:\n", kLogs, kSamples, kN,
              kB, kK);
  n.Print("N");
  b.Print("B");
  k.Print("K");
  EXPECT_NEAR(n.Median(), 1, 0.01);
  EXPECT_NEAR(b.Median(), 1, 0.03);
  EXPECT_NEAR(k.Median(), 1, 0.15);
  for (const auto* tally : {&n, &b, &k}) {
    EXPECT_GE(tally->Coverage(), 0.93);
    EXPECT_LE(tally->Coverage(), 0.97);
  }
}

TEST(AllanLong, SeesNothingButWhiteNoiseInAThousandWhiteLogs) {
  NoiseCoefficients truth;
  truth.angle_random_walk = kN;
  const auto tallies = FitThousand(truth, 30000);
  std::printf("%d white logs, seeds from 30000:\n", kLogs);
  tallies[NoiseTerm::kAngleRandomWalk].Print("N");
  tallies[NoiseTerm::kQuantization].Print("Q");
  tallies[NoiseTerm::kBiasInstability].Print("B");
  tallies[NoiseTerm::kRateRandomWalk].Print("K");
  tallies[NoiseTerm::kRateRamp].Print("R");
  for (const auto term :
       {NoiseTerm::kBiasInstability, NoiseTerm::kRateRandomWalk, NoiseTerm::kRateRamp}) {
    EXPECT_LE(tallies[term].observable, kLogs / 10);
  }
  EXPECT_EQ(tallies[NoiseTerm::kAngleRandomWalk].observable, kLogs);
}

// Of readings near 1e6, each a whole multiple of 2^-33, the truth in whole numbers: 128 bits hold
// every sum.
TEST(AllanLong, HundredMillionSamplesFarFromZeroKeepNineDigits) {
  constexpr std::size_t kMany = 100'000'000;
  std::vector<double> rate(kMany);
  Random random(31);
  for (auto& y : rate) y = 1e6 + random.Normal();
  const auto factors = OctaveFactors(kMany);
  const auto result = AllanVariance(rate, kPeriod, factors);
  std::vector<std::int64_t> x(kMany + 1, 0);
  for (std::size_t i = 0; i < kMany; ++i) {
    x[i + 1] = x[i] + static_cast<std::int64_t>(std::ldexp(rate[i] - 1e6, 33));
  }
  double worst = 0;
  for (const auto& point : result.points) {
    const auto m = static_cast<std::size_t>(point.factor);
    __extension__ using Wide = unsigned __int128;
    Wide squares = 0;
    for (std::size_t n = 2 * m; n <= kMany; ++n) {
      const std::int64_t d = (x[n] - x[n - m]) - (x[n - m] - x[n - 2 * m]);
      const auto size = static_cast<Wide>(d < 0 ? -d : d);
      squares += size * size;
    }
    const auto terms = static_cast<std::int64_t>(kMany - 2 * m + 1);
    EXPECT_EQ(point.terms, terms);
    const long double exact = std::ldexp(static_cast<long double>(squares), -66) /
                              (2.L * static_cast<long double>(m) * static_cast<long double>(m) *
                               static_cast<long double>(terms));
    const auto error = static_cast<double>(std::abs(point.variance / exact - 1));
    worst = std::max(worst, error);
    EXPECT_LE(error, 1e-9) << point.factor;
  }
  std::printf("1e8 samples, bias 1e6 sigma: worst relative error %.2g of %zu octaves\n", worst,
              result.points.size());
}

// Peak of the resident memory [bytes], as Linux tells it.
double PeakMemory() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with("VmHWM:")) return 1024 * std::stod(line.substr(6));
  }
  return 0;
}

TEST(AllanLong, NeedsLittleBesideItsData) {
  constexpr std::size_t kMany = 10'000'000;
  const double before = PeakMemory();
  if (before == 0) GTEST_SKIP() << "no /proc/self/status here";
  if (before > 1e8) GTEST_SKIP() << "something larger ran before in this process: run it alone";
  std::vector<double> rate(kMany);
  Random random(1);
  for (auto& y : rate) y = random.Normal();
  const auto result = AllanVariance(rate, kPeriod, OctaveFactors(kMany));
  EXPECT_EQ(result.points.size(), 23u);
  const double per_sample = (PeakMemory() - before) / static_cast<double>(kMany);
  std::printf("1e7 samples: %.2f bytes a sample at the peak, the sample's own 8 among them\n",
              per_sample);
  EXPECT_LE(per_sample, 16);
}

}  // namespace
}  // namespace wellgyro
