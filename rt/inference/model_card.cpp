#include "rt/inference/model_card.hpp"

#include <sodium.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <set>
#include <sstream>
#include <stdexcept>

#include "rt/config/node.hpp"
#include "rt/config/yaml_limits.hpp"

namespace palpate::inference {
namespace {

// far above what a 1 kHz loop can evaluate, yet small enough for a harmless allocation
constexpr int kLargestInputs = 256;
constexpr int kLargestOutputs = 64;
constexpr int kLargestStates = 8192;
constexpr std::size_t kLargestName = 64;

constexpr std::size_t kLargestCard = std::size_t{1} << 20;  // bytes
constexpr config::YamlLimits kLimits{"card", 20, 100000, false};

std::vector<Channel> read_channels(const config::Node& card, const std::string& key, int largest) {
  std::vector<Channel> channels;
  std::set<std::string> names;
  for (const config::Node& node : card.list(key)) {
    Channel channel{node.text("name"), node.text("unit")};
    if (channel.name.empty() || channel.name.size() > kLargestName)
      node.fail("name", "must have 1 to 64 characters");
    if (!names.insert(channel.name).second) node.fail("name", "'" + channel.name + "' comes twice");
    node.check_all_used();
    channels.push_back(channel);
  }
  if (channels.empty() || static_cast<int>(channels.size()) > largest)
    card.fail(key, "has " + std::to_string(channels.size()) + " entries; allowed: 1 to " +
                       std::to_string(largest));
  return channels;
}

YAML::Node to_yaml(const std::vector<Channel>& channels) {
  YAML::Node list(YAML::NodeType::Sequence);
  for (const Channel& channel : channels) {
    YAML::Node entry;
    entry["name"] = channel.name;
    entry["unit"] = channel.unit;
    entry.SetStyle(YAML::EmitterStyle::Flow);
    list.push_back(entry);
  }
  return list;
}

template <class Vector>
YAML::Node numbers_to_yaml(const Vector& vector) {
  YAML::Node list(YAML::NodeType::Sequence);
  for (const double number : vector) list.push_back(number);
  list.SetStyle(YAML::EmitterStyle::Flow);
  return list;
}

}  // namespace

ModelSizes ModelCard::sizes() const {
  return {static_cast<int>(inputs.size()), states, static_cast<int>(outputs.size())};
}

std::string card_path(const std::string& module_path) {
  const std::string ending = ".pt";
  const bool ends =
      module_path.size() > ending.size() &&
      module_path.compare(module_path.size() - ending.size(), ending.size(), ending) == 0;
  return (ends ? module_path.substr(0, module_path.size() - ending.size()) : module_path) + ".yaml";
}

ModelCard read_card(const std::string& path) {
  const std::string text = config::read_text(path, kLargestCard);
  config::check_limits(text, path, kLimits);
  const config::Node node = config::Node::from_text(text, path);
  static const std::set<std::string> kKnown = {
      "format", "name",    "architecture", "sha256", "rate",   "average", "states",
      "inputs", "outputs", "payload",      "domain", "delays", "training"};
  for (const std::string& key : node.keys())
    if (kKnown.count(key) == 0) node.fail(key, "is not a key of a model card");

  const int format = node.integer("format", {1, 1e6});
  if (format != ModelCard::kFormat)
    node.fail("format", "is " + std::to_string(format) + "; this version reads " +
                            std::to_string(ModelCard::kFormat));
  ModelCard card;
  card.name = node.text("name");
  card.architecture = node.text("architecture");
  card.sha256 = node.text("sha256");
  const bool hex = card.sha256.size() == 64 &&
                   card.sha256.find_first_not_of("0123456789abcdef") == std::string::npos;
  if (!hex) node.fail("sha256", "must be 64 digits of 0-9a-f, as sha256sum prints them");
  card.rate = node.number("rate", {0.1, 10000});
  card.average = node.number("average", {0, 10}, 0);
  card.states = node.integer("states", {0, kLargestStates});
  card.inputs = read_channels(node, "inputs", kLargestInputs);
  card.outputs = read_channels(node, "outputs", kLargestOutputs);
  if (node.has("payload")) {
    const config::Node payload = node.child("payload");
    sensing::PayloadParameters parameters;
    parameters.mass = payload.number("mass", {0, 1000});
    parameters.first_moment = payload.vector3("first_moment", {-1000, 1000});
    const std::vector<double> inertia = payload.numbers("inertia", 6, {-1000, 1000});
    std::copy(inertia.begin(), inertia.end(), parameters.inertia.data());
    payload.check_all_used();
    card.payload = parameters;
  }
  if (node.has("domain")) {
    const config::Node domain = node.child("domain");
    if (!card.payload) node.fail("domain", "wants a payload, which is left alone outside of it");
    const auto inputs = static_cast<Eigen::Index>(card.inputs.size());
    const std::vector<double> deviation = domain.numbers("deviation", -1, {1e-9, 1e9});
    const std::vector<double> points = domain.numbers("points", -1, {-1e9, 1e9});
    const auto count = static_cast<Eigen::Index>(points.size()) / inputs;
    if (count == 0 || count * inputs != static_cast<Eigen::Index>(points.size()))
      domain.fail("points", "must hold a number for each input, point after point");
    card.domain.deviation = Eigen::Map<const Eigen::VectorXd>(
        deviation.data(), static_cast<Eigen::Index>(deviation.size()));
    card.domain.points = Eigen::Map<const Eigen::MatrixXd>(points.data(), inputs, count);
    card.domain.near = domain.number("near", {0, 1e9});
    card.domain.far = domain.number("far", {0, 1e9});
    domain.check_all_used();
    try {
      card.domain.check(static_cast<int>(inputs));
    } catch (const std::invalid_argument& error) {
      node.fail("domain", error.what());
    }
  }
  for (const config::Node& delay : node.list("delays")) {
    card.delays.push_back({delay.text("stream"), delay.number("seconds", {-10, 10})});
    delay.check_all_used();
  }
  if (node.has("training")) card.training = YAML::Load(text)["training"];
  return card;
}

void write_card(const ModelCard& card, const std::string& path) {
  YAML::Node node;
  node["format"] = ModelCard::kFormat;
  node["name"] = card.name;
  node["architecture"] = card.architecture;
  node["sha256"] = card.sha256;
  node["rate"] = card.rate;
  node["average"] = card.average;
  node["states"] = card.states;
  node["inputs"] = to_yaml(card.inputs);
  node["outputs"] = to_yaml(card.outputs);
  if (card.payload) {
    YAML::Node payload;
    payload["mass"] = card.payload->mass;
    payload["first_moment"] = numbers_to_yaml(card.payload->first_moment);
    payload["inertia"] = numbers_to_yaml(card.payload->inertia);
    node["payload"] = payload;
  }
  if (card.domain.points.cols() > 0) {
    YAML::Node domain;
    domain["near"] = card.domain.near;
    domain["far"] = card.domain.far;
    domain["deviation"] = numbers_to_yaml(card.domain.deviation);
    domain["points"] = numbers_to_yaml(card.domain.points.reshaped());
    node["domain"] = domain;
  }
  for (const StreamDelay& delay : card.delays) {
    YAML::Node entry;
    entry["stream"] = delay.stream;
    entry["seconds"] = delay.seconds;
    entry.SetStyle(YAML::EmitterStyle::Flow);
    node["delays"].push_back(entry);
  }
  if (card.training.IsDefined() && !card.training.IsNull()) node["training"] = card.training;
  YAML::Emitter emitter;
  emitter << node;
  std::ofstream file(path);
  file << emitter.c_str() << '\n';
  file.close();
  if (!file) throw std::runtime_error(path + ": cannot be written");
}

std::string sha256_of(const std::string& bytes) {
  if (sodium_init() < 0) throw std::runtime_error("libsodium cannot be initialised");
  unsigned char hash[crypto_hash_sha256_BYTES];
  crypto_hash_sha256(hash, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
  char text[2 * sizeof(hash) + 1];
  sodium_bin2hex(text, sizeof(text), hash, sizeof(hash));
  return text;
}

}  // namespace palpate::inference
