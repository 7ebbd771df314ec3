#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "tools/replay/player.hpp"

namespace palpate::replay {

/// The command line of `palpate-replay play`.
struct PlayCommand {
  std::vector<std::string> logs;  // FILE or LABEL=FILE
  std::vector<std::string> urls;  // [LABEL=]URL
  PlayerOptions player;
  std::string channels = ".*";
  bool invert = false;
  bool inputs_only = false;  // the inputs of palpated
  bool commands = false;     // also what is_command()
  bool quiet = false;

  void add_to(CLI::App& app);
  /// Plays until the end, a signal, or the key q. Returns the exit code; throws std::runtime_error
  /// and std::invalid_argument.
  int run() const;
};

/// Whether a channel's messages move a robot or a hand, or command a running palpated, which then
/// moves them.
bool is_command(const std::string& channel);
/// Whether palpated receives it on its control URL.
bool is_input(const std::string& channel);
/// From "LABEL=FILE", or from a name given by palpate-record (run.housekeeping.lcmlog); control if
/// neither names it.
std::string label_of(const std::string& log, std::string& file);

}  // namespace palpate::replay
