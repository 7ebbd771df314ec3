// palpate-replay: runs the daemon over a recorded log, deterministically, or plays logs. See
// --help.

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "rt/config/command_line.hpp"
#include "tools/common/output_files.hpp"
#include "tools/common/program.hpp"
#include "tools/replay/play_command.hpp"
#include "tools/replay/replay.hpp"

namespace {

namespace replay = palpate::replay;

constexpr int kDiffers = 4;  // exit code

constexpr char kHelp[] =
    "palpate-replay LOG --config FILE runs the daemon over an LCM log in deterministic mode: the\n"
    "clock is that of the log, factors are installed after a fixed number of cycles, and two runs\n"
    "over one log give bit-identical shapes (compare the printed hash). Only what palpated "
    "listens\n"
    "to is taken from the log; what it said itself may lie in it as well.\n"
    "A log made in lock-step (palpate-sim --fast, palpated --stepped) is run with --stepped, a "
    "cycle\n"
    "for each SIM_TICK; --compare then holds each message against the one that was recorded.\n"
    "palpate-replay play LOG... sends logs over LCM again, with pause, rate and seek.";
constexpr char kExamples[] =
    "Examples:\n"
    "  palpate-replay run.control.lcmlog --config my.yaml --start\n"
    "  palpate-replay run.control.lcmlog --config my.yaml --stepped --compare "
    "--housekeeping run.housekeeping.lcmlog\n"
    "  palpate-replay play run.*.lcmlog --rate 0.5";

struct Options {
  replay::ReplayOptions replay;
  std::string configuration, json;
  std::vector<std::string> overrides;
};

nlohmann::json to_json(const replay::ReplayResult& result) {
  char hash[17];
  std::snprintf(hash, sizeof hash, "%016llx", static_cast<unsigned long long>(result.shape_hash));
  nlohmann::json json = {{"messages", result.messages}, {"left_out", result.left_out},
                         {"cycles", result.cycles},     {"duration_s", result.duration},
                         {"shapes", result.shapes},     {"shape_hash", hash}};
  for (const auto& [channel, one] : result.comparison) {
    json["comparison"][channel] = {{"recorded", one.recorded},
                                   {"replayed", one.replayed},
                                   {"common", one.common},
                                   {"equal", one.equal},
                                   {"first_difference_utime", one.first_difference}};
  }
  return json;
}

/// True if all messages that are in both are equal, and there are some.
bool print_comparison(const replay::ReplayResult& result) {
  long long common = 0, equal = 0;
  for (const auto& [channel, one] : result.comparison) {
    std::printf("%-24s %lld recorded, %lld replayed, %lld of one time, of these equal %lld",
                channel.c_str(), static_cast<long long>(one.recorded),
                static_cast<long long>(one.replayed), static_cast<long long>(one.common),
                static_cast<long long>(one.equal));
    if (one.first_difference >= 0)
      std::printf("; first difference at utime %lld", static_cast<long long>(one.first_difference));
    std::printf("\n");
    common += one.common;
    equal += one.equal;
  }
  std::printf("%s\n", common == 0       ? "nothing to compare: no message of the same time"
                      : equal == common ? "bit-identical"
                                        : "DIFFERENT");
  return common > 0 && equal == common;
}

int run(const Options& options) {
  const auto began = std::chrono::steady_clock::now();
  const auto root = palpate::config::Node::load_file(options.configuration, options.overrides);
  const replay::ReplayResult result = replay::replay(root, options.replay);
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - began;
  if (!result.complaint.empty()) std::fprintf(stderr, "warning: %s\n", result.complaint.c_str());
  std::printf("%lld messages, %lld cycles (%.1f s) in %.1f s; %lld shapes, hash %016llx\n",
              static_cast<long long>(result.messages), static_cast<long long>(result.cycles),
              result.duration, took.count(), static_cast<long long>(result.shapes),
              static_cast<unsigned long long>(result.shape_hash));
  const bool agrees = !options.replay.compare || print_comparison(result);
  if (!options.json.empty()) palpate::common::write_json(to_json(result), options.json);
  if (result.shapes == 0 && result.starts == 0 && !options.replay.start &&
      !options.replay.compare) {
    std::fprintf(stderr,
                 "error: %s: no shape was published, since the log holds no event start; with "
                 "--start the replay sends it\n",
                 options.replay.log.c_str());
    return palpate::config::kExitError;
  }
  return agrees ? 0 : kDiffers;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(kHelp);
  Options options;
  app.add_option("log", options.replay.log,
                 "log of the control URL, by palpate-record, lcm-logger or palpate-import");
  app.add_option("--config", options.configuration, "configuration of palpated");
  app.add_option("--set", options.overrides, "override a key: path.to.key=value (repeatable)")
      ->allow_extra_args(false);
  app.add_option("--output", options.replay.output, "log of all that the daemon publishes");
  app.add_flag("--start", options.replay.start,
               "send the event start first (a log of sensors has none)");
  app.add_flag("--stepped", options.replay.stepped, "a cycle for each SIM_TICK of the log");
  CLI::Option* compare = app.add_flag("--compare", options.replay.compare,
                                      "with what the daemon said when the log was made");
  app.add_option("--housekeeping", options.replay.housekeeping,
                 "log of the housekeeping URL: SHAPE is compared as well")
      ->needs(compare);
  app.add_option("--json", options.json, "write the summary to this file");
  app.footer(kExamples);
  replay::PlayCommand play;
  CLI::App* player = app.add_subcommand("play", "send logs over LCM again, as they were recorded");
  play.add_to(*player);
  if (const auto code = palpate::config::parse(
          app, argc, argv,
          {{{0, "done, or played to the end"},
            {1, "the log cannot be read or written, or no shape came of it"},
            {kDiffers, "the comparison differs"},
            {78, "wrong configuration"},
            {palpate::config::kExitInterrupted, "play: ended by q or a signal"}}}))
    return *code;
  if (!player->parsed() && (options.replay.log.empty() || options.configuration.empty()))
    return palpate::config::usage_error(app, "a log and --config are required");

  return palpate::common::run_program("error",
                                      [&] { return player->parsed() ? play.run() : run(options); });
}
