#include <CLI/CLI.hpp>
#include <algorithm>
#include <iostream>

#include "rt/config/command_line.hpp"
#include "rt/config/node.hpp"
#include "tools/collect/collection.hpp"
#include "tools/collect/compare.hpp"
#include "tools/collect/hand.hpp"
#include "tools/collect/localise.hpp"
#include "tools/common/interruption.hpp"
#include "tools/common/program.hpp"
#include "tools/common/progress.hpp"

namespace {

using namespace palpate;

struct EmulateOptions {
  std::string out = "biotac_emulated.csv";
  std::string sensors;
  std::vector<std::string> overrides;
  int seed = 1;
  double skin_variety = 0.2;
  bool extended = false;
  bool resume = false;
  int most = 1000000;
};

void run_emulate(const EmulateOptions& options) {
  const config::Node node = options.sensors.empty()
                                ? config::Node::from_text("{}", "sensors")
                                : config::Node::load_file(options.sensors, options.overrides);
  const collect::Bench bench(sensors::read_sensors(node), options.seed, {options.skin_variety});
  if (!options.sensors.empty()) node.check_all_used();
  std::vector<collect::Trial> trials = collect::make_trials(
      options.extended ? collect::Profiles::kExtended : collect::Profiles::kThesis);
  trials.resize(std::min(trials.size(), static_cast<std::size_t>(options.most)));
  const auto file = collect::open_collection(options.out, options.resume);
  common::Progress progress(1, 1, "collecting " + std::to_string(trials.size()) + " trials");
  const double count = static_cast<double>(trials.size());
  for (std::size_t i = file->trials(); i < trials.size(); ++i) {
    progress.show(static_cast<double>(i) / count, collect::name_of(trials[i]));
    file->add(trials[i], bench.run(trials[i]));
  }
  progress.finish(true, options.out);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Collects recordings to train tactile models on, and scores what emulates them.");
  app.footer(
      "Example:\n"
      "  palpate-collect emulate --seed 7 --most 100 -o presses.csv");
  app.require_subcommand(1);

  CLI::App* compare = app.add_subcommand(
      "compare",
      "Emulated BioTac against the real one that pressed foam, pressed by the same force");
  std::string data;
  compare->add_option("--data", data, "Folder of the recordings")
      ->required()
      ->check(CLI::ExistingDirectory);
  bool skin_as_is = false;
  compare->add_flag("--skin-as-is", skin_as_is,
                    "Find place and pressure area only; the skin is that of sensors.yaml");
  double part = 0.5;
  compare->add_option("--split", part, "Part of the recording that is calibrated on")
      ->check(CLI::Range(0.2, 0.8))
      ->capture_default_str();
  int evaluations = 12000;
  compare->add_option("--evaluations", evaluations, "Of the emulation, in the calibration")
      ->check(CLI::Range(100, 1000000))
      ->capture_default_str();

  CLI::App* emulate = app.add_subcommand(
      "emulate", "The probe protocol on emulated fingers: 945 trials, or 1890 with --extended");
  EmulateOptions emulation;
  emulate->add_option("-o,--output", emulation.out, "CSV, or an LCM log where it ends in .log")
      ->capture_default_str();
  emulate->add_option("--seed", emulation.seed)
      ->check(CLI::Range(0, 1 << 30))
      ->capture_default_str();
  emulate
      ->add_option("--sensors", emulation.sensors,
                   "YAML with what differs from sensors.yaml, as a scene's key `sensors`")
      ->check(CLI::ExistingFile);
  emulate->add_option("--set", emulation.overrides, "path.to.key=value over --sensors")
      ->needs("--sensors");
  emulate
      ->add_option("--variety", emulation.skin_variety,
                   "How unlike the fingers' skins are: deviation of the logarithm of their sizes")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  emulate->add_flag("--extended", emulation.extended, "Forces of up to 2 N with shear too");
  emulate->add_option("--most", emulation.most, "Stop after so many trials")
      ->check(CLI::Range(1, 1000000));
  emulate->add_flag("--resume", emulation.resume, "Continue after the last trial in the CSV");

  CLI::App* localise = app.add_subcommand(
      "localise", "Errors of the classical localisation on a CSV collection, where |F| > 0.5 N");
  std::string collection;
  localise->add_option("file", collection, "CSV of palpate-collect")
      ->required()
      ->check(CLI::ExistingFile);
  sensing::LocalizationOptions localization;
  localise->add_option("--polarity", localization.polarity, "1: counts rise under pressure; -1")
      ->check(CLI::IsMember({-1.0, 1.0}))
      ->capture_default_str();
  localise->add_option("--threshold", localization.threshold, "Counts that make active")
      ->check(CLI::Range(0.0, 4095.0))
      ->capture_default_str();
  localise->add_option("--saturation", localization.saturation, "Counts that make full intensity")
      ->check(CLI::Range(1.0, 4095.0))
      ->capture_default_str();

  CLI::App* hand = app.add_subcommand(
      "hand",
      "Presses of a hand over LCM, a real one or palpate-sim's: HAND_COMMAND, log of what comes");
  collect::HandProtocol protocol;
  std::string url = "udpm://239.255.76.67:7667?ttl=0", log = "presses.log", name = "presses";
  config::add_url_option(*hand, {{"control", &url}});
  hand->add_option("-o,--output", log, "LCM log to write")->capture_default_str();
  hand->add_option("--name", name, "Of probe and area, for the log")->capture_default_str();
  hand->add_option("--finger", protocol.finger)->check(CLI::Range(0, 4))->capture_default_str();
  hand->add_option("--trials", protocol.trials)->check(CLI::Range(1, 10000))->capture_default_str();
  std::string key_file;
  hand->add_option("--key", key_file, "File of the key that the hand's side has");
  hand->add_option("--force", protocol.force, "N, that a finger holds")
      ->check(CLI::Range(0.05, 20.0))
      ->capture_default_str();
  hand->add_option("--hold", protocol.hold, "s")
      ->check(CLI::Range(0.1, 600.0))
      ->capture_default_str();
  hand->add_option("--release", protocol.release, "s")
      ->check(CLI::Range(0.1, 600.0))
      ->capture_default_str();
  if (const auto code =
          config::parse(app, argc, argv,
                        {{{78, "wrong configuration"}, {config::kExitInterrupted, "interrupted"}},
                         {{"--out", "--output"}}}))
    return *code;
  return common::run_program("palpate-collect", [&] {
    if (*compare) collect::run_compare(data, !skin_as_is, part, evaluations, std::cout);
    if (*emulate) run_emulate(emulation);
    if (*hand) {
      common::catch_interruptions();
      std::optional<bus::Key> key;
      if (!key_file.empty()) key = bus::read_key_file(key_file);
      const auto bus = bus::make_lcm_bus(url);
      const collect::HandCount count = collect::collect_from_hand(*bus, protocol, name, log, key);
      std::cout << count.touches << " tactile samples, " << count.wrenches << " wrenches\n";
    }
    if (*localise) collect::run_localise(collection, localization, std::cout);
    return 0;
  });
}
