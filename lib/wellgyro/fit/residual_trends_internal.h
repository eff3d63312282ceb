#pragma once

#include "wellgyro/calibration/bench_table.h"
#include "wellgyro/calibration/fit_report.h"
#include "wellgyro/fit/least_squares_internal.h"

namespace wellgyro {

/// Tests each channel's residuals against the order of the readings, as a slope and as a step, and
/// against column T_C, where the table has one: as a term more that the model might have had, one
/// false alarm in a hundred tables. What is found is told, with the parameter that such a term
/// would move most; with the outliers where it is not found without them. Nothing without
/// redundancy.
void TestTrends(const BenchTable& data, const LinearProblem& problem,
                const LinearSolution& solution, const LineNames& name, FitReport& report);

/// Says that the temperatures of the table play no part in the method, where they vary.
void RemarkTemperature(const BenchTable& data, FitReport& report);

}  // namespace wellgyro
