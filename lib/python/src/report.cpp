#include "wellgyro/page/report_page.h"

#include "binding.h"

namespace wellgyro::python {

std::string ReportHtml(const std::string& survey_json, bool field_units, bool letter) {
  ReportOptions options;
  if (field_units) options.units = ReportOptions::Units::kField;
  if (letter) options.paper = ReportOptions::Paper::kLetter;
  return Taken(ReportPage(survey_json, options));
}

}  // namespace wellgyro::python
