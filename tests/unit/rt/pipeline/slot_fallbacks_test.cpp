// Fallbacks of sensor models, contacts and features.

#include <gtest/gtest.h>

#include "rt/pipeline/pipeline.hpp"
#include "tests/support/faulty_slots.hpp"
#include "tests/support/pipeline_cycles.hpp"

namespace palpate::pipeline {
namespace {

config::Node fallback_example(const std::vector<std::string>& overrides) {
  return config::Node::load_file(PALPATE_SOURCE_DIR "/rt/config/examples/bar_long_soft.yaml",
                                 overrides);
}

std::string complaint(const std::string& override) {
  try {
    const config::Node root = fallback_example({override});
    const Pipeline pipeline(root, 1e-3);
    for (const char* slot : {"sensing", "contact"})
      for (const config::Node& node : root.list(slot)) node.check_all_used();
  } catch (const config::Error& error) {
    return error.what();
  }
  return "";
}

/// Outputs one contact and a configurable status.
struct Scripted final : sensing::SensorModel {
  explicit Scripted(const bool& b) : broken(b) {}
  UpdateResult update(const sensing::Signals&, sensing::ContactSet& contacts) noexcept override {
    sensing::Contact contact;
    contact.source = sensing::Source::kWrist0;
    contact.wrench.force.x() = 0.1;
    contacts.push(contact);
    return broken ? UpdateResult{Status::kFault, "broken"} : UpdateResult{};
  }
  const bool& broken;
};

class SlotFallbacks : public ::testing::Test {
 protected:
  void build(const std::vector<std::string>& overrides) {
    std::vector<std::string> all = {
        "object.mesh={box: {size: [0.5, 0.06, 0.06], cells: [6, 1, 1]}}", "object.order=linear"};
    all.insert(all.end(), overrides.begin(), overrides.end());
    pipeline_ = std::make_unique<Pipeline>(fallback_example(all), 1e-3);
    ComponentSet& components = pipeline_->components_at_setup();
    // A sensor that always reports a contact.
    std::unique_ptr<sensing::SensorModel> sound = std::make_unique<Scripted>(never_);
    if (components.sensing[0].fallback == nullptr) components.sensing[0].model.swap(sound);
    signals_ = support::at_rest(*pipeline_);
  }
  void start() {
    pipeline_->start();
    run(30);
    Eigen::VectorXd target = pipeline_->feature_state().value;
    target[2] += 0.03;
    const char* reason = "";
    ASSERT_TRUE(pipeline_->set_target(1, "point", nullptr, 0, target.data(), 3, reason)) << reason;
    run(100);
    ASSERT_EQ(pipeline_->condition().state, LifeCycle::kActive) << pipeline_->condition().reason;
    ASSERT_GT(speed(), 0.005);
  }
  void run(int cycles) {
    for (int i = 0; i < cycles; ++i) {
      support::run(*pipeline_, signals_, 1);
      EXPECT_TRUE(pipeline_->feature_state().value.allFinite());
      EXPECT_TRUE(pipeline_->model().positions().allFinite());
    }
  }
  double speed() const { return pipeline_->gate_output(0).V_W_E.linear.norm(); }

  /// Takes over in the same cycle, reported, until a reset.
  void expect_fallback(const std::string& who) {
    const double before = speed();
    broken_ = true;
    run(1);
    EXPECT_TRUE(pipeline_->on_fallback());
    EXPECT_GT(speed(), 0.9 * before);
    EXPECT_EQ(pipeline_->fallbacks_taken(), 1);
    EXPECT_EQ(pipeline_->condition().state, LifeCycle::kDegraded);
    EXPECT_EQ(std::string(pipeline_->fallback_reason()).rfind(who + ": fallback, since ", 0), 0u)
        << pipeline_->fallback_reason();
    run(200);
    EXPECT_EQ(pipeline_->fallbacks_taken(), 1);
    EXPECT_GT(speed(), 0.002);
    broken_ = false;
    run(10);
    EXPECT_TRUE(pipeline_->on_fallback()) << "until a reset";
    pipeline_->reset();
    EXPECT_FALSE(pipeline_->on_fallback());
    start();
    broken_ = true;
    run(1);
    EXPECT_EQ(pipeline_->fallbacks_taken(), 2);
  }
  /// Without one the pipeline stops, and all its output stays finite.
  void expect_fault(const std::string& reason) {
    broken_ = true;
    run(1);
    EXPECT_EQ(pipeline_->condition().state, LifeCycle::kFaulted);
    EXPECT_NE(std::string(pipeline_->condition().reason).find(reason), std::string::npos)
        << pipeline_->condition().reason;
    run(110);
    EXPECT_EQ(speed(), 0);
    broken_ = false;
    run(10);
    EXPECT_EQ(pipeline_->condition().state, LifeCycle::kFaulted) << "until a reset";
    pipeline_->reset();
    start();
  }
  void put_in_faulty_transformer() {
    auto faulty = std::make_unique<support::FaultyTransformer>(broken_);
    auto& its_good = faulty->good;
    ComponentSet::Contact& contact = pipeline_->components_at_setup().contact[0];
    std::unique_ptr<contact::ForceTransformer> present = std::move(faulty);
    contact.fallback != nullptr ? contact.fallback->exchange(present)
                                : contact.transformer.swap(present);
    its_good = std::move(present);
  }
  void put_in_faulty_feature() {
    auto faulty = std::make_unique<support::FaultyFeature>(broken_);
    ComponentSet& components = pipeline_->components_at_setup();
    faulty->good = std::move(components.feature);
    components.feature = std::move(faulty);
  }

