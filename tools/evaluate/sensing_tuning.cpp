#include "tools/evaluate/sensing_tuning.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <list>
#include <nlohmann/json.hpp>

#include "core/math/random.hpp"
#include "rt/config/node.hpp"
#include "tools/evaluate/csv.hpp"
#include "tools/evaluate/experiments.hpp"
#include "tools/evaluate/interruption.hpp"
#include "tools/evaluate/live_run.hpp"
#include "tools/evaluate/sensing_recording.hpp"
#include "tools/evaluate/table.hpp"

namespace palpate::evaluate {

namespace fs = std::filesystem;

struct TuneSensingCommand::Options {
  fs::path plan, output = "out/tune-sensing";
  std::vector<std::string> only;
  int trials = 50;
  int jobs = 2;
};

TuneSensingCommand::TuneSensingCommand(CLI::App& app)
    : options_(std::make_unique<Options>()),
      command_(app.add_subcommand(
          "tune-sensing",
          "random search over the numbers of every published sensing method, as many trials for "
          "each, on a motion that no study runs; writes trials.csv and best.yaml.\nExample: "
          "palpate-evaluate tune-sensing --only \"[33]\" --trials 10 --jobs 3")) {
  Options& o = *options_;
  command_->add_option("--plan", o.plan, "(default: tools/evaluate/published_sensing_tuning.yaml)")
      ->check(CLI::ExistingFile);
  command_->add_option("--out", o.output, "folder of recording and results")->capture_default_str();
  command_->add_option("--only", o.only, "methods whose name holds this text (repeatable)")
      ->allow_extra_args(false);
  command_->add_option("--trials", o.trials, "of each method, the first with its own numbers")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  command_->add_option("--jobs", o.jobs, "replays side by side")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
}

TuneSensingCommand::~TuneSensingCommand() = default;

namespace {

struct Parameter {
  std::string path;
  double lower = 0, upper = 0;
  bool whole = false;  // numbers; else spread evenly in their logarithm
};

struct Tuned {
  Method method;
  std::vector<Parameter> parameters;
};

struct Trial {
  std::size_t method = 0;
  int number = 0;
  std::vector<std::string> settings;
  double error = 0;  // m; the cap where it failed
  std::string failure;
  std::unique_ptr<Process> process;
  fs::path output;
};

Parameter read_parameter(const config::Node& node) {
  Parameter parameter;
  parameter.path = node.text("path");
  const std::vector<double> range = node.numbers("range", 2);
  parameter.lower = range[0];
  parameter.upper = range[1];
  parameter.whole = node.flag("whole", false);
  if (!(parameter.lower > 0) || !(parameter.upper > parameter.lower))
    node.fail("range", "wants two numbers above zero, the second the larger one");
  return parameter;
}

std::vector<Tuned> read_tuned(const config::Node& plan, const fs::path& root) {
  const std::vector<Method> known = read_methods(root / plan.text("method_file"));
  std::vector<Tuned> all;
  for (const config::Node& node : plan.list("methods")) {
    Tuned tuned;
    const std::string name = node.text("method");
    const auto found = std::find_if(known.begin(), known.end(),
                                    [&name](const Method& method) { return method.name == name; });
    if (found == known.end()) node.fail("method", "\"" + name + "\" is not in the method file");
    tuned.method = *found;
    for (const config::Node& parameter : node.list("parameters"))
      tuned.parameters.push_back(read_parameter(parameter));
    if (tuned.parameters.empty()) node.fail("parameters", "is empty");
    all.push_back(std::move(tuned));
  }
  if (all.empty()) plan.fail("methods", "is empty");
  return all;
}

std::string draw(const Parameter& parameter, math::Random& random) {
  double value = std::exp(random.uniform(std::log(parameter.lower), std::log(parameter.upper)));
  if (parameter.whole) value = std::round(value);
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return parameter.path + "=" + text;
}

std::vector<Trial> make_trials(const std::vector<Tuned>& methods, int count, int seed) {
  std::vector<Trial> trials;
  for (std::size_t m = 0; m < methods.size(); ++m) {
    math::Random random(static_cast<std::uint64_t>(seed), methods[m].method.name);
    for (int i = 0; i < count; ++i) {
      Trial trial;
      trial.method = m;
      trial.number = i;
      for (const Parameter& parameter : methods[m].parameters)
        if (i > 0) trial.settings.push_back(draw(parameter, random));
      trials.push_back(std::move(trial));
    }
  }
  return trials;
}

/// What a trial came to; a failed one counts as the cap, and none counts for more.
void end_trial(Trial& trial, const SensingRecording& recording, double cap) {
  trial.error = cap;
  const int code = *trial.process->wait(0);
  trial.process.reset();
  try {
    if (code != 0) throw RunFailed("exit code " + std::to_string(code));
    trial.error = std::min(cap, replay_error(trial.output, recording));
  } catch (const Interrupted&) {
    throw;
  } catch (const std::exception& error) {
    trial.failure = error.what();
  }
  fs::remove(trial.output);
}

void run_trials(std::vector<Trial>& trials, const std::vector<Tuned>& methods,
                const SensingScene& scene, const SensingRecording& recording, double cap, int jobs,
                const fs::path& folder) {
  constexpr double kPoll = 0.02;  // s
  Progress progress(1, 1, std::to_string(trials.size()) + " trials");
  std::list<Trial*> running;
  std::size_t next = 0, done = 0;
  while (done < trials.size()) {
    while (next < trials.size() && static_cast<int>(running.size()) < jobs) {
      Trial& trial = trials[next++];
      trial.output = folder / ("trial_" + std::to_string(next) + ".log");
      std::vector<std::string> settings = methods[trial.method].method.overrides;
      settings.insert(settings.end(), trial.settings.begin(), trial.settings.end());
      trial.process = std::make_unique<Process>(
          "palpate-replay", replay_command(scene, recording, settings, trial.output),
          folder / "palpate-replay.txt");
      running.push_back(&trial);
    }
    for (auto at = running.begin(); at != running.end();) {
      if (!(*at)->process->wait(0)) {
        ++at;
        continue;
      }
      end_trial(**at, recording, cap);
      at = running.erase(at);
      progress.show(static_cast<double>(++done) / static_cast<double>(trials.size()));
    }
    throw_if_interrupted();
    sleep_for(kPoll);
  }
  progress.finish(true);
}

std::string joined(const std::vector<std::string>& texts) {
  std::string all;
  for (const std::string& text : texts) all += (all.empty() ? "" : "; ") + text;
  return all;
}

void write_results(const std::vector<Trial>& trials, const std::vector<Tuned>& methods, int seed,
                   const fs::path& folder, std::ostream& out) {
  std::ofstream csv(folder / "trials.csv"), best(folder / "best.yaml");
  csv << "method,trial,settings,mean_mm,failure,seed,version\n";
  Table table({"method", "its own mean mm", "best mean mm", "with"});
  for (std::size_t m = 0; m < methods.size(); ++m) {
    const std::string& name = methods[m].method.name;
    const Trial *own = nullptr, *least = nullptr;
    for (const Trial& trial : trials) {
      if (trial.method != m) continue;
      csv << csv_cell(name) << ',' << trial.number << ',' << csv_cell(joined(trial.settings)) << ','
          << trial.error * 1e3 << ',' << csv_cell(trial.failure) << ',' << seed << ','
          << PALPATE_VERSION << '\n';
      if (trial.number == 0) own = &trial;
      if (least == nullptr || trial.error < least->error) least = &trial;
    }
    table.add({name, number(own->error * 1e3, 2), number(least->error * 1e3, 2),
               least == own ? "its own" : joined(least->settings)});
    best << nlohmann::json(name).dump() << ":\n";
    for (const std::string& setting : least->settings) best << "  - " << setting << '\n';
  }
  table.print(out);
}

}  // namespace

std::optional<int> TuneSensingCommand::run(const fs::path& root, std::ostream& out) {
  if (!command_->parsed()) return std::nullopt;
  const Options& o = *options_;
  const config::Node plan = config::Node::load_file(
      (o.plan.empty() ? root / "tools/evaluate/published_sensing_tuning.yaml" : o.plan).string());
  SensingScene scene;
  scene.scene = root / plan.text("scene");
  scene.configuration = root / plan.text("configuration");
  scene.scene_overrides = plan.texts("scene_overrides");
  const int seed = plan.integer("seed", {0, 1e9});
  scene.scene_overrides.push_back("seed=" + std::to_string(seed));
  const double cap = plan.number("cap_mm", {0.1, 1e4}) * 1e-3;
  std::vector<Tuned> methods = read_tuned(plan, root);
  plan.check_all_used();
  const auto is_left_out = [&o](const Tuned& tuned) {
    return !o.only.empty() &&
           std::none_of(o.only.begin(), o.only.end(), [&tuned](const std::string& text) {
             return tuned.method.name.find(text) != std::string::npos;
           });
  };
  methods.erase(std::remove_if(methods.begin(), methods.end(), is_left_out), methods.end());
  if (methods.empty()) throw std::invalid_argument("--only leaves no method");
  catch_interruptions();
  const fs::path folder = fs::absolute(o.output);
  const SensingRecording recording = record_sensing(scene, folder);
  std::vector<Trial> trials = make_trials(methods, o.trials, seed);
  run_trials(trials, methods, scene, recording, cap, o.jobs, folder);
  write_results(trials, methods, seed, folder, out);
  out << "trials.csv and best.yaml are in " << folder.string() << '\n';
  return 0;
}

}  // namespace palpate::evaluate
