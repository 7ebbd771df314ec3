#include "tools/lab/sensor_models/sensors_models.hpp"

#include <algorithm>
#include <stdexcept>

#include "core/sensing/streamed_model.hpp"
#include "rt/config/installation.hpp"
#include "rt/inference/model_file.hpp"
#include "tools/lab/sensor_models/sensors_stream.hpp"

namespace palpate::sensor_models {
namespace {

std::string presets_folder() { return (config::data_folder() / "tools/train/presets/").string(); }

std::vector<std::string> output_names(SensorKind kind) {
  return recordings::columns_of(plan_of(kind).data.outputs);
}

int output_place(const inference::ModelCard& card, const std::string& name) {
  for (std::size_t i = 0; i < card.outputs.size(); ++i)
    if (card.outputs[i].name == name) return static_cast<int>(i);
  return -1;
}

bool gives(const inference::ModelCard& card, SensorKind kind) {
  for (const std::string& name : output_names(kind))
    if (output_place(card, name) < 0) return false;
  return true;
}

SensorKind kind_of(const inference::ModelFile& file) {
  for (const SensorKind kind : {SensorKind::kWrist, SensorKind::kForce, SensorKind::kDirection})
    if (gives(file.card, kind)) return kind;
  std::string names;
  for (const inference::Channel& output : file.card.outputs) names += " " + output.name;
  throw std::runtime_error(file.path + ": the card is of no sensor that is scored: it gives" +
                           names + "; known: fx fy fz, nx ny nz, fx fy fz tx ty tz");
}

int window_of(const std::string& name) {
  const std::string preset = presets_folder() + name + ".yaml";
  if (!std::filesystem::exists(preset)) return 0;
  const recordings::Plan plan = recordings::read_plan(config::Node::load_file(preset));
  return plan.training.carry ? 0 : plan.training.steps;
}

/// The network alone, as used by components.
sensing::StreamedModel network_of(const inference::ModelFile& file, SensorKind kind,
                                  const std::string& executor) {
  std::vector<int> inputs, outputs;
  for (const inference::Channel& input : file.card.inputs) {
    inputs.push_back(input_place(kind, input.name));
    if (inputs.back() < 0)
      throw std::runtime_error(file.path + ": the model takes an input '" + input.name +
                               "', which a recording of a " + name_of(kind) + " has not");
  }
  for (const std::string& name : output_names(kind))
    outputs.push_back(output_place(file.card, name));
  return sensing::StreamedModel(
      inference::make_executor(file,
                               executor == "torch" ? inference::ExecutorKind::kTorch
                                                   : inference::ExecutorKind::kCompiled,
                               patient_executor()),
      inputs, outputs);
}

void step(sensing::StreamedModel& network, const SensorTrack& track, Eigen::Index row,
          const std::string& path) {
  network.step(track.input.row(row).transpose());
  if (network.has_failed() || !network.has_answer())
    throw std::runtime_error(path + ": the model fails or hangs on " + track.recording.name);
}

/// Streamed if `window` is 0; otherwise from a zero state over the last `window` rows each, padded
/// before the start with copies of the first.
Eigen::MatrixXd run_network(const inference::ModelFile& file, const std::string& executor,
                            const SensorTrack& track, int window) {
  const SensorKind kind = track.recording.kind;
  sensing::StreamedModel network = network_of(file, kind, executor);
  Eigen::MatrixXd answers(track.input.rows(), track.truth.cols());
  for (Eigen::Index k = 0; k < answers.rows(); ++k) {
    if (window > 0) network.restart();
    for (Eigen::Index i = window > 0 ? k - window + 1 : k; i <= k; ++i)
      step(network, track, std::max<Eigen::Index>(i, 0), file.path);
    answers.row(k) = network.answer().transpose();
    if (kind == SensorKind::kWrist && file.card.payload)
      answers.row(k) += sensing::load_wrench(*file.card.payload,
                                             track.samples[static_cast<std::size_t>(k)].motion)
                            .vector()
                            .transpose();
  }
  return answers;
}

}  // namespace

SensorKind kind_of_preset(const std::string& preset) {
  const recordings::Plan plan =
      recordings::read_plan(config::Node::load_file(presets_folder() + preset + ".yaml"));
  if (plan.data.is_wrist) return SensorKind::kWrist;
  return recordings::columns_of(plan.data.outputs) == output_names(SensorKind::kDirection)
             ? SensorKind::kDirection
             : SensorKind::kForce;
}

SensorModelFile read_sensor_model(const std::filesystem::path& path) {
  const inference::ModelFile file = inference::read_model_file(path.string());
  SensorModelFile model;
  model.path = path;
  model.kind = kind_of(file);
  model.name = file.card.name;
  model.training = training_of(file.card);
  model.window = window_of(model.name);
  return model;
}

std::vector<SensorMethod> make_methods(const SensorModelFile& model, const std::string& executor,
                                       const std::optional<FingertipFrame>& frame) {
  const inference::ModelFile file = inference::read_model_file(model.path.string());
  network_of(file, model.kind, executor);  // checks compatibility now
  std::vector<SensorMethod> methods;
  const std::string path = model.path.string();
  SensorMethod streamed{model.name, true, {}};
  switch (model.kind) {
    case SensorKind::kForce:
      streamed.answer = [path, executor](const SensorTrack& track) {
        return stream_fingertip(path, executor, track);
      };
      break;
    case SensorKind::kWrist:
      streamed.answer = [path, executor, card = file.card](const SensorTrack& track) {
        return Eigen::MatrixXd(track.truth - stream_wrist(path, executor, card, track));
      };
      break;
    case SensorKind::kDirection:
      streamed.answer = [file, executor](const SensorTrack& track) {
        return run_network(file, executor, track, 0);
      };
      break;
  }
  methods.push_back(streamed);
  if (model.kind == SensorKind::kDirection && frame)
    methods.push_back({model.name + ", placed on the skin", true,
                       [path, executor, card = file.card, frame = *frame](const SensorTrack& t) {
                         return stream_place(path, card, frame, executor, t);
                       }});
  if (model.window > 0)
    methods.push_back({model.name + ", windows of " + std::to_string(model.window), true,
                       [file, executor, window = model.window](const SensorTrack& track) {
                         return run_network(file, executor, track, window);
                       }});
  return methods;
}

}  // namespace palpate::sensor_models
