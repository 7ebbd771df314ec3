#include "tests/unit/tools/doctor/tree.hpp"
#include "tools/doctor/checks.hpp"

namespace palpate::doctor {
namespace {

using Network = Tree;

// 239.255.76.67:7667 and any address, as /proc/net/udp writes them.
constexpr char kGroup[] = "434CFFEF:1DF3", kAny[] = "00000000:1DF3";

Needs with_urls(const std::string& control, const std::string& housekeeping) {
  Needs needs;
  needs.control = bus::parse_udpm_url(control);
  needs.housekeeping = bus::parse_udpm_url(housekeeping);
  return needs;
}

TEST_F(Network, BufferIsComparedWithWhatTheUrlsAskFor) {
  put("proc/sys/net/core/rmem_max", "212992\n");
  expect("buffer", Verdict::kWarn, "212992, wanted 4194304");
  put("proc/sys/net/core/rmem_max", "4194304\n");
  expect("buffer", Verdict::kOk, "4194304");
  expect("buffer", Verdict::kWarn, "wanted 8388608",
         with_urls("udpm://239.255.76.67:7667?recv_buf_size=8388608", "udpm://239.255.76.68:7668"));
}

TEST_F(Network, NoRoute) {
  route("");
  const Finding found = finding("route");
  EXPECT_EQ(found.verdict, Verdict::kFail);
  EXPECT_NE(found.remedy.find("ip route add 224.0.0.0/4 dev lo"), std::string::npos);
}

TEST_F(Network, TheLongestPrefixIsTheRoute) {
  route(
      "eth0 00000000 010200C0 0003 0 0 0 00000000 0 0 0\n"
      "wlan0 000000E0 00000000 0001 0 0 600 000000F0 0 0 0\n"
      "eth1 000000E0 00000000 0001 0 0 100 000000F0 0 0 0\n"
      "lo 434CFFEF 00000000 0001 0 0 0 FFFFFFFF 0 0 0");
  EXPECT_EQ(route_to(machine(), "239.255.76.67"), "lo");
  EXPECT_EQ(route_to(machine(), "239.255.76.68"), "eth1") << "of two the lesser metric";
  EXPECT_EQ(route_to(machine(), "10.0.0.1"), "eth0");
  route("lo 000000E0 00000000 0201 0 0 0 000000F0 0 0 0");
  EXPECT_EQ(route_to(machine(), "239.255.76.67"), std::nullopt) << "a route that rejects";
  route("lo 000000E0 00000000 0000 0 0 0 000000F0 0 0 0");
  EXPECT_EQ(route_to(machine(), "239.255.76.67"), std::nullopt) << "a route that is down";
}

TEST_F(Network, DevicesThatAreDownOrTakeNoMulticast) {
  put("sys/class/net/lo/flags", "0x9\n");
  EXPECT_EQ(finding("route").verdict, Verdict::kFail);
  EXPECT_NE(finding("route").found.find("takes no multicast"), std::string::npos);
  put("sys/class/net/lo/flags", "0x1008\n");
  EXPECT_NE(finding("route").found.find("is down"), std::string::npos);
  EXPECT_EQ(finding("route_housekeeping").verdict, Verdict::kFail);
}

TEST_F(Network, TtlThatTheRouteContradictsOrThatLeavesTheNetwork) {
  const Needs wide =
      with_urls("udpm://239.255.76.67:7667?ttl=1", "udpm://239.255.76.68:7668?ttl=0");
  expect("route", Verdict::kWarn, "goes by lo", wide);
  EXPECT_EQ(finding("ttl", wide).verdict, Verdict::kOk);
  route("eth0 00000000 010200C0 0003 0 0 0 00000000 0 0 0");
  put("sys/class/net/eth0/flags", "0x1003\n");
  expect("ttl", Verdict::kWarn, "3",
         with_urls("udpm://239.255.76.67:7667?ttl=3", "udpm://239.255.76.68:7668?ttl=0"));
}

TEST_F(Network, UrlsThatGetInEachOthersWay) {
  expect("urls", Verdict::kWarn, "are both",
         with_urls("udpm://239.255.76.67:7667", "udpm://239.255.76.67:7667"));
  expect("urls", Verdict::kWarn, "share port",
         with_urls("udpm://239.255.76.67:7667", "udpm://239.255.76.68:7667"));
}

TEST_F(Network, WhoListensIsNamed) {
  listener(41, "palpated", kGroup, 0);
  listener(42, "lcm-logger", kAny, 0);
  listener(43, "other", "444CFFEF:1DF3", 0);  // of another group on the same port
  expect("listeners", Verdict::kOk, "palpated (41), lcm-logger (42)");
  EXPECT_EQ(finding("listeners").found.find("other"), std::string::npos);
}

TEST_F(Network, ListenersThatLoseOrAreStopped) {
  listener(41, "lcm-spy", kAny, 123);
  expect("listeners", Verdict::kWarn, "lcm-spy (41) lost 123");
  listener(42, "stuck", kGroup, 0, "T (stopped)");
  const Finding found = finding("listeners");
  EXPECT_EQ(found.verdict, Verdict::kWarn);
  EXPECT_NE(found.why.find("process 42 is stopped"), std::string::npos) << found.why;
  EXPECT_NE(found.remedy.find("kill -CONT 42"), std::string::npos);
}

TEST_F(Network, ListenersOfOthersAreCounted) {
  listener(41, "hidden", kGroup, 0);
  remove("proc/41/fd");
  expect("listeners", Verdict::kOk, "1 that are not mine to see");
}

TEST_F(Network, ADaemonThatRunsIsNamed) {
  expect("daemon", Verdict::kOk, "no palpated runs");
  put("proc/net/unix",
      "Num RefCount Protocol Flags Type St Inode Path\n"
      "00000000aa: 00000002 00000000 00010000 0001 01 777 @palpate/palpated/239.255.76.67:7667\n");
  link("proc/99/fd/4", "socket:[777]");
  expect("daemon", Verdict::kOk, "process 99");
}

}  // namespace
}  // namespace palpate::doctor
