#include "tools/lab/demo/demo.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iostream>
#include <nlohmann/json.hpp>

#include "tools/common/interruption.hpp"
#include "tools/common/output_files.hpp"
#include "tools/lab/runs/live_run.hpp"
#include "tools/lab/uncertainty/drawn_error.hpp"
#include "tools/lab/uncertainty/draws_command.hpp"

namespace palpate::demo {
namespace {

constexpr int kDraws = 100;  // as in the studies, whose draws these are

struct Stage {
  const char* name;
  void (*run)(Demo&);
  int (*count)(const Demo&);
};
constexpr Stage kStages[] = {{"sensing", run_sensing, count_sensing},
                             {"control", run_control, count_control},
                             {"recording", run_recording, count_recording}};

bool is_wanted(const DemoOptions& options, const std::string& stage) {
  return std::count(options.stages.begin(), options.stages.end(), stage) > 0;
}

bool is_good(const scores::ScoredRun& run) { return run.failure.empty() && run.missed.empty(); }

nlohmann::json summary(const Demo& demo, double seconds, bool good) {
  nlohmann::json json{{"version", PALPATE_VERSION}, {"duration_s", seconds}, {"passed", good}};
  for (const scores::ScoredRun& run : demo.scored) json["runs"].push_back(to_json(run));
  return json;
}

}  // namespace

std::filesystem::path Demo::log_folder(const std::string& run) const {
  return options.output / "logs" / common::file_name(run);
}

runs::Mismatch Demo::mismatch(const std::string& level, const std::string& scene,
                              const std::string& configuration) const {
  const std::string family = level.substr(0, level.find(' '));
  const std::filesystem::path drawn = uncertainty::distributions_file(options.root, family);
  runs::Mismatch mismatch = std::filesystem::exists(drawn)
                                ? uncertainty::draw_mismatch(uncertainty::read_distributions(drawn),
                                                             uncertainty::LatinHypercube(1, kDraws),
                                                             std::stoi(level.substr(family.size())),
                                                             file(scene), file(configuration))
                                : runs::read_mismatch(file("tools/lab/studies/mismatch.yaml"),
                                                      level, file(scene), file(configuration));
  const auto prepend = [](std::vector<std::string>& to, const std::vector<std::string>& from) {
    to.insert(to.begin(), from.begin(), from.end());
  };
  prepend(mismatch.scene, options.scene_overrides);
  prepend(mismatch.daemon, options.daemon_overrides);
  return mismatch;
}

int run_demo(const DemoOptions& options) {
  using Clock = std::chrono::steady_clock;
  const auto begin = Clock::now();
  common::catch_interruptions();
  Demo demo;
  demo.options = options;
  // Programs that read these files resolve paths relative to the files.
  demo.options.output = std::filesystem::absolute(options.output);
  std::filesystem::create_directories(options.output);
  std::filesystem::remove_all(options.output / "logs");
  for (const Stage& stage : kStages)
    if (is_wanted(options, stage.name)) demo.runs += stage.count(demo);
  for (const Stage& stage : kStages)
    if (is_wanted(options, stage.name)) stage.run(demo);

  const double seconds = std::chrono::duration<double>(Clock::now() - begin).count();
  const bool good = std::all_of(demo.scored.begin(), demo.scored.end(), is_good);
  std::cout << '\n';
  scores::print_report(demo.scored, std::cout);
  const nlohmann::json json = summary(demo, seconds, good);
  common::write_json(json, options.output / "summary.json");
  if (!options.json.empty()) common::write_json(json, options.json);
  std::cout << (good ? "Every stage passed" : "A STAGE FAILED") << " in " << std::lround(seconds)
            << " s; pictures, plots, logs and summary.json are in " << options.output.string()
            << '\n';
  return good ? 0 : 1;
}

}  // namespace palpate::demo
