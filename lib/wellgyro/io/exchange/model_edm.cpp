// Error models in EDM exports: survey tools and the terms that name them.
#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "wellgyro/io/exchange/compass_rows_internal.h"
#include "wellgyro/io/exchange/line_reader_internal.h"
#include "wellgyro/io/exchange/model_files.h"
#include "wellgyro/io/exchange/model_terms_internal.h"
#include "wellgyro/io/exchange/xml_internal.h"
#include "wellgyro/io/text_internal.h"

namespace wellgyro {
namespace {

void Walk(pugi::xml_node node, std::vector<pugi::xml_node>& tools,
          std::vector<pugi::xml_node>& terms) {
  for (const pugi::xml_node child : node.children()) {
    const std::string_view name = child.name();
    if (name == "CD_SURVEY_TOOL") tools.push_back(child);
    if (name == "DP_TOOL_TERM") terms.push_back(child);
    Walk(child, tools, terms);
  }
}

ErrorModel ReadEdm(std::string_view text, const std::string& source, std::string_view wanted) {
  const XmlFile file(std::string(text), source);
  std::vector<pugi::xml_node> tools, terms;
  Walk(file.root(), tools, terms);
  const auto id_of = [](pugi::xml_node tool) {
    return std::string(tool.attribute("survey_tool_id").value());
  };
  const auto name_of = [](pugi::xml_node tool) {
    const std::string name = tool.attribute("tool_name").value();
    return name.empty() ? std::string(tool.attribute("name").value()) : name;
  };
  const auto fits = [&](pugi::xml_node tool) {
    return wanted.empty() || id_of(tool) == wanted || Lower(name_of(tool)) == Lower(wanted);
  };
  const auto count = std::ranges::count_if(tools, fits);
  if (count != 1) {
    RefuseModel(source, "has " + std::to_string(count) + " survey tools" +
                            (wanted.empty() ? ": name the one that is wanted as FILE#TOOL"
                                            : " called " + std::string(wanted)));
  }
  const pugi::xml_node tool = *std::ranges::find_if(tools, fits);
  ErrorModel model;
  model.name = name_of(tool);
  model.description = tool.attribute("description").value();
  model.source = "EDM export, survey tool " + id_of(tool);
  std::vector<CompassRow> rows;
  for (const pugi::xml_node term : terms) {
    if (id_of(term) != id_of(tool)) continue;
    const auto at = [&](const char* key) { return std::string(term.attribute(key).value()); };
    const auto number = [&](const char* key) {
      const std::string cell = at(key);
      return cell.empty() ? 0.0 : NumberOrRefuse(cell, key, source, 0);
    };
    CompassRow row{Lower(at("term_name")), Lower(at("vector_type")), Lower(at("tie_type")),
                   Lower(at("c_units")), at("c_formula")};
    row.value = number("c_value");
    row.min_deg = number("min_range");
    row.max_deg = number("max_range");
    row.order = number("sequence_no");
    rows.push_back(std::move(row));
  }
  TermsOfRows(std::move(rows), source, model);
  FinishModel(model, source);
  return model;
}

}  // namespace

Result<ErrorModel> ParseModelEdm(std::string_view text, const std::string& source,
                                 std::string_view tool) {
  try {
    return ReadEdm(text, source, tool);
  } catch (const ModelError& error) {
    return error.fault;
  } catch (const TextError& error) {
    return error.fault;
  }
}

}  // namespace wellgyro
