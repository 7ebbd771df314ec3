// The client of palpate-evaluate on a URL that any program may send to.

#include <gtest/gtest.h>

#include "tools/lab/inject/packets.hpp"
#include "tools/lab/inject/sender.hpp"
#include "tools/lab/runs/live_run.hpp"

namespace palpate::runs {
namespace {

constexpr int kPackets = 3000;  // some 200 of each kind

void send_malformed(const std::string& url, std::vector<inject::Target> targets) {
  inject::Sender sender(bus::parse_udpm_url(url), 20000);
  inject::PacketSource source(1, inject::malformed_kinds(), std::move(targets));
  for (int i = 0; i < kPackets; ++i) sender.send(source.next());
  sender.flush();
}

template <class Message>
inject::Target target(const char* channel) {
  return {channel, Message::getHash(), Message().getEncodedSize()};
}

TEST(Client, OutlivesMalformedPackets) {
  const Urls urls = private_urls();
  std::unique_ptr<bus::MessageBus> control, housekeeping;
  std::unique_ptr<client::Client> user;
  try {
    control = bus::make_lcm_bus(urls.control);
    housekeeping = bus::make_lcm_bus(urls.housekeeping);
    user = std::make_unique<client::Client>(*control, *housekeeping);
    user->wait(0);
  } catch (const std::runtime_error& error) {
    GTEST_SKIP() << error.what();
  }
  send_malformed(urls.control, {target<feature_t>("FEATURE")});
  send_malformed(urls.housekeeping,
                 {target<health_t>("HEALTH"), target<component_event_t>("COMPONENT_EVENT")});
  user->wait(0.2);
  EXPECT_FALSE(user->health());
  EXPECT_FALSE(user->feature());
  EXPECT_EQ(user->refusal(), "");

  const auto daemon = bus::make_lcm_bus(urls.housekeeping);
  health_t health{};
  health.state = 2;
  bus::TypedPublisher<health_t> publisher(*daemon, "HEALTH");
  for (int i = 0; i < 50 && !user->health(); ++i) {
    publisher.publish(health);
    user->wait(0.05);
  }
  EXPECT_TRUE(user->is_active());
}

}  // namespace
}  // namespace palpate::runs
