#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/io/result/empirical_files.h"
#include "wellgyro/io/result/taken_survey.h"
#include "wellgyro/io/toml/model_catalogue.h"

#include "binding.h"

namespace wellgyro::python {
namespace {

/// One hole: its name, its place, and surveys each with the number of its run.
using Hole = std::tuple<std::string, PlaceArguments, std::vector<std::pair<TakenSurvey*, int>>>;

nb::dict Estimate(const std::vector<Hole>& holes, const std::string& assumed,
                  double local_sigma_deg) {
  EmpiricalModel made;
  std::vector<OutputFile> files;
  {
    const nb::gil_scoped_release released;
    std::vector<RepeatedHole> repeated;
    for (const auto& [name, place, surveys] : holes) {
      repeated.push_back({name, SurroundingsOf(place), {}});
      for (const auto& [survey, run] : surveys) {
        repeated.back().surveys.push_back({survey->well, run});
      }
    }
    EmpiricalOptions options;
    options.local_sigma = FromDegrees(local_sigma_deg);
    made = EstimateModel(repeated, Taken(FindModel(assumed)), options);
    files = Taken(EmpiricalFiles(made));
  }
  nb::dict all, by_name;
  for (const OutputFile& file : files) by_name[file.name.c_str()] = file.bytes;
  all["files"] = by_name;
  all["notes"] = made.notes;
  return all;
}

}  // namespace

void AddFleet(nb::module_& m) { m.def("empirical_model", &Estimate); }

}  // namespace wellgyro::python
