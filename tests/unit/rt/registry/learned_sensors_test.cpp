#include "rt/registry/sensors.hpp"

#ifndef PALPATE_WITHOUT_TORCH

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "rt/inference/model_file.hpp"
#include "rt/loop/allocation_counter.hpp"

namespace palpate::registry {
namespace {

using ::testing::HasSubstr;

template <class T, int kCapacity>
void feed(sensing::Stream<T, kCapacity>& stream) {
  stream.freshness = Freshness::kNew;
  stream.age = 0;
  stream.fresh_count = 1;
}

/// Networks that output a constant 0.2 N along x (the finger's: along z).
class LearnedComponents : public ::testing::Test {
 protected:
  LearnedComponents()
      : folder_(std::filesystem::temp_directory_path() /
                ("palpate-components-" + std::to_string(getpid()))) {
    std::filesystem::create_directories(folder_);
    observer_.name = "observer";
    observer_.rate = 100;
    observer_.average = 0.1;
    observer_.inputs = {{"gravity_z", "1"}, {"acceleration_x", "m/s^2"}};
    observer_.outputs = {{"fx", "N"},   {"fy", "N"},   {"fz", "N"},
                         {"tx", "N m"}, {"ty", "N m"}, {"tz", "N m"}};
    observer_.payload = sensing::PayloadParameters{};
    observer_.payload->mass = 2;
    observer_.delays = {{"force_torque", 0.0042}, {"inertial", -0.001}};
    finger_.name = "finger";
    finger_.rate = 100;
    finger_.inputs = {{"pdc", "count"}, {"e3", "count"}};
    finger_.outputs = {{"fz", "N"}, {"fx", "N"}, {"fy", "N"}};
    write();
    context_.period = 1e-3;
    context_.deterministic = true;
  }
  ~LearnedComponents() override { std::filesystem::remove_all(folder_); }

  void write() const {
    for (const inference::ModelCard* card : {&observer_, &finger_}) {
      sensing::RecurrentWeights weights =
          sensing::RecurrentWeights::zero(2, static_cast<int>(card->outputs.size()), {8});
      weights.offset[0] = 0.2f;
      inference::write_model_file((folder_ / (card->name + ".pt")).string(), weights, *card);
    }
  }

  std::unique_ptr<sensing::SensorModel> make(const std::string& component,
                                             const std::string& more = "") const {
    const std::string model = component == "ft_rnnob" ? "observer" : "finger";
    return make_sensor_model(
        config::Node::from_text("{component: " + component + ", model_file: " +
                                (folder_ / (model + ".pt")).string() + more + "}"),
        context_);
  }
  std::string complaint(const std::string& component, const std::string& more = "") const {
    try {
      make(component, more);
    } catch (const config::Error& error) {
      return error.what();
    }
    return "";
  }

  static sensing::Signals signals() {
    sensing::Signals signals;
    feed(signals.robot);
    feed(signals.inertial);
    feed(signals.force_torque);
    feed(signals.biotac[0]);
    signals.inertial.fresh[0].acceleration_I = {0, 0, 9.81};
    signals.force_torque.fresh[0].F_S.force = {1, 0, 2 * 9.81};
    return signals;
  }

  std::filesystem::path folder_;
  inference::ModelCard observer_, finger_;
  Context context_;
};

TEST_F(LearnedComponents, RunWithoutAllocationInBothExecutors) {
  for (const std::string executor : {", executor: torch", ", executor: compiled"}) {
    const auto observer = make("ft_rnnob", executor);
    const auto finger =
        make("biotac_lstm", executor + ", tare_samples: 1, localisation: gaussian, threshold: 0");
    sensing::Signals input = signals();
    sensing::ContactSet contacts;
    {
      const loop::NoAllocationScope scope;
      for (int i = 0; i < 300; ++i) {
        contacts.count = 0;
        input.biotac[0].fresh[0].time = 0.01 * i;
        input.biotac[0].fresh[0].electrodes[2] = i > 0 ? 100 : 0;
        static_cast<void>(observer->update(input, contacts));
        static_cast<void>(finger->update(input, contacts));
      }
      EXPECT_EQ(scope.count(), 0);
    }
    ASSERT_EQ(contacts.count, 2);
    // 1 N and the weight of 2 kg are read; 0.2 N of them are the network's.
    EXPECT_LT((contacts.contacts[0].wrench.force - Eigen::Vector3d(0.8, 0, 0)).norm(), 1e-6);
    EXPECT_LT((contacts.contacts[1].wrench.force - Eigen::Vector3d(0, 0, 0.2)).norm(), 1e-6);
    EXPECT_EQ(observer->executor(0)->counters().steps, 30);
    EXPECT_EQ(finger->executor(0)->counters().steps, 300);
    EXPECT_EQ(observer->executor(1), nullptr);
  }
}

TEST_F(LearnedComponents, APayloadThatIsGivenGoesOverTheCards) {
  const auto observer = make("ft_rnnob", ", payload: {mass: 1}");
  sensing::ContactSet contacts;
  static_cast<void>(observer->update(signals(), contacts));
  ASSERT_EQ(contacts.count, 1);
  EXPECT_NEAR(contacts.contacts[0].wrench.force.z(), 9.81, 1e-6);
}

TEST_F(LearnedComponents, ACardWithoutPayloadLeavesItToTheNetwork) {
  observer_.payload.reset();
  write();
  const auto observer = make("ft_rnnob");
  sensing::ContactSet contacts;
  static_cast<void>(observer->update(signals(), contacts));
  ASSERT_EQ(contacts.count, 1);
  EXPECT_NEAR(contacts.contacts[0].wrench.force.z(), 2 * 9.81, 1e-6);
  EXPECT_THAT(complaint("ft_rnnob", ", fallback: newton_euler"),
              HasSubstr("fallback: needs a payload"));
  EXPECT_THAT(complaint("ft_rnnob", ", payload: {mass: 1}"),
              HasSubstr("payload: is used only by a fallback"));
  EXPECT_EQ(complaint("ft_rnnob", ", payload: {mass: 1}, fallback: newton_euler"), "");
}

TEST_F(LearnedComponents, MistakesAreNamed) {
  EXPECT_THAT(complaint("ft_rnnob", ", executor: gpu"), HasSubstr("torch, compiled"));
  EXPECT_THAT(complaint("biotac_lstm", ", localisation: best"), HasSubstr("inverted_gaussian"));
  EXPECT_THAT(complaint("biotac_lstm", ", wait_us: -1"), HasSubstr("wait_us"));
  observer_.rate = 300;
  finger_.average = 0.1;
  write();
  EXPECT_THAT(complaint("ft_rnnob"), HasSubstr("rate: 300"));
  EXPECT_THAT(complaint("biotac_lstm"), HasSubstr("averaged counts"));
  observer_.rate = 100;
  observer_.delays[0].stream = "camera";
  write();
  EXPECT_THAT(complaint("ft_rnnob"), HasSubstr("'camera'; known: inertial, force_torque"));
  observer_.delays.clear();
  observer_.inputs[1].name = "speed";
  write();
  EXPECT_THAT(complaint("ft_rnnob"), HasSubstr("takes an input 'speed'; known: orientation_x"));
}

}  // namespace
}  // namespace palpate::registry

#endif
