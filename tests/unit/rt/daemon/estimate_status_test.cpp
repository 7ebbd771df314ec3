// ESTIMATE carries the condition of the estimation slot, whatever the model's last step did.

#include <gtest/gtest.h>

#include <algorithm>
#include <palpate/estimate_t.hpp>
#include <palpate/robot_state_t.hpp>

#include "core/math/rigid.hpp"
#include "rt/bus/text.hpp"
#include "rt/daemon/daemon.hpp"

namespace palpate::daemon {
namespace {

constexpr std::int64_t kMillisecond = 1'000'000;
constexpr int kOk = 0, kDegraded = 1, kFault = 2;  // estimate_t.status

class EstimateStatus : public ::testing::Test {
 protected:
  EstimateStatus()
      : estimates_(*outside_, "ESTIMATE", 4),
        daemon_(config::Node::load_file(PALPATE_SOURCE_DIR "/rt/config/examples/bar_long_soft.yaml",
                                        {"object.mesh={box: {size: [0.5, 0.06, 0.06], cells: [10, "
                                         "1, 1]}}"}),
                *inside_, *inside_, Mode::kDeterministic, 1) {}

  /// Cycles of a millisecond; the robot reports the pose of the grasp at rest, or nothing.
  int status_after(int cycles, bool robot_reports) {
    estimate_t estimate{};
    for (int i = 0; i < cycles; ++i) {
      now_ns_ += kMillisecond;
      bus::set_time(*hub_, now_ns_);
      if (robot_reports) publish_robot();
      daemon_.tick({now_ns_, now_ns_ / 1000, 0});
      std::int64_t arrival_ns = 0;
      while (estimates_.take(estimate, arrival_ns)) {
      }
    }
    return estimate.status;
  }

  void publish_robot() {
    const registry::Frames& frames = daemon_.pipeline().frames();
    const math::Pose X_WE =
        frames.X_WO * daemon_.pipeline().object().body.grasps[0].X_OG_rest * frames.X_EG.inverse();
    robot_state_t state{};
    state.session = 1;
    state.seq = ++seq_;
    state.utime = now_ns_ / 1000;
    state.joint_count = 7;
    std::copy_n(X_WE.translation().data(), 3, state.position);
    math::wxyz_from_rotation(X_WE.linear(), state.quaternion);
    bus::TypedPublisher<robot_state_t>(*outside_, "ROBOT_STATE").publish(state);
  }

  void start() {
    component_command_t command{};
    command.session = 3;
    command.counter = 1;
    bus::put_text(command.slot, "all");
    bus::put_text(command.event, "start");
    bus::TypedPublisher<component_command_t>(*outside_, "COMPONENT_COMMAND").publish(command);
  }

  std::shared_ptr<bus::MemoryHub> hub_ = bus::make_memory_hub();
  std::unique_ptr<bus::MessageBus> outside_ = bus::make_memory_bus(hub_);
  std::unique_ptr<bus::MessageBus> inside_ = bus::make_memory_bus(hub_);
  bus::TypedSubscription<estimate_t> estimates_;
  Daemon daemon_;
  std::int64_t now_ns_ = 1'000'000'000;
  std::int32_t seq_ = 0;
};

TEST_F(EstimateStatus, IsThatOfTheEstimatorAndNotOfTheStep) {
  EXPECT_EQ(status_after(10, false), kFault) << "nothing is estimated before the start";
  start();
  EXPECT_EQ(status_after(200, false), kDegraded) << "the robot has not reported a pose yet";
  EXPECT_EQ(daemon_.pipeline().estimate().step.status, elasticity::StepStatus::kConverged)
      << "the model itself is at rest";
  EXPECT_EQ(status_after(200, true), kOk);
  EXPECT_EQ(status_after(1000, false), kDegraded) << "the pose is stale";
}

}  // namespace
}  // namespace palpate::daemon
