// Contacts from FINGERTIP_n, from the message to CONTACTS and the state of the daemon.

#include <gtest/gtest.h>

#include <palpate/contacts_t.hpp>
#include <palpate/fingertip_t.hpp>
#include <palpate/hand_state_t.hpp>
#include <palpate/robot_state_t.hpp>

#include "rt/daemon/daemon.hpp"

namespace palpate::daemon {
namespace {

class FingertipDaemon : public ::testing::Test {
 protected:
  void cycles(int count, bool finger_reports) {
    for (int i = 0; i < count; ++i) {
      now_ns_ += 1'000'000;
      bus::set_time(*hub_, now_ns_);
      ++seq_;
      robot_state_t robot{};
      robot.joint_count = 7;
      std::copy_n(X_WE_.translation().data(), 3, robot.position);
      math::wxyz_from_rotation(X_WE_.linear(), robot.quaternion);
      send("ROBOT_STATE", robot);
      hand_state_t hand{};
      hand.fingertip_count = 5;
      for (int finger = 0; finger < 5; ++finger) {
        std::copy_n(X_ET_.translation().data(), 3, hand.fingertip_position[finger]);
        math::wxyz_from_rotation(X_ET_.linear(), hand.fingertip_quaternion[finger]);
      }
      send("HAND_STATE", hand);
      for (int finger = 0; finger < 5 && finger_reports; ++finger) {
        fingertip_t tip{};
        tip.contact = finger == 1 ? 1 : 0;
        const double place[] = {0.001, -0.002, -0.007};
        std::copy_n(place, 3, tip.place);
        tip.normal[2] = -1;
        tip.force[0] = 0.1;
        tip.force[2] = -0.4;
        tip.place_deviation = tip.area = -1;
        tip.force_deviation = 0.07;
        send("FINGERTIP_" + std::to_string(finger), tip);
      }
      daemon_.tick({now_ns_, now_ns_ / 1000, 0});
    }
  }

  template <class Message>
  void send(const std::string& channel, Message message) {
    message.session = 4;
    message.seq = seq_;
    bus::TypedPublisher<Message>(*outside_, channel).publish(message);
  }

  contacts_t contacts() {
    contacts_t message{};
    std::int64_t arrival_ns = 0;
    while (contacts_.take(message, arrival_ns)) {
    }
    return message;
  }

  std::shared_ptr<bus::MemoryHub> hub_ = bus::make_memory_hub();
  std::unique_ptr<bus::MessageBus> inside_ = bus::make_memory_bus(hub_),
                                   outside_ = bus::make_memory_bus(hub_);
  bus::TypedSubscription<contacts_t> contacts_{*outside_, "CONTACTS", 4};
  Daemon daemon_{
      config::Node::load_file(PALPATE_SOURCE_DIR "/rt/config/examples/bar_soft_fingertip.yaml"),
      *inside_, *inside_, Mode::kDeterministic, 1};
  // The fingertip is above the bar's free end, its skin (-z of T) down.
  math::Pose X_WE_ = math::make_pose(math::exp_rotation({0, M_PI / 2, 0}), {0.6, 0, 0.4});
  math::Pose X_ET_ = X_WE_.inverse() * daemon_.pipeline().frames().X_WO *
                     math::make_pose(math::exp_rotation({0, 0, 0.3}), {0.19, 0.02, 0.047});
  std::int64_t now_ns_ = 1'000'000'000;
  int seq_ = 0;
};

TEST_F(FingertipDaemon, ContactIsInTheObjectsFrameAndItsSilenceDegrades) {
  cycles(5, true);
  EXPECT_STREQ(daemon_.pipeline().start(), "");
  cycles(20, true);
  EXPECT_EQ(daemon_.pipeline().condition().state, pipeline::LifeCycle::kActive)
      << daemon_.pipeline().condition().reason;
  const contacts_t message = contacts();
  ASSERT_EQ(message.count, 1);
  EXPECT_EQ(message.source[0], static_cast<int>(sensing::Source::kFinger1));
  const double c = std::cos(0.3), s = std::sin(0.3);
  const double place[] = {0.19 + 0.001 * c + 0.002 * s, 0.02 + 0.001 * s - 0.002 * c, 0.04};
  const double force[] = {0.1 * c, 0.1 * s, -0.4};
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(message.location[0][i], place[i], 1e-9) << i;
    EXPECT_NEAR(message.wrench[0][i], force[i], 1e-9) << i;
  }
  EXPECT_EQ(message.deviation[0], 0.07);

  cycles(60, false);
  EXPECT_EQ(contacts().count, 0);
  EXPECT_EQ(daemon_.pipeline().condition().state, pipeline::LifeCycle::kDegraded);
  EXPECT_STREQ(daemon_.pipeline().condition().reason, "tactile sample is too old");
  cycles(5, true);
  EXPECT_EQ(contacts().count, 1);
}

}  // namespace
}  // namespace palpate::daemon