  const bool never_ = false;
  bool broken_ = false;
  sensing::Signals signals_;
  std::unique_ptr<Pipeline> pipeline_;
};

TEST_F(SlotFallbacks, OfASensorModelCommandsInTheSameCycle) {
  build({"sensing.0.fallback={component: ft_tare_only}"});
  ComponentSet::Sensing& wrist = pipeline_->components_at_setup().sensing[0];
  std::unique_ptr<sensing::SensorModel> first = std::make_unique<Scripted>(broken_),
                                        second = std::make_unique<Scripted>(never_);
  auto pair =
      std::make_unique<registry::SensorFallback>(std::move(first), std::move(second), nullptr);
  ASSERT_NE(wrist.fallback, nullptr);
  wrist.fallback = pair.get();
  wrist.model = std::move(pair);
  start();
  expect_fallback("wrist");
}

TEST_F(SlotFallbacks, OfAContactCommandsInTheSameCycle) {
  build({"contact.0.fallback={component: area_coordinates}"});
  put_in_faulty_transformer();
  start();
  expect_fallback("grasp");
}

TEST_F(SlotFallbacks, OfAFeatureCommandsInTheSameCycle) {
  build(
      {"feature.fallback={component: point, rest_points: [[0.25, 0.03, 0.06]], components: [2]}"});
  put_in_faulty_feature();
  start();
  expect_fallback("feature");
}

TEST_F(SlotFallbacks, WithoutOneAContactThatIsNotFiniteIsAFault) {
  build({});
  put_in_faulty_transformer();
  start();
  expect_fault("a load of a node is not finite");
}

TEST_F(SlotFallbacks, WithoutOneAFeatureThatIsNotFiniteIsAFault) {
  build({});
  put_in_faulty_feature();
  start();
  expect_fault("the feature is not finite");
}

TEST(SlotFallbackConfiguration, WhatDoesNotFitIsNamed) {
  const auto expect_complaint = [](const std::string& override, const std::string& words) {
    const std::string text = complaint(override);
    EXPECT_NE(text.find(words), std::string::npos) << override << ": " << text;
    EXPECT_NE(text.find("fallback"), std::string::npos) << text;
  };
  expect_complaint(
      "sensing.0.fallback={component: biotac_linear, finger: 1, model_file: none.yaml}",
      "biotac_linear is of finger 1, ft_newton_euler of the wrist of arm 0");
  expect_complaint("sensing.0.fallback={component: manual}", "manual is of");
  expect_complaint("sensing=[{component: manual, fallback: {component: ft_tare_only}}]",
                   "manual forces cannot have a fallback");
  expect_complaint("sensing.0.fallback={component: ft_tare_only, name: other}", "name");
  expect_complaint("sensing.0.fallback={component: ft_magic}", "ft_magic");
  expect_complaint("contact.0.fallback={component: wrench_patch, on_grasp: true}",
                   "is the same as the component that it replaces");
  expect_complaint("contact.0.fallback={component: area_coordinates, sources: wrist}", "sources");
  expect_complaint(
      "feature.fallback={component: points, rest_points: [[0.25, 0.03, 0.06], [0, 0, 0]]}",
      "is a points, not a point");
  expect_complaint("feature.fallback={component: point, rest_points: [[0.2, 0.03, 0.06]]}",
                   "has other rest_points");
  expect_complaint("feature.fallback={component: point, rest_points: [[0.25, 0.03, 0.06]]}",
                   "is the same as the component that it replaces");
  EXPECT_EQ(complaint("sensing.0.fallback={component: ft_tare_only}"), "");
  EXPECT_EQ(complaint("contact.0.fallback={component: area_coordinates}"), "");
}

}  // namespace
}  // namespace palpate::pipeline
