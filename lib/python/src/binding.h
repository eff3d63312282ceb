#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include "wellgyro/base/result.h"
#include "wellgyro/record/check.h"
#include "wellgyro/uncertainty/propagate.h"

namespace wellgyro::python {

namespace nb = nanobind;

template <class T, int kDimensions>
using Input = nb::ndarray<const T, nb::ndim<kDimensions>, nb::c_contig, nb::device::cpu>;

/// A file, or text like one, that cannot be used: wellgyro.FileError.
struct FileError {
  std::string text;
};

/// What stands in columns of numbers where there is none.
inline constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// The value, or FileError.
template <class T>
T Taken(Result<T> result) {
  if (!result) throw FileError{SentenceOf(result.fault())};
  return *std::move(result);
}

/// Numbers that Python owns from here on, of `shape`.
template <class T>
nb::object Array(std::vector<T> values, std::vector<std::size_t> shape) {
  auto* const held = new std::vector<T>(std::move(values));
  nb::capsule owner(held, [](void* p) noexcept { delete static_cast<std::vector<T>*>(p); });
  return nb::cast(nb::ndarray<nb::numpy, T>(held->data(), shape.size(), shape.data(), owner));
}
template <class T>
nb::object Array(std::vector<T> values) {
  const std::size_t n = values.size();
  return Array(std::move(values), {n});
}

/// (n, 3, 3).
nb::object Matrices(const std::vector<Eigen::Matrix3d>& matrices);
/// (n, 3).
nb::object Vectors(const std::vector<Eigen::Vector3d>& vectors);

/// Columns of checks, as checks.csv has them.
nb::dict ColumnsOf(const std::vector<Check>& checks);

/// Where the well is, as the options of the program say it; degrees, nT.
struct PlaceArguments {
  std::optional<double> latitude_deg, convergence_deg, gravity_mps2, field_nt, dip_deg,
      declination_deg;
};
Surroundings SurroundingsOf(const PlaceArguments& place);

/// The report of a survey.json; in metres and on A4 unless told.
std::string ReportHtml(const std::string& survey_json, bool field_units, bool letter);

void AddSession(nb::module_& m);
void AddPlanning(nb::module_& m);
void AddFiles(nb::module_& m);
void AddFleet(nb::module_& m);
void AddBench(nb::module_& m);

}  // namespace wellgyro::python
