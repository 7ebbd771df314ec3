// palpate-doctor: finds settings of this machine that would impair palpated, and how to fix them.
// See --help.

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <iostream>
#include <nlohmann/json.hpp>

#include "rt/config/command_line.hpp"
#include "rt/config/node.hpp"
#include "tools/common/output_files.hpp"
#include "tools/common/program.hpp"
#include "tools/doctor/checks.hpp"
#include "tools/doctor/finding.hpp"

namespace {

namespace doctor = palpate::doctor;

struct Options {
  std::string configuration, json, root = "/";
  std::vector<std::string> overrides;
  double seconds = 1.5;
  bool no_live = false, strict = false, only_bad = false, plain = false, channels = false;
};

constexpr char kHelp[] =
    "palpate-doctor looks for what on this machine would hurt palpated: kernel, priorities, "
    "locked\n"
    "memory, frequency, idle states, isolation, clock, instructions; socket buffer, multicast\n"
    "route, ttl, who listens and loses, other daemons; LCM, Java, disk; and with --config whether\n"
    "palpated would take that, with every mesh and model that it names. Of each it says ok, warn\n"
    "or fail, why it matters, and the command that fixes it. It changes nothing.";
constexpr char kExamples[] =
    "Examples:\n"
    "  palpate-doctor\n"
    "  palpate-doctor --config rt/config/examples/bar_long_soft.yaml --only-bad\n"
    "  palpate-doctor --config my.yaml --strict --json -\n"
    "  palpate-doctor --config my.yaml --channels";

/// Relative to this program, both in the build tree and installed; from the root.
std::string spy_jar() {
  std::error_code error;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", error);
  const std::filesystem::path jar =
      program.parent_path().parent_path() / "share/palpate/palpate-spy.jar";
  return jar.lexically_relative("/").string();
}

doctor::Findings examine(const Options& options) {
  const doctor::Machine machine(options.root);
  doctor::Findings findings;
  const auto add = [&findings](const doctor::Findings& more) {
    findings.insert(findings.end(), more.begin(), more.end());
  };
  doctor::Needs needs;
  if (!options.configuration.empty()) {
    add(doctor::check_configuration(options.configuration, options.overrides));
    try {
      needs = doctor::needs_of(
          palpate::config::Node::load_file(options.configuration, options.overrides));
    } catch (const std::exception&) {
      // Reported already; the other checks use palpated's default needs.
    }
  }
  add(doctor::check_real_time(machine, needs));
  add(doctor::check_network(machine, needs));
  const bool is_here = options.root == "/";
  if (is_here && !options.no_live) add(doctor::check_live(needs, options.seconds));
  add(doctor::check_programs(machine, spy_jar()));
  if (is_here) add(doctor::check_disk(needs, palpate::record::free_space_of_system));
  return findings;
}

int run(const Options& options) {
  const doctor::Findings findings = examine(options);
  if (options.json != "-") {
    const bool colours =
        !options.plain && isatty(STDOUT_FILENO) != 0 && std::getenv("NO_COLOR") == nullptr;
    doctor::print(findings, colours, options.only_bad, std::cout);
  }
  if (!options.json.empty()) palpate::common::write_json(doctor::to_json(findings), options.json);
  const doctor::Verdict worst = doctor::worst(findings);
  const bool is_bad =
      worst == doctor::Verdict::kFail || (options.strict && worst == doctor::Verdict::kWarn);
  return is_bad ? 1 : 0;
}

int list_channels(const Options& options) {
  const auto channels = doctor::channels_of(options.configuration, options.overrides);
  if (options.json != "-") doctor::print(channels, std::cout);
  if (!options.json.empty()) palpate::common::write_json(doctor::to_json(channels), options.json);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(kHelp);
  Options options;
  app.add_option("--config", options.configuration, "configuration of palpated, YAML");
  palpate::config::add_deprecated_positional(app, "configuration", options.configuration,
                                             "--config");
  app.add_option("--set", options.overrides, "override a key: path.to.key=value (repeatable)")
      ->allow_extra_args(false);
  app.add_option("--json", options.json, "write JSON to this file, or - for standard output alone")
      ->expected(0, 1)
      ->default_str("-");
  app.add_flag("--strict", options.strict, "warnings count as failures");
  app.add_flag("--only-bad", options.only_bad, "leave out what is well");
  app.add_flag("--no-live", options.no_live, "neither send nor listen to messages");
  app.add_option("--seconds", options.seconds, "to listen for daemons")
      ->check(CLI::Range(0.1, 600.0))
      ->capture_default_str();
  app.add_option("--root", options.root,
                 "examine the files of another machine below this folder; nothing live, no disk")
      ->check(CLI::ExistingDirectory)
      ->capture_default_str();
  app.add_flag("--channels", options.channels,
               "instead of all that: which channels palpated would hear and speak on with the "
               "configuration, of which type, on which URL, how often; requires --config");
  app.add_flag("--plain", options.plain, "no colours");
  app.footer(kExamples);
  if (const auto code = palpate::config::parse(app, argc, argv,
                                               {{{0, "no check fails"},
                                                 {1, "a check fails (with --strict: or warns)"},
                                                 {palpate::config::kExitSoftware, "an error"},
                                                 {78, "wrong configuration with --channels"}}}))
    return *code;
  if (options.channels && options.configuration.empty())
    return palpate::config::usage_error(app, "--channels requires --config");
  if (app.count("--json") > 0 && options.json.empty()) options.json = "-";
  return palpate::common::run_program(
      "error",
      [&]() -> int {
        const std::string extension = std::filesystem::path(options.json).extension().string();
        if (extension == ".yaml" || extension == ".yml")
          return palpate::config::usage_error(
              app, "--json " + options.json + ": would overwrite a configuration");
        return options.channels ? list_channels(options) : run(options);
      },
      palpate::config::kExitSoftware);
}
