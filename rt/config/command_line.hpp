#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace CLI {
class App;
}  // namespace CLI

namespace palpate::config {

// Exit codes with one meaning in every program; those from 64 on are of sysexits.h. A wrong
// configuration ends with kExitCode (78, rt/config/node.hpp). docs/exit_codes.md has the table.
inline constexpr int kExitDone = 0;
inline constexpr int kExitError = 1;         // an error, or a criterion that is not met
inline constexpr int kExitHung = 5;          // a plug-in did not return from a call in the loop
inline constexpr int kExitUsage = 64;        // EX_USAGE: wrong command line
inline constexpr int kExitData = 65;         // EX_DATAERR: the input is read, and is unusable
inline constexpr int kExitUnavailable = 69;  // EX_UNAVAILABLE: nothing answers or is heard
inline constexpr int kExitSoftware = 70;  // EX_SOFTWARE: error, where 1 is an examination's result
inline constexpr int kExitInterrupted = 130;  // 128 + SIGINT

/// An exit code as --help lists it.
struct ExitCode {
  int code = 0;
  std::string meaning;
};

/// An option that has another spelling now. The old one works, is not in --help, and prints a line
/// of warning.
struct RenamedOption {
  std::string old_name;  // with its dashes, "--out"
  std::string name;      // "--output"
  std::string prefix{};  // of the value: "housekeeping=" makes "--url housekeeping=VALUE"
};

/// What a program's command line has besides its options.
struct CommandLine {
  /// Added to 0 "done", 1 "an error" and 64 "wrong command line", or in their place.
  std::vector<ExitCode> exit_codes{};
  std::vector<RenamedOption> renamed{};
};

/// Adds --version and parses the arguments. Empty if the program continues; otherwise its exit
/// code, with CLI11's message printed: 0 after --help or --version, kExitUsage after a wrong
/// command line. The table of exit codes becomes the end of --help, of every subcommand too. What
/// callbacks throw besides CLI::ParseError passes through.
std::optional<int> parse(CLI::App& app, int argc, const char* const* argv,
                         const CommandLine& line = {});

/// Prints the message, with a hint to --help, to standard error. Returns kExitUsage.
int usage_error(const CLI::App& app, const std::string& message);

/// A deprecated positional argument with the meaning of `option`, e.g. "--config", which writes to
/// the same `value`. It is not in --help, prints a line of warning, and excludes `option`.
void add_deprecated_positional(CLI::App& app, const std::string& name, std::string& value,
                               const std::string& option);

/// "[LABEL=]URL" in two; without a label the label is "control".
struct LabelledUrl {
  std::string label;
  std::string url;
};
LabelledUrl labelled_url(const std::string& text);

/// --url [LABEL=]URL, repeatable, for the labels in `urls`; the present values are the defaults
/// that
/// --help names. A URL without a label is that of `control`.
void add_url_option(CLI::App& app, const std::vector<std::pair<std::string, std::string*>>& urls);

}  // namespace palpate::config
