#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cmath>
#include <fstream>
#include <random>
#include <sstream>

#include "rt/config/declarations.hpp"
#include "tests/unit/tools/bridge/franka/cell.hpp"
#include "tools/bridge/franka/settings.hpp"

namespace palpate::franka_bridge {
namespace {

TEST(FrankaMessages, RequestsHaveTheSizesOfVersion10) {
  EXPECT_EQ(connect_request(7, 50000).size(), 16u);
  const std::vector<std::uint8_t> move = move_request(7);
  EXPECT_EQ(move.size(), 125u);
  const Header header = read_header(move.data());
  EXPECT_EQ(header.request, 1u);
  EXPECT_EQ(header.number, 7u);
  EXPECT_EQ(header.size, 125u);
  EXPECT_EQ(recovery_request(7).size(), 12u);
}

TEST(FrankaMessages, OnlyAnIdleOrMovingArmObeys) {
  for (int mode = 0; mode <= 6; ++mode)
    EXPECT_EQ(halt_of(static_cast<RobotMode>(mode)) == nullptr, mode == 1 || mode == 2) << mode;
}

/// From any speed and acceleration to any other speed: within the limits, and without overshoot.
TEST(FrankaFollower, ArrivesWithinItsLimits) {
  std::mt19937 random(1000);
  const auto uniform = [&random](double lower, double upper) {
    return std::uniform_real_distribution<double>(lower, upper)(random);
  };
  const Follower follower(fr3_limits());
  for (int draw = 0; draw < 300; ++draw) {
    RobotState state;
    state.q = {0, 0, 0, -1.5, 0, 2, 0};
    state.dq_d[0] = uniform(-1, 1);
    Seven wanted{};
    wanted[0] = uniform(-1, 1);
    const double change = std::abs(wanted[0] - state.dq_d[0]);
    const double direction = std::copysign(1, wanted[0] - state.dq_d[0]);
    const int needed = static_cast<int>(1e3 * (change / 9 + 9 / 4500.0)) + 5;
    for (int i = 0; i < needed; ++i) {
      const Seven next = follower.next(wanted, state);
      const double ddq = (next[0] - state.dq_d[0]) / 1e-3;
      ASSERT_LE(std::abs(ddq), 10);
      ASSERT_LE(std::abs(ddq - state.ddq_d[0]), 5);
      ASSERT_LT(direction * (next[0] - wanted[0]), 1e-3) << "overshoot";
      state.dq_d = next;
      state.ddq_d[0] = ddq;
    }
    EXPECT_NEAR(state.dq_d[0], wanted[0], 1e-9);
    EXPECT_NEAR(state.ddq_d[0], 0, 1e-5);
  }
}

TEST(FrankaFollower, AllJointsSlowDownWithTheOneNearItsEnd) {
  const Follower follower(fr3_limits());
  RobotState state;
  state.q = {0, 1.77, 0, -1.5, 0, 2, 0};  // 22 mrad before the end of joint 2
  const Seven wanted{0.2, 0.4, 0, 0, 0, 0, 0};
  const double most = std::sqrt(5.17 * 0.0218) - 0.20 - 0.02;
  for (int i = 0; i < 500; ++i) {
    const Seven next = follower.next(wanted, state);
    for (std::size_t j = 0; j < kJoints; ++j) state.ddq_d[j] = (next[j] - state.dq_d[j]) / 1e-3;
    state.dq_d = next;
  }
  EXPECT_NEAR(state.dq_d[1], most, 1e-6);
  EXPECT_NEAR(state.dq_d[0], most / 2, 1e-6);
}

/// By the sockets of the machine.
TEST(UdpDatagrams, TakesThoseOfItsHostAndAnswersThem) {
  const auto datagrams = make_udp_datagrams("127.0.0.1");
  const int peer = ::socket(AF_INET, SOCK_DGRAM, 0), stranger = ::socket(AF_INET, SOCK_DGRAM, 0);
  sockaddr_in other{};
  other.sin_family = AF_INET;
  other.sin_addr.s_addr = inet_addr("127.0.0.9");
  ASSERT_EQ(::bind(stranger, reinterpret_cast<const sockaddr*>(&other), sizeof(other)), 0);
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  to.sin_port = htons(datagrams->port());
  const auto send = [&](int socket, const char* text, std::size_t size) {
    return ::sendto(socket, text, size, 0, reinterpret_cast<const sockaddr*>(&to), sizeof(to));
  };
  std::array<std::uint8_t, 4> bytes{};
  EXPECT_EQ(datagrams->receive(bytes.data(), 4), -1) << "does not wait";
  datagrams->send(bytes.data(), 4);  // no peer yet
  ASSERT_EQ(send(stranger, "zz", 2), 2);
  ASSERT_EQ(send(peer, "abcdefg", 7), 7);
  datagrams->wait(std::numeric_limits<std::int64_t>::max() / 2);
  EXPECT_EQ(datagrams->receive(bytes.data(), 4), 7) << "the whole size";
  EXPECT_EQ(bytes[3], 'd');
  EXPECT_EQ(datagrams->receive(bytes.data(), 4), -1);
  datagrams->send(bytes.data(), 4);
  char answer[8] = {};
  EXPECT_EQ(::recv(peer, answer, sizeof(answer), 0), 4);
  ::close(peer);
  ::close(stranger);
  EXPECT_THROW(make_udp_datagrams("no such host."), std::runtime_error);
}

const std::string kArm = "robot: {host: 127.0.0.1, urdf: " + std::string(PALPATE_SOURCE_DIR) +
                         "/tools/bridge/franka/examples/fr3.urdf";

std::string franka_error_of(const std::string& text) {
  try {
    read_settings(config::Node::from_text(text));
  } catch (const config::Error& error) {
    return error.what();
  }
  return "";
}

TEST(FrankaSettings, HaveDefaults) {
  const Settings settings = read_settings(config::Node::from_text(kArm + "}"));
  EXPECT_EQ(settings.port, 1337);
  EXPECT_EQ(settings.stale, 0.05);
  EXPECT_EQ(settings.arm.torque, Franka::Torque::kMeasured);
  EXPECT_FALSE(settings.arm.recovers);
  EXPECT_FALSE(settings.arm.wrench);
}

TEST(FrankaSettings, ErrorsNameTheKey) {
  const auto contains = [](const std::string& text, const char* part) {
    EXPECT_NE(franka_error_of(text).find(part), std::string::npos) << franka_error_of(text);
  };
  contains("robot: {urdf: a.urdf}", "robot.urdf");
  contains(kArm + ", port: 0}", "robot.port");
  contains(kArm + ", torque: all}", "robot.torque");
  contains(kArm + ", flange: link5}", "allowed: 7");
  contains(kArm + "}\nwrench: {polarity: 1}", "wrench.payload");
  contains(kArm + "}\nwrench: {payload: 1, polarity: 0}", "wrench.polarity");
  contains(kArm + "}\nguard: {acceleration: 9}", "guard.acceleration");
  EXPECT_EQ(franka_error_of(kArm + "}\nwrench: {payload: 0.7}"), "");
}

/// Every key is in the page.
TEST(FrankaSettings, AreDocumented) {
  std::ifstream file(std::string(PALPATE_SOURCE_DIR) + "/docs/robots/franka.md");
  std::stringstream page;
  page << file.rdbuf();
  const config::DeclarationList list;
  read_settings(config::Node::from_text(kArm + "}\nwrench: {payload: 0.7}"));
  EXPECT_GT(list.all().size(), 15u);
  for (const config::Declaration& key : list.all())
    EXPECT_NE(page.str().find("`" + key.name + "`"), std::string::npos) << key.path << key.name;
}

/// Pose of the flange at zero by the published parameters: the sums of their lengths.
TEST(ExampleArm, IsAnFr3) {
  kinematics::SerialChain::State state;
  Cell::chain().evaluate(driver::Joints::Zero(kJoints), state);
  EXPECT_LT(
      (state.X_WE.translation() - Eigen::Vector3d(0.088, 0, 0.333 + 0.316 + 0.384 - 0.107)).norm(),
      1e-8);
}

}  // namespace
}  // namespace palpate::franka_bridge
