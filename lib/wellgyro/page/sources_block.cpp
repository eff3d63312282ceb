// Block 9: what the survey rests on, and where it went.
#include <initializer_list>
#include <string>
#include <string_view>

#include <fmt/core.h>

#include "wellgyro/page/html_internal.h"
#include "wellgyro/page/page_internal.h"

namespace wellgyro {
namespace {

void WriteList(PageText& page, const Json& list, const char* caption, const char* none,
               std::initializer_list<std::string_view> heads,
               std::initializer_list<std::string_view> keys) {
  if (!list.is_array() || list.empty()) {
    page.html += fmt::format("<p class=\"absent\">{}: {}.</p>\n", Escaped(caption), none);
    return;
  }
  HtmlTable table(page.html, "sources", caption, heads);
  for (const Json& entry : list) {
    table.Row();
    for (const std::string_view key : keys) table.Text(TextAt(entry, {key}));
  }
}

void WriteLosses(PageText& page) {
  page.html += "<h3>What exported files could not hold</h3>\n";
  const Json& files = At(page.survey, {"losses"});
  if (!files.is_array() || files.empty()) {
    page.html += "<p>No other format was written.</p>\n";
    return;
  }
  for (const Json& file : files) {
    page.html += "<p>" + Isolated(TextAt(file, {"file"})) + ": ";
    const Json& losses = At(file, {"losses"});
    if (!losses.is_array() || losses.empty()) {
      page.html += "everything is kept.</p>\n";
      continue;
    }
    page.html += "</p><ul>";
    for (const Json& loss : losses) {
      page.html += "<li>" + Isolated(loss.is_string() ? loss.get<std::string>() : "") + "</li>";
    }
    page.html += "</ul>\n";
  }
}

void WriteSource(PageText& page) {
  const Json& source = At(page.survey, {"source"});
  if (!source.is_object()) return SayNotMeasured(page, "Source");
  page.html += "<p>Source: " + Isolated(TextAt(source, {"name"}));
  const Json& counts = At(source, {"counts"});
  if (counts.is_object()) {
    for (const auto& [name, count] : counts.items()) {
      page.html += fmt::format(", {} {}", Escaped(name), Escaped(count.dump()));
    }
  }
  page.html += "</p>\n";
}

}  // namespace

void WriteSources(PageText& page) {
  BeginBlock(page, 9, "Inputs and files");
  const Json& run = At(page.survey, {"run"});
  page.html += "<p>Made by " + Isolated(TextAt(run, {"program"})) + ", adjusted by " +
               Isolated(TextAt(run, {"adjuster"})) + ".</p>\n";
  WriteSource(page);
  WriteList(page, At(run, {"input"}), "Inputs", "none on record", {"Role", "Name", "SHA-256"},
            {"role", "name", "sha256"});
  WriteList(page, At(run, {"channel"}), "Channels", "none: the survey is not from messages",
            {"Channel", "Type", "Messages", "SHA-256"}, {"name", "type", "messages", "sha256"});
  WriteList(page, At(run, {"output"}), "Files written", "none on record", {"Name", "SHA-256"},
            {"name", "sha256"});
  WriteList(page, At(run, {"operation"}), "Operations", "none on record",
            {"Time", "Key", "Kind", "Obeyed", "Effect"},
            {"time", "key", "kind", "obeyed", "effect"});
  WriteList(page, At(run, {"fault"}), "Faults", "none", {"Code", "Source", "Text"},
            {"code", "source", "text"});
  WriteLosses(page);
  EndBlock(page);
}

}  // namespace wellgyro
