#include <gtest/gtest.h>

#include "tests/unit/tools/bridge/ros2/cell.hpp"

namespace palpate::ros2_bridge {
namespace {

using Result = JointSelection::Result;

/// Joint states as C++ has them.
struct States {
  std::vector<std::string> names;
  std::vector<double> q, dq, tau;

  Result read(JointSelection& selection, bridge::Reading& reading, const char*& reason) {
    std::vector<char*> texts;
    for (std::string& name : names) texts.push_back(name.data());
    JointState message{};
    refer(message.name, texts);
    refer(message.position, q);
    refer(message.velocity, dq);
    refer(message.effort, tau);
    return selection.read(message, reading, reason);
  }
};

class JointSelectionTest : public testing::Test {
 protected:
  JointSelectionTest() {
    for (Joints* numbers : {&reading.q, &reading.dq, &reading.tau}) numbers->setZero(2);
  }
  JointSelection selection{{"a", "b"}};
  bridge::Reading reading;
  const char* reason = "";
};

TEST_F(JointSelectionTest, FindsTheJointsInAnyOrderAmongOthers) {
  States states{{"x", "b", "a"}, {1, 2, 3}, {4, 5, 6}, {7, 8, 9}};
  ASSERT_EQ(states.read(selection, reading, reason), Result::kRead);
  EXPECT_EQ(reading.q, Eigen::Vector2d(3, 2));
  EXPECT_EQ(reading.dq, Eigen::Vector2d(6, 5));
  EXPECT_EQ(reading.tau, Eigen::Vector2d(9, 8));
  states = {{"a", "b"}, {1, 2}, {4, 5}, {}};
  ASSERT_EQ(states.read(selection, reading, reason), Result::kRead);
  EXPECT_EQ(reading.q, Eigen::Vector2d(1, 2));
  EXPECT_TRUE(reading.tau.isZero(0)) << "without efforts";
}

TEST_F(JointSelectionTest, LeavesOutOtherDevicesAndRefusesWhatIsIncomplete) {
  EXPECT_EQ((States{{"x"}, {1}, {1}, {}}.read(selection, reading, reason)), Result::kOthers);
  EXPECT_EQ((States{{}, {}, {}, {}}.read(selection, reading, reason)), Result::kOthers);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (States states :
       {States{{"a"}, {1}, {1}, {}}, States{{"a", "b"}, {1}, {1, 2}, {}},
        States{{"a", "b"}, {1, 2}, {}, {}}, States{{"a", "b"}, {1, 2}, {1, 2}, {1}},
        States{{"a", "b"}, {1, nan}, {1, 2}, {}}, States{{"a", "b"}, {1, 2}, {nan, 2}, {}},
        States{{"a", "b"}, {1, 2, 3}, {1, 2}, {}}}) {
    reason = "";
    EXPECT_EQ(states.read(selection, reading, reason), Result::kRefused);
    EXPECT_STRNE(reason, "");
  }
}

TEST(JointStateArm, FollowsPalpatedAndReportsItsState) {
  Cell cell;
  cell.rest();
  cell.run(260);
  EXPECT_EQ(cell.node.received, 0);
  const driver::Joints before = cell.node.q();
  cell.move(0.1);
  cell.run(500);
  EXPECT_GT((cell.node.q() - before).minCoeff(), 0.03);
  EXPECT_NEAR(cell.state.q[2], cell.node.q()[2], 1e-3);
  EXPECT_NEAR(cell.state.dq[2], 0.1, 1e-6);
  EXPECT_GT(cell.states, 350);
  EXPECT_GT(cell.node.received, 400) << "one command a cycle";
}

TEST(JointStateArm, SendsZeroAtItsEnd) {
  Cell resting;
  resting.rest();
  resting.run(260);
  resting.arm.reset();
  resting.node.step(resting.now_ns);
  EXPECT_EQ(resting.node.received, 0) << "nothing has been commanded";
  Cell moving;
  moving.rest();
  moving.run(260);
  moving.move(0.2);
  moving.run(200);
  ASSERT_GT(moving.node.speed(), 0.1);
  moving.arm.reset();
  moving.node.step(moving.now_ns);
  EXPECT_EQ(moving.node.speed(), 0);
}

TEST(JointStateArm, OtherClocksAreAcceptedByTheTimeOfReception) {
  Clock clock;
  clock.is_sender = false;
  Cell cell(Cell::bent(), clock);
  cell.node.age_ns = 800'000'000;
  cell.rest();
  cell.run(260);
  cell.move(0.2);
  cell.run(200);
  EXPECT_GT(cell.node.speed(), 0.1);
}

TEST(JointStateArm, CommandsTheTwistOfTheFlange) {
  JointStateArm::Options options;
  options.states = "twist_states";
  options.commands = "twists";
  options.kind = JointStateArm::Commands::kTwist;
  options.frame = "world";
  options.now_ns = [] { return std::int64_t{0}; };
  options.wall_clock = [] { return std::int64_t{5'000'000}; };
  const kinematics::SerialChain& chain = Cell::chain();
  JointStateArm arm(ours(), chain, options);
  Writer<JointState> states(theirs(), {"twist_states", Quality::kReliable});
  Reader<TwistStamped> twists(theirs(), {"twists", Quality::kReliable});

  std::vector<std::string> names;
  std::vector<char*> texts;
  for (int i = 0; i < chain.joint_count(); ++i) names.push_back(chain.joint(i).name);
  for (std::string& name : names) texts.push_back(name.data());
  driver::Joints q = Cell::bent(), dq(q.size());
  for (Eigen::Index i = 0; i < q.size(); ++i) dq[i] = 0.1 * static_cast<double>(i) - 0.2;
  std::vector<double> positions(q.data(), q.data() + q.size()), velocities(names.size(), 0);
  std::string frame;
  JointState state{};
  state.header = {stamp_of(5'000'000), frame.data()};
  refer(state.name, texts);
  refer(state.position, positions);
  refer(state.velocity, velocities);
  states.write(state);
  bridge::Reading reading;
  for (Joints* numbers : {&reading.q, &reading.dq, &reading.tau}) numbers->setZero(q.size());
  ASSERT_TRUE(arm.take(reading));
  EXPECT_EQ(reading.utime, 5'000'000);
  arm.send(dq, 6'000'001);

  const TwistStamped* const twist = twists.next();
  ASSERT_NE(twist, nullptr);
  kinematics::SerialChain::State pose;
  chain.evaluate(q, pose);
  const math::Vector6d V = pose.J_W_E * dq;
  EXPECT_DOUBLE_EQ(twist->twist.linear.x, V[0]);
  EXPECT_DOUBLE_EQ(twist->twist.linear.z, V[2]);
  EXPECT_DOUBLE_EQ(twist->twist.angular.y, V[4]);
  EXPECT_STREQ(twist->header.frame_id, "world");
  EXPECT_EQ(twist->header.stamp.sec, 6);
  EXPECT_EQ(twist->header.stamp.nanosec, 1000u);
}

}  // namespace
}  // namespace palpate::ros2_bridge
