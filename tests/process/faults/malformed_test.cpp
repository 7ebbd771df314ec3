// Invalid packets sent to a daemon in closed loop.

#include "tests/process/bus_udpm/injector.hpp"
#include "tests/process/faults/fault_process.hpp"
#include "tests/unit/rt/bus/messages.hpp"
#include "tools/lab/inject/packets.hpp"

namespace palpate {
namespace {

class Malformed : public FaultProcess {
 protected:
  std::vector<std::string> injection(int count, int rate,
                                     const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words = {kInjector,    "malformed",         "--url",
                                      control_url_, "--count",           std::to_string(count),
                                      "--rate",     std::to_string(rate)};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }

  struct Answer {
    bool any = false;
    std::int64_t dropped = 0;  // fragments
  };
  /// Answer of a daemon with that setting, within `seconds`, to a command in fragments as LCM on
  /// macOS sends it.
  Answer answer_to_fragments(const std::string& setting, double seconds) {
    ChildProcess daemon(patient_command({"--set", setting}));
    health_t before{};
    EXPECT_TRUE(wait_health([](const health_t& h) { return h.cycles > 200; }, before))
        << daemon.output();
    component_command_t command{};
    command.session = 43;
    command.counter = ++counter_;
    bus::put_text(command.slot, "all");
    bus::put_text(command.event, "zero");
    bus::wire::Injector injector(bus::parse_udpm_url(control_url_));
    constexpr int kAppleFragment = 1423;  // bytes
    const auto parts =
        bus::wire::in_parts("COMPONENT_COMMAND", 1, bus::wire::encoded(command), kAppleFragment);
    EXPECT_EQ(parts.size(), 2u);
    for (const auto& part : parts) EXPECT_TRUE(injector.send(part.data(), part.size()));
    component_event_t event{};
    Answer answer;
    answer.any = wait_event("zero", seconds, event);
    answer.dropped = health_now().fragmented - before.fragmented;
    return answer;
  }
};

/// PALPATE_PACKETS=1000000 for the long run, PALPATE_PACKET_RATE of them per second.
TEST_F(Malformed, PacketsLeaveTheLoopAlone) {
  const int count = amount("PALPATE_PACKETS", 20000);
  const int rate = amount("PALPATE_PACKET_RATE", 10000);
  ChildProcess daemon(patient_command());
  health_t health{};
  ASSERT_TRUE(wait_health([](const health_t& h) { return h.cycles > 200; }, health))
      << daemon.output();
  Robot robot(control_url_, true);
  ASSERT_TRUE(activate()) << daemon.output();
  send_target();
  watch_for(6);  // to the target

  const Seen quiet = watch_for(std::max(2.0, static_cast<double>(count) / rate));
  const health_t before = health_now();
  const double resident = resident_megabytes(daemon.pid());
  ChildProcess injector(injection(count, rate));
  const Seen attacked = watch([&] { return !injector.running(); });
  const double growth = resident_megabytes(daemon.pid()) - resident;
  ASSERT_EQ(injector.wait(milliseconds(0)), 0) << injector.output();
  ASSERT_TRUE(daemon.running()) << daemon.output();
  const health_t after = health_now();
  print("quiet", quiet);
  print("attacked", attacked);
  std::int64_t rejected = 0;
  for (int i = 0; i < after.input_count; ++i) rejected += after.rejected[i] - before.rejected[i];
  std::printf(
      "%s%lld malformed, %lld fragments, %lld unsubscribed, %lld wrong type or size on inputs; "
      "%lld "
      "lost in the socket; memory %+.2f MB\n",
      injector.output().c_str(), static_cast<long long>(after.malformed - before.malformed),
      static_cast<long long>(after.fragmented - before.fragmented),
      static_cast<long long>(after.unsubscribed - before.unsubscribed),
      static_cast<long long>(rejected),
      static_cast<long long>(after.overflowed - before.overflowed), growth);

  EXPECT_TRUE(after.state == 2 || after.state == 3) << bus::get_text(after.reason);
  // Every kind was received and counted; datagrams lost by the socket were never received.
  EXPECT_GT(after.malformed - before.malformed, 0);
  EXPECT_GT(after.fragmented - before.fragmented, 0);
  EXPECT_GT(after.unsubscribed - before.unsubscribed, 0);
  EXPECT_GT(rejected, 0);
  EXPECT_GE(after.datagrams - before.datagrams + after.overflowed - before.overflowed, count);
  EXPECT_EQ(attacked.not_finite, 0);
  EXPECT_LE(attacked.largest_speed, 1.001 * kSpeedLimit);
  EXPECT_LT(growth, 1.0);
  EXPECT_LE(after.allocations, 0);
  EXPECT_LE(attacked.rms_error, 2 * quiet.rms_error + 1e-3);
}

TEST_F(Malformed, WellFormedRubbishMovesNothingBeyondTheLimits) {
  ChildProcess daemon(patient_command());
  health_t health{};
  ASSERT_TRUE(wait_health([](const health_t& h) { return h.cycles > 200; }, health))
      << daemon.output();
  Robot robot(control_url_, true);
  ASSERT_TRUE(activate()) << daemon.output();
  send_target();
  watch_for(0.5);
  const double resident = resident_megabytes(daemon.pid());
  ChildProcess injector(injection(amount("PALPATE_PACKETS", 20000),
                                  amount("PALPATE_PACKET_RATE", 10000),
                                  {"--kind", "random_payload"}));
  const Seen attacked = watch([&] { return !injector.running(); });
  print("rubbish", attacked);
  ASSERT_TRUE(daemon.running()) << daemon.output();
  EXPECT_GT(attacked.commands, 0);
  EXPECT_EQ(attacked.not_finite, 0);
  EXPECT_LE(attacked.largest_speed, 1.001 * kSpeedLimit);
  EXPECT_LT(resident_megabytes(daemon.pid()) - resident, 1.0);
  daemon.send(SIGTERM);
  EXPECT_EQ(daemon.wait(milliseconds(10000)), 0) << daemon.output();
}

TEST_F(Malformed, AnotherTypeIsRefusedByName) {
  ChildProcess daemon(patient_command());
  health_t health{};
  ASSERT_TRUE(wait_health([](const health_t& h) { return h.cycles > 200; }, health))
      << daemon.output();
  imu_t wrong{};
  bus::TypedPublisher<imu_t> publisher(*control_, "FT_WRENCH");
  const auto began = Clock::now();
  publisher.publish(wrong);
  component_event_t event{};
  ASSERT_TRUE(wait_event("wrong type", 10, event));
  const double first = seconds_since(began);
  const std::string reason = bus::get_text(event.reason);
  const auto hexadecimal = [](std::int64_t number) {
    char text[20];
    std::snprintf(text, sizeof text, "0x%llx", static_cast<unsigned long long>(number));
    return std::string(text);
  };
  EXPECT_NE(reason.find("FT_WRENCH"), std::string::npos) << reason;
  EXPECT_NE(reason.find(hexadecimal(imu_t::getHash())), std::string::npos) << reason;
  EXPECT_NE(reason.find(hexadecimal(ft_wrench_t::getHash())), std::string::npos) << reason;
  // Many more in half a second: reported at most once a second.
  for (int i = 0; i < 500; ++i) {
    publisher.publish(wrong);
    std::this_thread::sleep_for(milliseconds(1));
  }
  int reports = 0;
  std::int64_t arrival_ns = 0;
  while (events_->take(event, arrival_ns))
    if (std::string(bus::get_text(event.event)) == "wrong type") ++reports;
  std::printf("reported after %.1f ms; %d more for 500 in %.2f s\n", 1e3 * first, reports,
              seconds_since(began));
  EXPECT_LE(reports, static_cast<int>(seconds_since(began)));
}

TEST_F(Malformed, FragmentsOfACommandAreJoined) {
  const Answer answer = answer_to_fragments("bus.largest_message=4000", 10);
  EXPECT_TRUE(answer.any);
  EXPECT_EQ(answer.dropped, 0);
}

TEST_F(Malformed, FragmentsOfACommandBeyondTheBoundAreCounted) {
  const Answer answer = answer_to_fragments("bus.largest_message=2000", 0.5);
  EXPECT_FALSE(answer.any);
  EXPECT_EQ(answer.dropped, 2);
}

/// The same packets sent to a program that receives through liblcm, kind by kind: how it
/// terminates.
TEST_F(Malformed, StockReceiverForComparison) {
  if (loop::kSanitized) GTEST_SKIP() << "a sanitizer reports what liblcm does";
  const std::string receiver = std::string(PALPATE_BIN_DIR) + "/stock_lcm_receiver";
  const std::string count = std::to_string(amount("PALPATE_STOCK_PACKETS", 500));
  int survived = 0;
  for (int i = 0; i < inject::kKinds; ++i) {
    const char* kind = inject::name(static_cast<inject::Kind>(i));
    ChildProcess stock({receiver, control_url_});
    const auto begin = Clock::now();
    while (stock.output().find("listens") == std::string::npos && seconds_since(begin) < 10)
      std::this_thread::sleep_for(milliseconds(5));
    ASSERT_NE(stock.output().find("listens"), std::string::npos) << stock.output();
    ChildProcess injector({kInjector, "malformed", "--url", control_url_, "--kind", kind, "--count",
                           count, "--rate", "5000"});
    ASSERT_EQ(injector.wait(milliseconds(30000)), 0) << injector.output();
    const int ended = stock.wait(milliseconds(200));
    std::printf("%-20s %s\n", kind,
                ended < 0      ? "survived"
                : ended == 139 ? "SIGSEGV"
                : ended == 134 ? "SIGABRT"
                               : ("ended with " + std::to_string(ended)).c_str());
    if (ended < 0) ++survived;
  }
  std::printf("stock liblcm receiver: survived %d of %d kinds\n", survived, inject::kKinds);
  EXPECT_GT(survived, 0) << "a receiver that always ends compares with nothing";
}

}  // namespace
}  // namespace palpate
