#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace wellgyro::apps {

/// Help as wide as the terminal, at most 100 columns.
class HelpText : public CLI::Formatter {
 public:
  HelpText();
  std::string make_option(const CLI::Option* option, bool is_positional) const override;
  std::string make_subcommand(const CLI::App* command) const override;

 private:
  std::string Entry(const std::string& name, const std::string& text) const;

  std::size_t width_;
};

/// What is wrong with the command line: its first word that is no command or option, with the one
/// that seems to be meant; else what `error` says. One sentence.
std::string Complaint(const CLI::App& app, const CLI::ParseError& error);

}  // namespace wellgyro::apps
