#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <thread>

#include "tests/unit/tools/bridge/ur/cell.hpp"
#include "tools/bridge/ur/ft300.hpp"
#include "tools/bridge/ur/modes.hpp"
#include "tools/bridge/ur/settings.hpp"

namespace palpate::ur_bridge {
namespace {

std::vector<math::Wrench> wrenches_in(const std::string& text, WrenchText& parser) {
  std::vector<math::Wrench> found;
  math::Wrench wrench;
  for (const char character : text)
    if (parser.take(character, wrench)) found.push_back(wrench);
  return found;
}

TEST(WrenchText, FindsReadings) {
  WrenchText parser;
  const auto found =
      wrenches_in("3 , 4)( 1.5 , -2 , 3e-1 , 0.1 , -0.2 , 0.3 )(1,2,3,4,5,6)\n(7,", parser);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].force, Eigen::Vector3d(1.5, -2, 0.3));
  EXPECT_EQ(found[0].torque, Eigen::Vector3d(0.1, -0.2, 0.3));
  EXPECT_EQ(found[1].torque[2], 6);
  EXPECT_EQ(parser.malformed(), 0);
}

TEST(WrenchText, RejectsOthers) {
  for (const char* text : {"(1,2,3,4,5)", "(1,2,3,4,5,6,7)", "(1,2,3,4,5,nan)", "(1,2,3,inf,5,6)",
                           "(1,2,x,4,5,6)", "()", "(1 2 3 4 5 6)", "(1,2,(", "(1,2,3,4,5,1e999)"}) {
    WrenchText parser;
    EXPECT_TRUE(wrenches_in(text, parser).empty()) << text;
    EXPECT_EQ(parser.malformed(), 1) << text;
  }
  WrenchText parser;
  EXPECT_TRUE(wrenches_in("(" + std::string(10'000, '1'), parser).empty());
  EXPECT_EQ(wrenches_in("(1,2,3,4,5,6)", parser).size(), 1u) << "the next one is found";
}

TEST(Modes, OnlyARunningArmWithoutAStopObeys) {
  EXPECT_EQ(halt_of(7, 1), nullptr);
  EXPECT_EQ(halt_of(7, 3), nullptr) << "reduced mode";
  for (int bit = 2; bit <= 10; ++bit) EXPECT_NE(halt_of(7, 1U << bit), nullptr) << bit;
  for (int mode = -1; mode <= 8; ++mode) EXPECT_EQ(halt_of(mode, 1) == nullptr, mode == 7) << mode;
  EXPECT_STREQ(halt_of(3, 1U << 6 | 1U << 7), "emergency stop of the robot");
}

TEST(Script, IsFilledIn) {
  const std::string text = text_of("tools/bridge/ur/follow_velocities.script");
  ScriptNumbers numbers;
  numbers.run = 12345;
  const std::string filled = fill_script(text, numbers);
  EXPECT_EQ(filled.find('$'), std::string::npos);
  EXPECT_EQ(filled.find('#'), std::string::npos);
  EXPECT_EQ(filled.rfind("def ", 0), 0u) << "a program begins with its definition";
  EXPECT_NE(filled.find("  run = 12345\n"), std::string::npos);
  EXPECT_NE(filled.find("most_missed = 0.040000000 / get_steptime()"), std::string::npos);
  EXPECT_THROW(fill_script("def f():\nend\n", numbers), std::invalid_argument);
  EXPECT_THROW(fill_script(text + "$OTHER", numbers), std::invalid_argument);
}

/// A server on the loopback address, by the sockets of the machine.
class Server {
 public:
  Server() : listener_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof(address);
    ::bind(listener_, reinterpret_cast<sockaddr*>(&address), size);
    ::getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size);
    ::listen(listener_, 1);
    port = ntohs(address.sin_port);
  }
  ~Server() { ::close(listener_), ::close(peer); }
  void accept() { peer = ::accept(listener_, nullptr, nullptr); }

  int port = 0, peer = -1;

 private:
  int listener_;
};

bool wait_for(const std::function<bool()>& condition) {
  for (int i = 0; i < 5000; ++i) {
    if (condition()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return false;
}

TEST(TcpStream, ConnectsReadsWritesAndSeesTheEnd) {
  Server server;
  const auto stream = bridge::make_tcp_stream("127.0.0.1", server.port);
  EXPECT_EQ(stream->state(), bridge::Stream::State::kClosed);
  stream->open();
  server.accept();
  ASSERT_TRUE(wait_for([&] { return stream->state() == bridge::Stream::State::kOpen; }));
  std::uint8_t byte = 0;
  EXPECT_EQ(stream->read(&byte, 1), 0) << "does not wait";
  ASSERT_EQ(::send(server.peer, "x", 1, 0), 1);
  ASSERT_TRUE(wait_for([&] { return stream->read(&byte, 1) == 1; }));
  EXPECT_EQ(byte, 'x');
  // A peer that reads nothing: the stream gives up instead of waiting or growing.
  const std::vector<std::uint8_t> much(16000);
  int written = 0;
  while (written < 10'000 && stream->write(much.data(), 16000)) ++written;
  EXPECT_GT(written, 0);
  EXPECT_LT(written, 10'000);
  EXPECT_EQ(stream->state(), bridge::Stream::State::kClosed);
  stream->open();
  ::close(server.peer);
  server.accept();
  ASSERT_TRUE(wait_for([&] { return stream->state() == bridge::Stream::State::kOpen; }));
  ::close(server.peer);
  EXPECT_TRUE(wait_for([&] {
    stream->read(&byte, 1);
    return stream->state() == bridge::Stream::State::kClosed;
  }));
}

TEST(TcpStream, ARefusedConnectionIsClosed) {
  int port = 0;
  {
    const Server server;
    port = server.port;
  }
  const auto stream = bridge::make_tcp_stream("127.0.0.1", port);
  stream->open();
  EXPECT_TRUE(wait_for([&] { return stream->state() == bridge::Stream::State::kClosed; }));
  EXPECT_THROW(bridge::make_tcp_stream("no such host.", 1), std::runtime_error);
}

TEST(Ft300, ReadsItsStreamAndConnectsAgain) {
  Server server;
  std::int64_t now_ns = 1'000'000'000;
  Ft300 sensor(bridge::make_tcp_stream("127.0.0.1", server.port), -1, [&] { return now_ns; });
  math::Wrench wrench;
  EXPECT_FALSE(sensor.take(wrench));
  server.accept();
  const std::string text = "( 1 , 2 , 3 , 4 , 5 , 6 )";
  ASSERT_GT(::send(server.peer, text.data(), text.size(), 0), 0);
  ASSERT_TRUE(wait_for([&] { return sensor.take(wrench); }));
  EXPECT_EQ(wrench.force, Eigen::Vector3d(-1, -2, -3));
  EXPECT_EQ(wrench.torque, Eigen::Vector3d(-4, -5, -6));
  now_ns += 3'000'000'000;  // silence
  EXPECT_FALSE(sensor.take(wrench));
  EXPECT_FALSE(sensor.take(wrench));
  ::close(server.peer);
  server.accept();
  ASSERT_GT(::send(server.peer, text.data(), text.size(), 0), 0);
  EXPECT_TRUE(wait_for([&] { return sensor.take(wrench); }));
}

const std::string kArm = "robot: {host: 127.0.0.1, urdf: " + std::string(PALPATE_SOURCE_DIR) +
                         "/tools/bridge/ur/examples/ur5e.urdf";

std::string ur_error_of(const std::string& text) {
  try {
    read_settings(config::Node::from_text(text));
  } catch (const config::Error& error) {
    return error.what();
  }
  return "";
}

TEST(UrSettings, HaveDefaults) {
  const Settings settings = read_settings(config::Node::from_text(kArm + "}"));
  EXPECT_EQ(settings.rtde_port, 30004);
  EXPECT_EQ(settings.arm.rate, 500);
  EXPECT_NEAR(settings.arm.numbers.most_speed, 0.5 * 3.14159 + 0.01, 1e-4);
  EXPECT_FALSE(settings.ft300);
  EXPECT_FALSE(settings.arm.wrench);
}

TEST(UrSettings, ErrorsNameTheKey) {
  const auto contains = [](const std::string& text, const char* part) {
    EXPECT_NE(ur_error_of(text).find(part), std::string::npos) << ur_error_of(text);
  };
  contains("robot: {urdf: a.urdf}", "robot.urdf");
  contains(kArm + ", rate: 300}", "robot.rate");
  contains(kArm + ", first_register: 43}", "robot.first_register");
  contains(kArm + ", deceleration: 4}", "robot.deceleration");
  contains(kArm + ", torque: constants}", "robot.torque_constants");
  contains(kArm + ", flange: forearm}", "allowed: 6");
  contains(kArm + "}\nwrench: {source: controller}", "wrench.payload");
  contains(kArm + "}\nwrench: {source: ft300, polarity: 0}", "wrench.polarity");
  EXPECT_EQ(ur_error_of(kArm + "}\nwrench: {source: ft300}"), "");
}

/// Every key is in the page.
TEST(UrSettings, AreDocumented) {
  const std::string page = text_of("docs/robots/ur.md");
  const config::DeclarationList list;
  read_settings(config::Node::from_text(
      kArm +
      ", torque: constants, torque_constants: [9, 9, 9, 9, 9, 9]}\nwrench: {source: ft300}"));
  read_settings(config::Node::from_text(kArm + "}\nwrench: {source: controller, payload: 1}"));
  EXPECT_GT(list.all().size(), 20u);
  for (const config::Declaration& key : list.all())
    EXPECT_NE(page.find("`" + key.name + "`"), std::string::npos) << key.path << key.name;
}

/// Pose of the flange at zero by the published parameters: the sums of their lengths.
TEST(ExampleArm, IsAUr5e) {
  kinematics::SerialChain::State state;
  Cell::chain().evaluate(driver::Joints::Zero(6), state);
  EXPECT_LT((state.X_WE.translation() - Eigen::Vector3d(-0.8172, -0.2329, 0.0628)).norm(), 1e-9);
}

}  // namespace
}  // namespace palpate::ur_bridge
