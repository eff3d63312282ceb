#include "binding.h"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/base/units.h"
#include "wellgyro/fit/solver_log.h"
#include "wellgyro/io/words.h"

namespace wellgyro::python {

nb::object Matrices(const std::vector<Eigen::Matrix3d>& matrices) {
  std::vector<double> values;
  values.reserve(9 * matrices.size());
  for (const Eigen::Matrix3d& m : matrices) {
    for (int i = 0; i < 9; ++i) values.push_back(m(i / 3, i % 3));
  }
  return Array(std::move(values), {matrices.size(), 3, 3});
}

nb::object Vectors(const std::vector<Eigen::Vector3d>& vectors) {
  std::vector<double> values;
  values.reserve(3 * vectors.size());
  for (const Eigen::Vector3d& v : vectors) values.insert(values.end(), v.data(), v.data() + 3);
  return Array(std::move(values), {vectors.size(), 3});
}

nb::dict ColumnsOf(const std::vector<Check>& checks) {
  nb::list code, pass, unit, source, verdict;
  std::vector<std::int64_t> run;
  std::vector<double> md, value, sigma, limit;
  for (const Check& c : checks) {
    code.append(c.code);
    run.push_back(c.run);
    pass.append(c.pass ? nb::object(nb::str(std::string(WordOf(*c.pass)).c_str())) : nb::none());
    md.push_back(c.md.value_or(kNone));
    value.push_back(c.value.value_or(kNone));
    sigma.push_back(c.sigma.value_or(kNone));
    limit.push_back(c.limit.value_or(kNone));
    unit.append(c.unit);
    source.append(c.limit_source);
    verdict.append(std::string(WordOf(c.verdict)));
  }
  nb::dict columns;
  columns["code"] = code;
  columns["run"] = Array(std::move(run));
  columns["pass_"] = pass;
  columns["md_m"] = Array(std::move(md));
  columns["value"] = Array(std::move(value));
  columns["sigma"] = Array(std::move(sigma));
  columns["limit"] = Array(std::move(limit));
  columns["unit"] = unit;
  columns["limit_source"] = source;
  columns["verdict"] = verdict;
  return columns;
}

Surroundings SurroundingsOf(const PlaceArguments& place) {
  const auto radians = [](const std::optional<double>& deg) {
    return deg ? std::optional(FromDegrees(*deg)) : std::nullopt;
  };
  Surroundings s;
  s.latitude = radians(place.latitude_deg);
  s.dip = radians(place.dip_deg);
  s.declination = radians(place.declination_deg);
  s.convergence = FromDegrees(place.convergence_deg.value_or(0));
  if (place.gravity_mps2) s.gravity = *place.gravity_mps2;
  if (place.field_nt) s.field = *place.field_nt * units::kNanotesla;
  return s;
}

}  // namespace wellgyro::python

NB_MODULE(_wellgyro, m) {
  namespace nb = nanobind;
  using wellgyro::python::FileError;
  wellgyro::QuietSolverLog();
  m.attr("version") = WELLGYRO_VERSION;
  PyObject* const error = PyErr_NewExceptionWithDoc(
      "wellgyro.FileError", "A file, or text like one, that cannot be used; says where and why.",
      PyExc_OSError, nullptr);
  m.attr("FileError") = nb::steal(error);
  nb::register_exception_translator(
      [](const std::exception_ptr& p, void* type) {
        try {
          std::rethrow_exception(p);
        } catch (const FileError& e) {
          PyErr_SetString(static_cast<PyObject*>(type), e.text.c_str());
        }
      },
      error);
  nb::class_<wellgyro::python::PlaceArguments>(m, "Place")
      .def(nb::init<std::optional<double>, std::optional<double>, std::optional<double>,
                    std::optional<double>, std::optional<double>, std::optional<double>>());
  wellgyro::python::AddSession(m);
  wellgyro::python::AddPlanning(m);
  wellgyro::python::AddFleet(m);
  wellgyro::python::AddFiles(m);
  wellgyro::python::AddBench(m);
}
