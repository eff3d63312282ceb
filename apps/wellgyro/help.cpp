#include "help.h"

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <cstring>
#include <sstream>
#include <vector>

#include <fmt/core.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "wellgyro/base/alike.h"

namespace wellgyro::apps {
namespace {

constexpr std::size_t kColumn = 32;

/// Of the terminal; where there is none, what COLUMNS says, as other programs take it.
std::size_t TerminalWidth() {
  winsize size{};
  std::size_t columns = 100;
  if (::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0) {
    columns = size.ws_col;
  } else if (const char* told = std::getenv("COLUMNS")) {
    std::from_chars(told, told + std::strlen(told), columns);
  }
  return std::clamp<std::size_t>(columns, 60, 100);
}

/// The command that was named, or the program.
const CLI::App& Named(const CLI::App& app) {
  const auto commands = app.get_subcommands();
  return commands.empty() ? app : Named(*commands.front());
}

std::vector<std::string> KnownTo(const CLI::App& app) {
  std::vector<std::string> known;
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) known.push_back("--" + name);
  }
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    known.push_back(command->get_name());
  }
  return known;
}

}  // namespace

HelpText::HelpText() : width_(TerminalWidth()) { column_width(kColumn); }

std::string HelpText::Entry(const std::string& name, const std::string& text) const {
  std::string out = "  " + name, line;
  if (out.size() + 1 < kColumn) {
    line = out + std::string(kColumn - out.size(), ' ');
    out.clear();
  } else {
    line = std::string(kColumn, ' ');
    out += '\n';
  }
  std::istringstream words(text);
  std::string word;
  bool first = true;
  while (words >> word) {
    if (!first && line.size() + 1 + word.size() > width_) {
      out += line + '\n';
      line = std::string(kColumn, ' ');
      first = true;
    }
    line += (first ? "" : " ") + word;
    first = false;
  }
  line.erase(line.find_last_not_of(' ') + 1);
  return out + line + '\n';
}

std::string HelpText::make_option(const CLI::Option* option, bool is_positional) const {
  return Entry(make_option_name(option, is_positional) + make_option_opts(option),
               make_option_desc(option));
}

std::string HelpText::make_subcommand(const CLI::App* command) const {
  return Entry(command->get_name(), command->get_description());
}

std::string Complaint(const CLI::App& app, const CLI::ParseError& error) {
  const CLI::App& named = Named(app);
  std::string stray;
  for (const std::string& word : app.remaining(true)) {
    const std::string name = word.substr(0, word.find('='));
    const bool option = name.starts_with("--");
    if (!option && &named != &app) {
      stray = word;
      continue;
    }
    const std::string meant = Nearest(name, KnownTo(named));
    return fmt::format("'{}' is no {}{}", name,
                       option ? "option of " + named.get_name() : std::string("command"),
                       meant.empty() ? "" : fmt::format("; is '{}' meant?", meant));
  }
  if (stray.empty()) return error.what();
  return fmt::format(
      "'{}' belongs to no option of {}; one that may be given several times stands before each "
      "value",
      stray, named.get_name());
}

}  // namespace wellgyro::apps
