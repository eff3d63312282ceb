#include "help.h"

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <cstring>
#include <regex>
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

bool AnyCommand(const CLI::App* /*command*/) { return true; }

std::vector<std::string> KnownTo(const CLI::App& app) {
  std::vector<std::string> known;
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) known.push_back("--" + name);
  }
  for (const CLI::App* command : app.get_subcommands(AnyCommand)) {
    known.push_back(command->get_name());
  }
  return known;
}

/// `line` with the words of `text` behind it, broken before they pass `width`; each further line
/// begins `indent` columns in.
std::string Filled(std::string line, const std::string& text, std::size_t indent,
                   std::size_t width) {
  std::istringstream words(text);
  std::string out, word;
  bool first = true;
  while (words >> word) {
    if (!first && line.size() + 1 + word.size() > width) {
      out += line + '\n';
      line = std::string(indent, ' ');
      first = true;
    }
    line += (first ? "" : " ") + word;
    first = false;
  }
  line.erase(line.find_last_not_of(' ') + 1);
  return out + line + '\n';
}

/// The range of a number as people write it: CLI11 says "FLOAT:FLOAT in [-90 - 90]".
std::string InWords(const std::string& options) {
  static const std::regex range(R"((FLOAT|INT|UINT):\1 in \[(\S+) - (\S+)\])");
  static const std::regex positive(":POSITIVE"), not_negative(":NONNEGATIVE");
  const std::string ranged = std::regex_replace(options, range, "$1 from $2 to $3");
  return std::regex_replace(std::regex_replace(ranged, positive, " above 0"), not_negative,
                            " from 0");
}

/// What is wrong with the words that `command` did not take, nor left to one of its own commands;
/// empty where there is none.
std::string ComplaintOf(const CLI::App& command) {
  const bool chooses = !command.get_subcommands(AnyCommand).empty();
  std::string stray;
  for (const std::string& word : command.remaining()) {
    const std::string name = word.substr(0, word.find('='));
    const bool option = name.starts_with("--");
    if (!option && !chooses) {
      stray = word;
      continue;
    }
    std::string kind = "command";
    if (option) kind = "option of " + command.get_name();
    if (!option && command.get_parent()) kind = "method of " + command.get_name();
    return fmt::format("'{}' is no {}{}", name, kind, Guess(name, KnownTo(command)));
  }
  if (stray.empty()) return {};
  return fmt::format(
      "'{}' belongs to no option of {}; one that may be given several times stands before each "
      "value",
      stray, command.get_name());
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
  return out + Filled(line, text, kColumn, width_);
}

std::string HelpText::make_description(const CLI::App* command) const {
  return Filled("", command->get_description(), 0, width_);
}

std::string HelpText::make_footer(const CLI::App* command) const {
  std::istringstream lines(command->get_footer());
  std::string out, paragraph, line;
  const auto end_paragraph = [&] {
    if (!paragraph.empty()) out += Filled("", paragraph, 0, width_);
    paragraph.clear();
  };
  while (std::getline(lines, line)) {
    // What is indented, a command or part of a file, is to be copied as it stands.
    if (!line.empty() && line.front() != ' ') {
      paragraph += line + ' ';
      continue;
    }
    end_paragraph();
    out += line + '\n';
  }
  end_paragraph();
  return out;
}

std::string HelpText::make_option(const CLI::Option* option, bool is_positional) const {
  return Entry(make_option_name(option, is_positional) + InWords(make_option_opts(option)),
               make_option_desc(option));
}

std::string HelpText::make_subcommand(const CLI::App* command) const {
  return Entry(command->get_name(), command->get_description());
}

std::string Guess(const std::string& word, const std::vector<std::string>& known) {
  const std::string meant = Nearest(word, known);
  return meant.empty() ? "" : fmt::format("; is '{}' meant?", meant);
}

const CLI::App& NamedCommand(const CLI::App& app) {
  const auto commands = app.get_subcommands();
  return commands.empty() ? app : NamedCommand(*commands.front());
}

std::string StrayCommand(const CLI::App& app) {
  const CLI::App& named = NamedCommand(app);
  const bool chooses = !named.get_subcommands(AnyCommand).empty();
  return chooses ? ComplaintOf(named) : std::string();
}

std::string Complaint(const CLI::App& app, const CLI::ParseError& error) {
  std::string said = ComplaintOf(app);
  if (!said.empty()) return said;
  const auto commands = app.get_subcommands();
  return commands.empty() ? error.what() : Complaint(*commands.front(), error);
}

}  // namespace wellgyro::apps
