// WRENCH_COMPENSATED, of a daemon with and without an object.
#include "rt/daemon/wrench_telemetry.hpp"

#include <gtest/gtest.h>

#include <palpate/component_command_t.hpp>
#include <palpate/component_event_t.hpp>
#include <palpate/ft_wrench_t.hpp>
#include <palpate/robot_state_t.hpp>
#include <set>

#include "rt/bus/text.hpp"
#include "rt/daemon/daemon.hpp"

namespace palpate::daemon {
namespace {

const std::string kExamples = PALPATE_SOURCE_DIR "/rt/config/examples/";

class CompensatedWrench : public ::testing::Test {
 protected:
  void run(const std::string& example, const std::vector<std::string>& overrides = {}) {
    bus::record(*hub_, &published_);
    daemon_ = std::make_unique<Daemon>(config::Node::load_file(kExamples + example, overrides),
                                       *inside_, *inside_, Mode::kDeterministic, 5);
  }

  /// Cycles of a millisecond, in which both arms report the identity as pose of the flange and, at
  /// the wrist, their hand's weight and `contact`.
  void cycle(int cycles, const math::Wrench* contact, int arms = 1) {
    for (int i = 0; i < cycles; ++i) {
      now_ns_ += 1'000'000;
      bus::set_time(*hub_, now_ns_);
      ++seq_;
      for (int arm = 0; arm < arms; ++arm) {
        robot_state_t robot{};
        put_header(robot);
        robot.joint_count = 7;
        robot.quaternion[0] = 1;
        bus::TypedPublisher<robot_state_t>(*outside_, channel::of_arm("ROBOT_STATE", arm))
            .publish(robot);
        if (contact == nullptr) continue;
        ft_wrench_t reading{};
        put_header(reading);
        const Eigen::Vector3d weight(0, 0, kMass * 9.81), centre(0.0015, -0.00065, 0.1137);
        math::Vector6d sum = contact->vector();
        sum.head<3>() += weight;
        sum.tail<3>() += centre.cross(weight);
        std::copy_n(sum.data(), 6, reading.wrench);
        bus::TypedPublisher<ft_wrench_t>(*outside_, channel::of_arm("FT_WRENCH", arm))
            .publish(reading);
      }
      daemon_->tick({now_ns_, now_ns_ / 1000, 0});
    }
  }

  template <class Message>
  void put_header(Message& message) const {
    message.utime = now_ns_ / 1000 - 700;  // of the sender's clock
    message.session = 1;
    message.seq = seq_;
  }

  template <class Message>
  Message last(const std::string& channel) const {
    Message message{};
    for (const bus::Published& one : published_)
      if (one.channel == channel)
        message.decode(one.data.data(), 0, static_cast<int>(one.data.size()));
    return message;
  }

