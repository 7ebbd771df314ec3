// Termination of a daemon, and conditions under which it does not start.

#include <arpa/inet.h>
#include <sys/socket.h>

#include "rt/bus/udpm_url.hpp"
#include "tests/process/faults/fault_process.hpp"

namespace palpate {
namespace {

class End : public FaultProcess, public ::testing::WithParamInterface<int> {};

TEST_P(End, OnASignalBrakesAndIsClean) {
  ChildProcess daemon(patient_command());
  health_t health{};
  ASSERT_TRUE(wait_health([](const health_t& h) { return h.cycles > 200; }, health))
      << daemon.output();
  Robot robot(control_url_, true);
  ASSERT_TRUE(activate()) << daemon.output();
  send_target(0.12);
  // While moving at full speed.
  twist_command_t twist{};
  std::int64_t arrival_ns = 0;
  const auto patience = Clock::now() + std::chrono::seconds(20);
  const auto speed_of = [](const twist_command_t& t) {
    return std::hypot(t.twist[0], t.twist[1], t.twist[2]);
  };
  while (speed_of(twist) < 0.02 && Clock::now() < patience) {
    std::this_thread::sleep_for(milliseconds(1));
    while (command_->take(twist, arrival_ns)) {
    }
  }
  ASSERT_GE(speed_of(twist), 0.02);
  const auto begin = Clock::now();
  daemon.send(GetParam());
  EXPECT_EQ(daemon.wait(milliseconds(10000)), 0) << daemon.output();
  const double took = seconds_since(begin);

  std::this_thread::sleep_for(milliseconds(50));
  twist_command_t last = twist;
  double largest_step = 0;
  int commands = 0;
  while (command_->take(twist, arrival_ns)) {
    const double gap = std::max(1, twist.seq - last.seq);
    for (int i = 0; i < 3; ++i)
      largest_step = std::max(largest_step, std::abs(twist.twist[i] - last.twist[i]) / gap);
    last = twist;
    ++commands;
  }
  std::printf("ended after %.3f s; %d commands meanwhile, largest step %.2e m/s a tick\n", took,
              commands, largest_step);
  for (double v : last.twist) EXPECT_EQ(v, 0);
  EXPECT_EQ(last.valid, 0);
  // From the gate's speed limit to rest in 100 ms at the earliest.
  EXPECT_LE(largest_step, 1.05 * kSpeedLimit / 100);
}
INSTANTIATE_TEST_SUITE_P(Signals, End, ::testing::Values(SIGTERM, SIGINT));

using Begin = FaultProcess;

TEST_F(Begin, PortInUseIsRefusedWithReason) {
  const bus::UdpmUrl url = bus::parse_udpm_url(support::private_url(2));
  sockaddr_in address = url.socket_address();
  address.sin_addr.s_addr = htonl(INADDR_ANY);
  const int other = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  ASSERT_EQ(bind(other, reinterpret_cast<const sockaddr*>(&address), sizeof(address)), 0);
  ChildProcess daemon({kDaemon, "--config", kExample, "--set",
                       "bus.control=" + support::private_url(2), "--set",
                       "bus.housekeeping=" + housekeeping_url_});
  EXPECT_EQ(daemon.wait(milliseconds(20000)), 1);
  EXPECT_NE(daemon.output().find(url.group()), std::string::npos) << daemon.output();
  EXPECT_NE(daemon.output().find("in use"), std::string::npos) << daemon.output();
  close(other);
}

}  // namespace
}  // namespace palpate
