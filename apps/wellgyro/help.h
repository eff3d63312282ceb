#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace wellgyro::apps {

/// Help as wide as the terminal, at most 100 columns.
class HelpText : public CLI::Formatter {
 public:
  HelpText();
  std::string make_option(const CLI::Option* option, bool is_positional) const override;
  std::string make_subcommand(const CLI::App* command) const override;
  std::string make_description(const CLI::App* command) const override;
  std::string make_footer(const CLI::App* command) const override;

 private:
  std::string Entry(const std::string& name, const std::string& text) const;

  std::size_t width_;
};

/// "; is 'survey' meant?" of a word that is like one of `known`; else empty.
std::string Guess(const std::string& word, const std::vector<std::string>& known);

/// The command that was named last, or the program.
const CLI::App& NamedCommand(const CLI::App& app);

/// A sentence on a word that is no command where one is wanted, though help is asked for; or empty.
std::string StrayCommand(const CLI::App& app);

/// What is wrong with the command line: its first word that is no command or option, with the one
/// that seems to be meant; else what `error` says. One sentence.
std::string Complaint(const CLI::App& app, const CLI::ParseError& error);

}  // namespace wellgyro::apps