  static constexpr double kMass = 4.8;  // kg, as in wrench.yaml
  std::shared_ptr<bus::MemoryHub> hub_ = bus::make_memory_hub();
  std::unique_ptr<bus::MessageBus> inside_ = bus::make_memory_bus(hub_),
                                   outside_ = bus::make_memory_bus(hub_);
  std::vector<bus::Published> published_;
  std::unique_ptr<Daemon> daemon_;
  std::int64_t now_ns_ = 1'000'000'000;
  int seq_ = 0;
};

TEST_F(CompensatedWrench, IsTheContactInSAndAtTheGrasp) {
  run("wrench.yaml", {"sensing.0.tare_at_start=false"});
  const math::Wrench contact{{1, 2, 3}, {0, 0, 0}};
  cycle(3, &contact);
  const auto message = last<compensated_wrench_t>("WRENCH_COMPENSATED");
  EXPECT_EQ(message.seq, 3);
  EXPECT_EQ(message.session, 5);
  EXPECT_EQ(message.utime, now_ns_ / 1000);
  EXPECT_EQ(message.reading_utime, now_ns_ / 1000 - 700);
  EXPECT_EQ(message.age, 0);
  EXPECT_EQ(message.status, compensated_wrench_t::STATUS_OK) << bus::get_text(message.reason);
  ASSERT_EQ(message.valid, 1);
  // S lies 0.26 m behind G along z of E; x, y, z of G are -z, -y, -x of E.
  const double in_S[] = {1, 2, 3, 0, 0, 0}, at_G[] = {-3, -2, -1, 0, 0.26, -0.52};
  const double far = std::hypot(0.01, 0.1 * 0.26);
  const double deviation_G[] = {0.1, 0.1, 0.1, 0.01, far, far};
  for (int i = 0; i < 6; ++i) {
    EXPECT_NEAR(message.wrench_s[i], in_S[i], 1e-9) << i;
    EXPECT_NEAR(message.wrench_g[i], at_G[i], 1e-9) << i;
    EXPECT_NEAR(message.deviation_s[i], i < 3 ? 0.1 : 0.01, 1e-12) << i;
    EXPECT_NEAR(message.deviation_g[i], deviation_G[i], 1e-12) << i;
  }
}

TEST_F(CompensatedWrench, IsInvalidWithItsReasonWhileTaringAndWithoutReadings) {
  run("wrench.yaml", {"inputs.frozen_after_ms.force_torque=0"});
  cycle(1, nullptr);
  auto message = last<compensated_wrench_t>("WRENCH_COMPENSATED");
  EXPECT_EQ(message.valid, 0);
  EXPECT_EQ(message.status, compensated_wrench_t::STATUS_DEGRADED);
  EXPECT_STREQ(bus::get_text(message.reason), "no force-torque reading yet");
  EXPECT_EQ(message.reading_utime, 0);
  EXPECT_LT(message.age, 0);
  EXPECT_LT(message.deviation_g[3], 0);

  const math::Wrench none;
  cycle(10, &none);
  EXPECT_STREQ(bus::get_text(last<compensated_wrench_t>("WRENCH_COMPENSATED").reason), "taring");
  cycle(600, &none);
  EXPECT_EQ(last<compensated_wrench_t>("WRENCH_COMPENSATED").valid, 1);
  cycle(40, nullptr);
  message = last<compensated_wrench_t>("WRENCH_COMPENSATED");
  EXPECT_EQ(message.valid, 0);
  EXPECT_EQ(message.wrench_s[0], 0);
  EXPECT_NEAR(message.age, 0.040, 1e-9);
}

TEST_F(CompensatedWrench, WithoutAnObjectNothingElseIsEstimatedOrCommanded) {
  run("wrench.yaml");
  component_command_t command{};
  command.session = 3;
  command.counter = 1;
  bus::put_text(command.slot, "all");
  bus::put_text(command.event, "start");
  bus::TypedPublisher<component_command_t>(*outside_, "COMPONENT_COMMAND").publish(command);
  const math::Wrench none;
  cycle(1200, &none);
  daemon_->finish({now_ns_, now_ns_ / 1000, 0});
  std::set<std::string> channels;
  for (const bus::Published& one : published_) channels.insert(one.channel);
  for (const char* own : {"COMPONENT_COMMAND", "ROBOT_STATE", "FT_WRENCH"}) channels.erase(own);
  EXPECT_EQ(channels,
            (std::set<std::string>{"WRENCH_COMPENSATED", "HEALTH", "CONFIG", "COMPONENT_EVENT"}));
  EXPECT_FALSE(daemon_->pipeline().is_running());
  EXPECT_NE(std::string(daemon_->pipeline().condition().reason).find("only senses"),
            std::string::npos);
  const double value[3] = {};
  const char* reason = "";
  EXPECT_FALSE(daemon_->pipeline().set_target(1, "point", nullptr, 0, value, 3, reason));
  EXPECT_STRNE(reason, "");
}

TEST_F(CompensatedWrench, SensorModelsAreReplacedWithoutAnObject) {
  run("wrench.yaml", {"sensing.0.tare_at_start=false", "loop.replace_delay=5"});
  const math::Wrench contact{{1, 2, 3}, {0, 0, 0}};
  component_command_t command{};
  command.session = 3;
  command.counter = 1;
  bus::put_text(command.slot, "sensing");
  bus::put_text(command.event, "replace");
  bus::put_text(command.parameters, "{force_deviation: 0.5}");
  bus::TypedPublisher<component_command_t>(*outside_, "COMPONENT_COMMAND").publish(command);
  cycle(300, &contact);
  EXPECT_STREQ(bus::get_text(last<component_event_t>("COMPONENT_EVENT").event), "replaced")
      << bus::get_text(last<component_event_t>("COMPONENT_EVENT").reason);
  EXPECT_EQ(last<compensated_wrench_t>("WRENCH_COMPENSATED").deviation_s[0], 0.5);

  command.counter = 2;
  bus::put_text(command.slot, "all");
  bus::put_text(command.parameters, "{feature: {component: point}}");
  bus::TypedPublisher<component_command_t>(*outside_, "COMPONENT_COMMAND").publish(command);
  cycle(300, &contact);
  EXPECT_STREQ(bus::get_text(last<component_event_t>("COMPONENT_EVENT").event), "refused");
}

TEST_F(CompensatedWrench, GoesAndComesByTheConfiguredNamesOfChannels) {
  run("wrench.yaml", {"sensing.0.tare_at_start=false",
                      "bus.channels={FT_WRENCH: LEFT_FT, WRENCH_COMPENSATED: LEFT_CONTACT}"});
  outside_->set_channel_names({{"FT_WRENCH", "LEFT_FT"}});
  const math::Wrench contact{{1, 2, 3}, {0, 0, 0}};
  cycle(3, &contact);
  EXPECT_EQ(last<compensated_wrench_t>("LEFT_CONTACT").valid, 1);
  EXPECT_EQ(last<compensated_wrench_t>("WRENCH_COMPENSATED").valid, 0);
  EXPECT_STREQ(daemon_->inputs().report(0).name, "FT_WRENCH");
  EXPECT_EQ(daemon_->inputs().report(0).received, 3);
}

TEST_F(CompensatedWrench, OfBothArmsTogetherWithTheEstimate) {
  run("bar_two_hands.yaml");
  const math::Wrench contact{{1, 2, 3}, {0, 0, 0}};
  cycle(2, &contact, 2);
  EXPECT_GT(last<compensated_wrench_t>("WRENCH_COMPENSATED").age, -1);
  EXPECT_EQ(last<compensated_wrench_t>("WRENCH_COMPENSATED_1").seq, 2);
  EXPECT_TRUE(std::any_of(published_.begin(), published_.end(),
                          [](const bus::Published& one) { return one.channel == "CONTACTS"; }));
}

TEST(SensesOnly, APartOfAnObjectNeedsTheRest) {
  const auto error_of = [](const std::vector<std::string>& overrides) -> std::string {
    try {
      pipeline::Pipeline(config::Node::load_file(kExamples + "wrench.yaml", overrides), 1e-3);
    } catch (const config::Error& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(error_of({}), "");
  EXPECT_NE(error_of({"contact=[{component: wrench_patch}]"}).find("object"), std::string::npos);
  EXPECT_NE(error_of({"sensing=~"}).find("object"), std::string::npos);
}

}  // namespace
}  // namespace palpate::daemon
