#pragma once

#include <yaml-cpp/yaml.h>

#include <optional>
#include <string>
#include <vector>

#include "core/sensing/input_domain.hpp"
#include "core/sensing/payload.hpp"
#include "rt/inference/sequence_model.hpp"

namespace palpate::inference {

/// Input or output of a model.
struct Channel {
  std::string name;  // e.g. "e1", "gravity_x", "fx"
  std::string unit;  // e.g. "count", "N"
};

/// Delay of a stream relative to the robot's pose, s.
struct StreamDelay {
  std::string stream;
  double seconds = 0;
};

/// Model card: YAML file next to a TorchScript module, <module without .pt>.yaml, that describes
/// its inputs and outputs:
///   format: 1
///   name: biotac_linear_lstm
///   architecture: recurrent_network   # any other word: requires `executor: torch`
///   sha256: ...                       # of the module's file, as sha256sum prints it
///   rate: 100                         # Hz, of the steps
///   average: 0.1                      # s, trailing mean of all inputs and outputs; 0: none
///   states: 48
///   inputs: [{name: e1, unit: count}, ...]
///   outputs: [{name: fx, unit: N}, ...]
///   payload: {mass: ..., first_moment: [...], inertia: [...]}   # if the outputs are a residual
///   domain: {near: 2, far: 4, deviation: [...], points: [...]}  # with a payload: domain of
///                                     # validity of the residual; points in succession
///   delays: [{stream: force_torque, seconds: 0.004}, ...]       # remaining delays
///   training: anything                # data and their hashes, split, errors, seed, versions
struct ModelCard {
  static constexpr int kFormat = 1;

  std::string name;
  std::string architecture;
  std::string sha256;
  double rate = 0;
  double average = 0;
  int states = 0;
  std::vector<Channel> inputs;
  std::vector<Channel> outputs;
  std::optional<sensing::PayloadParameters> payload;  // without bias
  sensing::InputDomain domain;
  std::vector<StreamDelay> delays;
  YAML::Node training;

  ModelSizes sizes() const;
};

/// Architecture supported by the compiled executor.
inline constexpr const char* kRecurrentNetwork = "recurrent_network";

/// Path of a module's model card: the same name with .yaml instead of .pt (or appended to any other
/// name).
std::string card_path(const std::string& module_path);

/// Throws config::Error naming file, line, key and permitted range.
ModelCard read_card(const std::string& path);
/// Throws std::runtime_error if the file cannot be written.
void write_card(const ModelCard& card, const std::string& path);

/// SHA-256 as sha256sum prints it.
std::string sha256_of(const std::string& bytes);

}  // namespace palpate::inference
