#pragma once

#include <yaml-cpp/yaml.h>

#include <optional>
#include <string>
#include <vector>

#include "core/sensing/input_domain.hpp"
#include "core/sensing/payload.hpp"
#include "rt/inference/sequence_model.hpp"

namespace palpate::inference {

/// One number that a model takes or gives.
struct Channel {
  std::string name;  // e.g. "e1", "gravity_x", "fx"
  std::string unit;  // e.g. "count", "N"
};

/// How much a stream lags behind the robot's pose, s.
struct StreamDelay {
  std::string stream;
  double seconds = 0;
};

/// The YAML file beside a TorchScript module, <module without .pt>.yaml, that says what goes in and
/// out:
///   format: 1
///   name: biotac_linear_lstm
///   architecture: recurrent_network   # or any other word: then only `executor: torch` runs it
///   sha256: ...                       # of the module's file, as sha256sum prints it
///   rate: 100                         # Hz, of the steps
///   average: 0.1                      # s, trailing mean of all inputs and outputs; 0: none
///   states: 48
///   inputs: [{name: e1, unit: count}, ...]
///   outputs: [{name: fx, unit: N}, ...]
///   payload: {mass: ..., first_moment: [...], inertia: [...]}  # where the outputs are the rest
///   domain: {near: 2, far: 4, deviation: [...], points: [...]}  # with a payload: where the rest
///   is
///                                     # believed; points one behind the other
///   delays: [{stream: force_torque, seconds: 0.004}, ...]      # that this leaves
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

/// The architecture that the compiled executor knows.
inline constexpr const char* kRecurrentNetwork = "recurrent_network";

/// The card of a module: the same name with .yaml for .pt (or after any other ending).
std::string card_path(const std::string& module_path);

/// Throws config::Error naming file, line, key and the allowed range.
ModelCard read_card(const std::string& path);
/// Throws std::runtime_error where the file cannot be written.
void write_card(const ModelCard& card, const std::string& path);

/// SHA-256 as sha256sum prints it.
std::string sha256_of(const std::string& bytes);

}  // namespace palpate::inference
