#include "rt/daemon/component_reports.hpp"

#include <gtest/gtest.h>

#include "rt/bus/text.hpp"
#include "tests/support/doubtful_estimator.hpp"
#include "tests/support/pipeline_cycles.hpp"

namespace palpate::daemon {
namespace {

/// A pipeline with one wrist sensor that has readings or none, and its reports.
class ComponentReportsTest : public ::testing::Test {
 protected:
  ComponentReportsTest() {
    bus_->start();
    pipeline_.start();
  }

  /// One cycle, a millisecond after the previous one.
  void cycle(bool has_readings) {
    sensing::Signals signals;
    if (has_readings) {
      signals.robot.freshness = signals.force_torque.freshness = Freshness::kNew;
      signals.inertial.freshness = Freshness::kNew;
      signals.robot.age = signals.force_torque.age = signals.inertial.age = 0;
      signals.force_torque.fresh_count = signals.inertial.fresh_count = 1;
    }
    pipeline_.sense(signals);
    serve();
  }

  void serve() {
    now_ns_ += 1'000'000;
    bus::record(*hub_, &published_);
    reports_.service(pipeline_, commands_, now_ns_, now_ns_ / 1000);
    bus::record(*hub_, nullptr);
  }

  std::vector<std::string> reported() {
    std::vector<std::string> texts;
    for (const bus::Published& message : published_) {
      component_event_t event{};
      event.decode(message.data.data(), 0, static_cast<int>(message.data.size()));
      texts.push_back(std::string(bus::get_text(event.slot)) + " " + bus::get_text(event.instance) +
                      " " + bus::get_text(event.component) + " " + bus::get_text(event.event));
    }
    published_.clear();
    return texts;
  }

  std::shared_ptr<bus::MemoryHub> hub_ = bus::make_memory_hub();
  std::unique_ptr<bus::MessageBus> bus_ = bus::make_memory_bus(hub_);
  pipeline::Pipeline pipeline_{
      config::Node::load_file(PALPATE_SOURCE_DIR "/rt/config/examples/bar_long_soft.yaml"), 1e-3};
  Commands commands_{*bus_, *bus_, 1};
  ComponentReports reports_{pipeline_};
  std::vector<bus::Published> published_;
  std::int64_t now_ns_ = 1'000'000'000;
};

TEST_F(ComponentReportsTest, NameTheComponentWhereItsStateChanges) {
  for (int i = 0; i < 300; ++i) cycle(false);
  EXPECT_EQ(reported(), std::vector<std::string>{"sensing wrist ft_newton_euler degraded"});
  for (int i = 0; i < 300; ++i) cycle(true);
  EXPECT_EQ(reported(), std::vector<std::string>{"sensing wrist ft_newton_euler active"});
}

TEST_F(ComponentReportsTest, AreNoFloodWhereAStateFlickers) {
  for (int i = 0; i < 2000; ++i) cycle(i % 2 == 0);
  const std::size_t count = reported().size();
  EXPECT_GE(count, 10u);
  EXPECT_LE(count, 20u);  // at 10 Hz
}

TEST_F(ComponentReportsTest, NameWhatControlDoesAboutADiscrepancy) {
  support::Doubt doubt;
  std::unique_ptr<estimation::Estimator>& slot = pipeline_.components_at_setup().estimator;
  slot = std::make_unique<support::DoubtfulEstimator>(std::move(slot), doubt);
  const sensing::Signals signals = support::at_rest(pipeline_);
  const auto run = [&](int cycles) {
    for (int i = 0; i < cycles; ++i) {
      support::run(pipeline_, signals, 1);
      serve();
    }
  };
  run(200);
  reported();
  doubt.report.is_inconsistent = true;
  run(200);
  EXPECT_EQ(reported(), std::vector<std::string>{"control   slowed"});
  doubt.report.is_inconsistent = false;
  run(200);
  EXPECT_EQ(reported(), std::vector<std::string>{"control   resumed"});
  doubt.report.is_inconsistent = true;
  run(200);
  pipeline_.stop();
  run(200);
  EXPECT_EQ(reported(), std::vector<std::string>{"control   slowed"}) << "a stop resumes nothing";
  pipeline_.start();
  for (int i = 0; i < 2000; ++i) {
    doubt.report.is_inconsistent = i % 2 == 0;
    run(1);
  }
  const std::size_t count = reported().size();
  EXPECT_GE(count, 10u);
  EXPECT_LE(count, 25u) << "no flood";
}

}  // namespace
}  // namespace palpate::daemon
