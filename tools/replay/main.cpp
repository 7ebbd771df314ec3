// palpate-replay: runs the daemon over a recorded log, deterministically. See --help.

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tools/replay/replay.hpp"

int main(int argc, char** argv) {
  CLI::App app(
      "palpate-replay runs the daemon over an LCM log in deterministic mode: the clock is that of "
      "the\n"
      "log, factors are installed after a fixed number of cycles, and two runs over one log give\n"
      "bit-identical shapes (compare the printed hash).\n"
      "Exit codes: 0 done, 1 the log cannot be read or written, 78 wrong configuration.");
  palpate::replay::ReplayOptions options;
  std::string configuration;
  std::vector<std::string> overrides;
  std::string json;
  app.add_option("log", options.log, "log of the control URL, by lcm-logger or palpate-import")
      ->required();
  app.add_option("--config", configuration, "configuration of palpated")->required();
  app.add_option("--set", overrides, "override a key: path.to.key=value (repeatable)")
      ->allow_extra_args(false);
  app.add_option("--output", options.output, "log of all that the daemon publishes");
  app.add_flag("--start", options.start, "send the event start first (a log of sensors has none)");
  app.add_option("--json", json, "write the summary to this file");
  app.set_version_flag("--version", PALPATE_VERSION);
  app.footer(
      "Example:\n"
      "  palpate-replay run.log --config bar.yaml --start --output out.log");
  CLI11_PARSE(app, argc, argv);

  try {
    const auto began = std::chrono::steady_clock::now();
    const auto root = palpate::config::Node::load_file(configuration, overrides);
    const palpate::replay::ReplayResult result = palpate::replay::replay(root, options);
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - began;
    if (!result.complaint.empty()) std::fprintf(stderr, "warning: %s\n", result.complaint.c_str());
    std::printf("%lld messages, %lld cycles (%.1f s) in %.1f s; %lld shapes, hash %016llx\n",
                static_cast<long long>(result.messages), static_cast<long long>(result.cycles),
                result.duration, took.count(), static_cast<long long>(result.shapes),
                static_cast<unsigned long long>(result.shape_hash));
    if (!json.empty()) {
      char hash[17];
      std::snprintf(hash, sizeof hash, "%016llx",
                    static_cast<unsigned long long>(result.shape_hash));
      std::ofstream file(json);
      file << nlohmann::json{{"messages", result.messages},
                             {"cycles", result.cycles},
                             {"duration_s", result.duration},
                             {"shapes", result.shapes},
                             {"shape_hash", hash}}
                  .dump(2)
           << '\n';
      if (!file) throw std::runtime_error(json + ": cannot be written");
    }
    return 0;
  } catch (const palpate::config::Error& error) {
    std::fprintf(stderr, "error: %s\n", error.what());
    return palpate::config::kExitCode;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "error: %s\n", error.what());
    return 1;
  }
}
