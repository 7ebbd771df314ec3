#include <chrono>
#include <fstream>

#include "rt/config/installation.hpp"
#include "rt/inference/model_card.hpp"
#include "tools/common/interruption.hpp"
#include "tools/common/process.hpp"
#include "tools/common/progress.hpp"
#include "tools/lab/sensor_models/sensors_models.hpp"
#include "tools/lab/studies/study_hash.hpp"

namespace palpate::sensor_models {
namespace {

/// Hash of everything that a trained model depends on.
std::string hash_of_training(const config::Node& preset, const recordings::Plan& plan,
                             const std::filesystem::path& data,
                             const std::filesystem::path& program) {
  std::string text = std::to_string(preset.hash()) + studies::hash_of_file(program);
  for (const recordings::RecordingPlan& recording : plan.data.recordings)
    text += studies::hash_of_file(data / recording.file);
  return inference::sha256_of(text).substr(0, 12);
}

}  // namespace

const std::vector<std::string>& default_sensor_models() {
  static const std::vector<std::string> kPresets{
      "biotac_linear_lstm", "biotac_lstm",         // force
      "biotac_direction",                          // direction
      "ft_rnnob",           "ft_rnnob_other_day",  // wrist
      "ft_rnnob_thesis",    "ft_rnnob_thesis_twist", "ft_rnnob_thesis_pose",
  };
  return kPresets;
}

std::optional<std::filesystem::path> train_sensor_model(const std::string& preset,
                                                        const SensorTrainingOptions& options,
                                                        int position, int count) {
  const std::filesystem::path program = common::program_folder() / "palpate-train";
  std::vector<std::string> overrides;
  if (!options.refit) overrides.push_back("training.refit=false");
  const config::Node node = config::Node::load_file(
      (config::data_folder() / "tools/train/presets" / (preset + ".yaml")).string(), overrides);
  const recordings::Plan plan = recordings::read_plan(node);
  for (const recordings::RecordingPlan& recording : plan.data.recordings)
    if (!std::filesystem::exists(options.data / recording.file)) return {};
  if (!std::filesystem::exists(program))
    throw std::runtime_error(program.string() + ": is absent; give models by --model");

  const std::string stem = preset + "-" + hash_of_training(node, plan, options.data, program);
  const std::filesystem::path model = options.output / (stem + ".pt");
  if (std::filesystem::exists(model) &&
      std::filesystem::exists(inference::card_path(model.string())))
    return model;

  std::filesystem::create_directories(options.output);
  // Written under a temporary name until complete: the next run relies on existing files. Files of
  // an interrupted run are resumed, since the name covers everything that matters.
  const std::filesystem::path fresh = options.output / (stem + ".new.pt");
  const std::filesystem::path log = options.output / (stem + ".log");
  std::vector<std::string> command{program.string(),
                                   preset,
                                   "--data",
                                   options.data.string(),
                                   "--output",
                                   fresh.string(),
                                   "--resume",
                                   "--picture",
                                   (options.output / (stem + ".png")).string()};
  for (const std::string& item : overrides) {
    command.push_back("--set");
    command.push_back(item);
  }
  common::Progress progress(position, count, "training " + preset);
  common::Process process("palpate-train", command, log);
  const auto start = std::chrono::steady_clock::now();
  std::optional<int> code;
  while (!(code = process.wait(0.5))) {
    common::throw_if_interrupted();
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
    progress.show(0, std::to_string(static_cast<int>(elapsed.count())) + " s");
  }
  if (*code != 0) {
    progress.finish(false);
    throw std::runtime_error("palpate-train " + preset + " failed:\n" + common::tail(log, 5));
  }
  std::filesystem::rename(inference::card_path(fresh.string()),
                          inference::card_path(model.string()));
  std::filesystem::rename(fresh, model);
  progress.finish(true);
  return model;
}

}  // namespace palpate::sensor_models
