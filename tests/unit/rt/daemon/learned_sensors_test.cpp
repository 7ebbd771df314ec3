// Learned sensor models within the daemon: a recording of a fingertip on a foam bar is fed message
// by message, and the output must equal the model's own for the same counts.

#ifndef PALPATE_WITHOUT_TORCH

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <palpate/biotac_t.hpp>
#include <palpate/component_command_t.hpp>
#include <palpate/contacts_t.hpp>
#include <random>
#include <sstream>

#include "core/sensing/linear_tactile.hpp"
#include "rt/bus/text.hpp"
#include "rt/daemon/daemon.hpp"
#include "rt/inference/model_file.hpp"
#include "tests/support/recordings.hpp"

namespace palpate::daemon {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

constexpr int kTareSamples = 50;
constexpr int kTicksPerSample = 10;

/// Rows of pac0, pdc, e1 to e19 of the recording.
std::vector<biotac_t> recorded_samples(int count) {
  std::ifstream file(support::recordings() / "biotac_foam_bar" / "ring_finger_dev.csv");
  std::vector<biotac_t> samples;
  std::string line;
  std::getline(file, line);  // t, fx ... tz, pac0, pac1, pdc, tac, tdc, e1, ...
  while (static_cast<int>(samples.size()) < count && std::getline(file, line)) {
    std::vector<double> cells;
    std::istringstream text(line);
    for (std::string cell; std::getline(text, cell, ',');) cells.push_back(std::stod(cell));
    biotac_t sample{};
    sample.session = 3;
    sample.seq = static_cast<int>(samples.size());
    sample.utime = 1'000'000 + std::llround(cells[0] * 1e6);
    sample.valid = biotac_t::VALID_ELECTRODES | biotac_t::VALID_PAC | biotac_t::VALID_PDC;
    sample.pac_count = 1;
    sample.pac[0] = static_cast<std::int16_t>(cells[7]);
    sample.pdc = static_cast<std::int16_t>(cells[9]);
    for (int e = 0; e < 19; ++e) sample.electrodes[e] = static_cast<std::int16_t>(cells[12 + e]);
    samples.push_back(sample);
  }
  return samples;
}

sensing::TactileInputs inputs_of(const biotac_t& sample) {
  sensing::TactileInputs inputs;
  for (int e = 0; e < 19; ++e) inputs[e] = sample.electrodes[e];
  inputs[19] = sample.pac[0];
  inputs[20] = sample.pdc;
  return inputs;
}

/// Cells with random weights in parallel with a path that gives some mN per count.
sensing::RecurrentWeights some_weights() {
  std::mt19937 random(5);
  std::normal_distribution<float> normal(0, 0.3f);
  sensing::RecurrentWeights w = sensing::RecurrentWeights::zero(21, 3, {12});
  w.input_deviation.array() = 30;
  const auto fill = [&](auto& part) {
    for (Eigen::Index i = 0; i < part.size(); ++i) part.data()[i] = normal(random);
  };
  fill(w.layers[0].input);
  fill(w.layers[0].hidden);
  fill(w.layers[0].bias);
  fill(w.dense);
  fill(w.linear);
  w.output_deviation.array() = 0.5f;
  return w;
}

class LearnedSensors : public ::testing::Test {
 protected:
  LearnedSensors()
      : folder_(fs::temp_directory_path() / ("palpate-learned-" + std::to_string(getpid()))) {
    fs::create_directories(folder_);
    model_ = (folder_ / "finger.pt").string();
    inference::ModelCard card;
    card.name = "finger";
    card.rate = 100;
    for (int e = 1; e <= 19; ++e) card.inputs.push_back({"e" + std::to_string(e), "count"});
    card.inputs.push_back({"pac0", "count"});
    card.inputs.push_back({"pdc", "count"});
    card.outputs = {{"fx", "N"}, {"fy", "N"}, {"fz", "N"}};
    inference::write_model_file(model_, some_weights(), card);
  }
  ~LearnedSensors() override { fs::remove_all(folder_); }

