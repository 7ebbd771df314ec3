#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <optional>

#include "rt/config/command_line.hpp"
#include "rt/config/installation.hpp"
#include "rt/config/node.hpp"
#include "rt/inference/model_file.hpp"
#include "tools/common/program.hpp"
#include "tools/common/progress.hpp"
#include "tools/train/report.hpp"

namespace {

using namespace palpate;

struct Options {
  std::string plan;
  std::vector<std::string> data;
  std::string start_from;
  std::string out = "model.pt";
  std::vector<std::string> overrides;
  std::string picture;
  bool resume = false;
};

/// A file, or the name of a plan supplied with palpate.
std::string plan_path(const std::string& text) {
  if (std::filesystem::exists(text)) return text;
  const std::filesystem::path preset =
      config::data_folder() / "tools/train/presets" / (text + ".yaml");
  if (std::filesystem::exists(preset)) return preset.string();
  throw config::Error(text + ": is neither a file nor a preset");
}

train::Fit fit_with_progress(const recordings::Plan& plan, const recordings::DataSet& data,
                             const Options& options, const sensing::RecurrentWeights* start,
                             const train::Fit* before = nullptr) {
  const bool all_parts = before != nullptr;
  common::Progress progress(all_parts ? 2 : 1, plan.training.refit ? 2 : 1,
                            plan.name + (all_parts ? " on all parts" : ""));
  train::FitOptions fit_options;
  fit_options.all_parts = all_parts;
  fit_options.start = start;
  if (all_parts) fit_options.trust = before->trust;
  double best = 1e300;
  fit_options.progress = [&](const train::CurvePoint& point) {
    best = std::min(best, point.validation);
    std::string note = "iteration " + std::to_string(point.iteration);
    if (std::isfinite(point.validation))
      note += ", validation " + std::to_string(std::sqrt(point.validation)) + ", best " +
              std::to_string(std::sqrt(best)) + " deviations";
    progress.show(plan.training.iterations > 0
                      ? static_cast<double>(point.iteration) / plan.training.iterations
                      : 1,
                  note);
    return true;
  };
  fit_options.checkpoint = options.out + (all_parts ? ".refit.checkpoint" : ".checkpoint");
  fit_options.resume = options.resume;
  const train::Fit fit = train::fit_model(plan, data, fit_options);
  progress.finish(true, "best at iteration " + std::to_string(fit.best_iteration));
  return fit;
}

/// Throws if the module is damaged or its inputs or outputs differ from the plan.
sensing::RecurrentWeights read_start(const recordings::Plan& plan) {
  const inference::ModelFile file = inference::read_model_file(plan.start_from);
  const auto same = [](const std::vector<inference::Channel>& channels,
                       const std::vector<std::string>& columns) {
    return std::equal(
        channels.begin(), channels.end(), columns.begin(), columns.end(),
        [](const inference::Channel& a, const std::string& b) { return a.name == b; });
  };
  if (!same(file.card.inputs, recordings::columns_of(plan.data.inputs)) ||
      !same(file.card.outputs, recordings::columns_of(plan.data.outputs)))
    throw std::runtime_error(plan.start_from + ": its columns are not those of the plan");
  return inference::read_recurrent_weights(file.bytes);
}

int run(const Options& options) {
  recordings::Plan plan =
      recordings::read_plan(config::Node::load_file(plan_path(options.plan), options.overrides));
  if (!options.start_from.empty()) plan.start_from = options.start_from;
  const recordings::DataSet data = recordings::load_data(plan.data, options.data);
  std::optional<sensing::RecurrentWeights> start;
  if (!plan.start_from.empty()) start = read_start(plan);
  const auto* const from = start ? &*start : nullptr;
  const train::Fit fit = fit_with_progress(plan, data, options, from);
  const train::Score score = train::score_fit(plan, data, fit);
  print_score(plan, data, score, std::cout);
  inference::ModelCard card = train::make_card(plan, data, fit, score);
  const std::string picture =
      options.picture.empty()
          ? std::filesystem::path(options.out).replace_extension(".png").string()
          : options.picture;
  const bool drawn = train::draw_fit(plan, data, fit, score, picture);

  sensing::RecurrentWeights weights = fit.network;
  if (plan.training.refit) {
    recordings::Plan again = plan;
    again.training.iterations = fit.best_iteration;
    for (recordings::RecordingPlan& recording : again.data.recordings)
      recording.test.clear(), recording.validation.clear();
    const recordings::DataSet all = recordings::load_data(again.data, options.data);
    const train::Fit last = fit_with_progress(again, all, options, from, &fit);
    weights = last.network;
    // Metadata of these weights; errors stay those of the held-out parts.
    card.domain = last.domain;
    if (card.payload) card.payload = all.payload;
  }
  inference::write_model_file(options.out, weights, card);
  inference::make_compiled_model(inference::read_model_file(options.out));
  for (const char* ending : {".checkpoint", ".refit.checkpoint"})
    std::filesystem::remove(options.out + ending);
  std::cout << "wrote " << options.out << " and " << inference::card_path(options.out)
            << (drawn ? ", " + picture : "") << "\n";
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app(
      "Trains a sensor model on recordings and writes a TorchScript module with its card.");
  app.footer(
      "Example:\n"
      "  palpate-train biotac_lstm --data recordings -o force.pt --picture curve.png");
  app.add_option("plan", options.plan,
                 "YAML file, or a preset: biotac_linear_lstm, "
                 "biotac_direction, biotac_lstm, biotac_emulated, biotac_emulated_lstm, "
                 "biotac_emulated_tuned, ft_rnnob, ft_rnnob_other_day, ft_rnnob_simulated, "
                 "ft_rnnob_thesis_pose, ft_rnnob_thesis_twist, ft_rnnob_thesis")
      ->required();
  app.add_option("--data", options.data,
                 "Folder of the recordings; of several, the first that has a file")
      ->required()
      ->check(CLI::ExistingDirectory);
  app.add_option("-o,--output", options.out,
                 "Module to write; its card is the same name with .yaml")
      ->capture_default_str();
  app.add_option("--set", options.overrides, "path.to.key=value over the plan's");
  app.add_option("--picture", options.picture, "PNG or SVG of curve and predictions");
  app.add_option("--start-from", options.start_from,
                 "Module from which the training continues, in place of the plan's start_from")
      ->check(CLI::ExistingFile);
  app.add_flag("--resume", options.resume, "Continue from the checkpoint next to --output");
  if (const auto code =
          config::parse(app, argc, argv, {{{78, "wrong plan"}}, {{"--out", "--output"}}}))
    return *code;
  return common::run_program("palpate-train", [&] { return run(options); });
}
