#include "rt/bus/udpm_url.hpp"

#include <gtest/gtest.h>

#include <cerrno>
#include <set>

namespace palpate::bus {
namespace {

TEST(UdpmUrl, ReadsAddressPortAndOptions) {
  const UdpmUrl url = parse_udpm_url("udpm://239.1.2.3:4567?ttl=1&recv_buf_size=4194304");
  EXPECT_EQ(url.address, "239.1.2.3");
  EXPECT_EQ(url.port, 4567);
  EXPECT_EQ(url.ttl, 1);
  EXPECT_EQ(url.receive_buffer_size, 4194304);
  EXPECT_EQ(url.text(), "udpm://239.1.2.3:4567?ttl=1&recv_buf_size=4194304");
  EXPECT_EQ(ntohs(url.socket_address().sin_port), 4567);
  EXPECT_EQ(ntohl(url.socket_address().sin_addr.s_addr), 0xef010203u);
}

TEST(UdpmUrl, HasTheDefaultsOfLcm) {
  EXPECT_EQ(parse_udpm_url("udpm://").text(), "udpm://239.255.76.67:7667?ttl=0");
  EXPECT_EQ(parse_udpm_url("udpm://?ttl=2").text(), "udpm://239.255.76.67:7667?ttl=2");
  EXPECT_EQ(parse_udpm_url("udpm://239.0.0.1").text(), "udpm://239.0.0.1:7667?ttl=0");
  EXPECT_EQ(parse_udpm_url("udpm://:8000").group(), "239.255.76.67:8000");
}

TEST(UdpmUrl, NamesWhatIsWrong) {
  const auto expect_refusal = [](const std::string& url, const std::string& why) {
    try {
      parse_udpm_url(url);
      ADD_FAILURE() << url << " was accepted";
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find(why), std::string::npos) << error.what();
      EXPECT_NE(std::string(error.what()).find("udpm://239.255.76.67:7667?ttl=0"),
                std::string::npos);
    }
  };
  expect_refusal("", "not of the kind udpm");
  expect_refusal("tcpq://localhost:7700", "not of the kind udpm");
  expect_refusal("udpm://10.0.0.1:7667", "not a multicast address");
  expect_refusal("udpm://239.255.76:7667", "not an IPv4 address");
  expect_refusal("udpm://localhost:7667", "not an IPv4 address");
  expect_refusal("udpm://239.255.76.67:0", "port must be 1 to 65535");
  expect_refusal("udpm://239.255.76.67:70000", "port must be 1 to 65535");
  expect_refusal("udpm://239.255.76.67:7667x", "port must be 1 to 65535");
  expect_refusal("udpm://239.255.76.67:7667?ttl=256", "ttl must be 0 to 255");
  expect_refusal("udpm://239.255.76.67:7667?ttl", "ttl must be 0 to 255");
  expect_refusal("udpm://239.255.76.67:7667?recv_buf_size=-1", "recv_buf_size must be");
  expect_refusal("udpm://239.255.76.67:7667?tll=0", "unknown option \"tll\"");
  expect_refusal("udpm://239.255.76.67:7667?", "unknown option");
}

TEST(UdpmUrl, PrivateOnesDifferAndStayOnThisMachine) {
  std::set<std::string> groups;
  for (int i = 0; i < 100; ++i) {
    const UdpmUrl url = private_url();
    EXPECT_EQ(parse_udpm_url(url.text()).group(), url.group());
    EXPECT_EQ(url.ttl, 0);
    EXPECT_LT(url.port, 32768) << "the system hands out those above";
    groups.insert(url.group());
  }
  EXPECT_EQ(groups.size(), 100u);
}

TEST(UdpmUrl, AMissingRouteIsExplainedWithItsRemedy) {
  const UdpmUrl url;
  const std::string text = explain_socket_error("open", url, ENETUNREACH);
  EXPECT_NE(text.find("ip link set lo multicast on"), std::string::npos);
  EXPECT_NE(text.find("ip route add 224.0.0.0/4 dev lo"), std::string::npos);
  EXPECT_EQ(explain_socket_error("open", url, EACCES).find("ip route"), std::string::npos);
}

}  // namespace
}  // namespace palpate::bus