  config::Node configuration(const std::string& executor, const std::string& more = "") const {
    return config::Node::load_file(
        PALPATE_SOURCE_DIR "/rt/config/examples/foam_bar_tactile.yaml",
        {"sensing=[{name: ring_finger, component: biotac_lstm, finger: 0, model_file: " + model_ +
             ", executor: " + executor + more + ", contact_force: 0, release_force: 0}]",
         "object.mesh={box: {size: [0.2, 0.04, 0.04], cells: [4, 1, 1]}}"});
  }

  std::string complaint(const std::string& executor = "torch", const std::string& more = "") const {
    const auto hub = bus::make_memory_hub();
    const auto bus = bus::make_memory_bus(hub);
    try {
      Daemon daemon(configuration(executor, more), *bus, *bus, Mode::kDeterministic, 1);
    } catch (const config::Error& error) {
      return error.what();
    }
    return "";
  }

  fs::path folder_;
  std::string model_;
};

/// Messages published by a daemon in deterministic mode while it receives the samples, one every
/// tenth tick.
struct Outcome {
  std::vector<std::vector<double>> forces;  // of the first contact, by sample; empty: none
  std::vector<std::uint8_t> bytes;          // of everything
  health_t health{};
};

Outcome run(const config::Node& configuration, const std::vector<biotac_t>& samples) {
  const auto hub = bus::make_memory_hub();
  const auto input = bus::make_memory_bus(hub);
  const auto bus = bus::make_memory_bus(hub);
  Daemon daemon(configuration, *bus, *bus, Mode::kDeterministic, 1);
  bus->start();
  std::int64_t now_ns = 1'000'000'000;
  bus::set_time(*hub, now_ns);
  component_command_t start{};
  start.session = 1;
  start.counter = 1;
  bus::put_text(start.slot, "all");
  bus::put_text(start.event, "start");
  bus::TypedPublisher<component_command_t>(*input, "COMPONENT_COMMAND").publish(start);

  Outcome result;
  bus::TypedPublisher<biotac_t> fingertip(*input, "BIOTAC_0");
  std::vector<bus::Published> published;
  contacts_t contacts{};
  for (const biotac_t& sample : samples) {
    for (int tick = 0; tick < kTicksPerSample; ++tick) {
      bus::set_time(*hub, now_ns);
      bus::record(*hub, nullptr);
      if (tick == 0) fingertip.publish(sample);
      bus::record(*hub, &published);
      daemon.tick({now_ns, now_ns / 1000, 0});
      for (const bus::Published& message : published) {
        const int size = static_cast<int>(message.data.size());
        if (message.channel == "CONTACTS") contacts.decode(message.data.data(), 0, size);
        if (message.channel == "HEALTH") result.health.decode(message.data.data(), 0, size);
        result.bytes.insert(result.bytes.end(), message.data.begin(), message.data.end());
      }
      published.clear();
      now_ns += 1'000'000;
    }
    std::vector<double> force;
    if (contacts.count > 0) force.assign(contacts.wrench[0], contacts.wrench[0] + 3);
    result.forces.push_back(force);
  }
  return result;
}

TEST_F(LearnedSensors, TheDaemonSaysWhatTheModelSaysOfTheSameRecording) {
  PALPATE_REQUIRE_RECORDING("biotac_foam_bar");
  const std::vector<biotac_t> samples = recorded_samples(1000);
  ASSERT_EQ(samples.size(), 1000u);
  const auto offset = [&] {
    sensing::TactileInputs sum = sensing::TactileInputs::Zero();
    for (int i = 0; i < kTareSamples; ++i) sum += inputs_of(samples[i]);
    return sensing::TactileInputs(sum / kTareSamples);
  }();
  const math::Pose X_OT =
      config::Node::load_file(PALPATE_SOURCE_DIR "/rt/config/examples/foam_bar_tactile.yaml")
          .child("frames")
          .list("fingertips_in_object")[0]
          .pose("pose");
  for (const std::string executor : {"torch", "compiled"}) {
    const Outcome answers = run(configuration(executor), samples);
    sensing::RecurrentNetwork network(some_weights());
    std::vector<float> state(network.states(), 0.f);
    int compared = 0;
    double largest = 0;
    for (std::size_t k = kTareSamples - 1; k < samples.size(); ++k) {
      const Eigen::VectorXf input = (inputs_of(samples[k]) - offset).cast<float>();
      Eigen::Vector3f force;
      network.step(input.data(), state.data(), force.data());
      if (answers.forces[k].empty()) continue;  // no electrode was active
      const Eigen::Vector3d expected = X_OT.linear() * force.cast<double>();
      const Eigen::Map<const Eigen::Vector3d> found(answers.forces[k].data());
      largest = std::max(largest, (found - expected).cwiseAbs().maxCoeff());
      ++compared;
    }
    EXPECT_GT(compared, 300) << executor;
    EXPECT_LT(largest, 1e-5) << executor;

    ASSERT_EQ(answers.health.model_count, 1);
    EXPECT_STREQ(bus::get_text(answers.health.model_name[0]), "ring_finger");
    EXPECT_EQ(bus::get_text(answers.health.model_executor[0]), executor);
    EXPECT_NEAR(static_cast<double>(answers.health.model_steps[0]), 1000 - kTareSamples, 11);
    EXPECT_EQ(answers.health.model_late[0], 0);
    EXPECT_EQ(answers.health.model_dropped[0], 0);
  }
}

TEST_F(LearnedSensors, TwoDeterministicRunsAreBitIdentical) {
  PALPATE_REQUIRE_RECORDING("biotac_foam_bar");
  const std::vector<biotac_t> samples = recorded_samples(300);
  // It waits for each result, regardless of wait_us.
  const config::Node node = configuration("torch", ", wait_us: 0, localisation: gaussian");
  const Outcome first = run(node, samples);
  EXPECT_GT(first.bytes.size(), 100000u);
  EXPECT_TRUE(first.bytes == run(node, samples).bytes);
}

TEST_F(LearnedSensors, ADamagedModelIsRefusedByNameAndReason) {
  EXPECT_EQ(complaint(), "");
  std::string bytes;
  {
    std::ostringstream text;
    text << std::ifstream(model_, std::ios::binary).rdbuf();
    bytes = text.str();
  }
  bytes[bytes.size() / 2] ^= 4;
  std::ofstream(model_, std::ios::binary) << bytes;
  for (const std::string executor : {"torch", "compiled"}) {
    const std::string error = complaint(executor);
    EXPECT_THAT(error, HasSubstr("sensing.0.model_file"));
    EXPECT_THAT(error, HasSubstr("finger.pt"));
    EXPECT_THAT(error, HasSubstr("the file is damaged"));
  }
  fs::remove(model_);
  EXPECT_THAT(complaint(), HasSubstr("finger.pt: is not a file"));
}

TEST_F(LearnedSensors, AModelOfSomethingElseIsRefused) {
  inference::ModelCard card = inference::read_model_file(model_).card;
  const auto write = [&](const std::string& input, const std::string& unit,
                         const std::string& output) {
    card.inputs[4] = {input, unit};
    card.outputs[2].name = output;
    inference::write_model_file(model_, some_weights(), card);
  };
  write("e20", "count", "fz");
  EXPECT_THAT(complaint(), HasSubstr("takes an input 'e20'; known: e1 to e19, pac0, pdc"));
  write("e5", "V", "fz");
  EXPECT_THAT(complaint(), HasSubstr("takes input 'e5' in V, not in count"));
  write("e5", "count", "force");
  EXPECT_THAT(complaint(), HasSubstr("has no output 'fz'"));
  write("e5", "count", "fz");
  EXPECT_THAT(complaint("torch", ", direction_file: " + model_), HasSubstr("has no output 'nx'"));
  EXPECT_THAT(complaint("other"), HasSubstr("torch, compiled"));
}

}  // namespace
}  // namespace palpate::daemon

#endif
