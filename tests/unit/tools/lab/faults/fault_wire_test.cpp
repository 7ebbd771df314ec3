// The fault campaign's receiver on a URL that any program may send to.

#include "tools/lab/faults/fault_wire.hpp"

#include <gtest/gtest.h>

#include <palpate/health_t.hpp>
#include <palpate/shape_t.hpp>

#include "rt/bus/session.hpp"
#include "tools/common/interruption.hpp"
#include "tools/lab/inject/packets.hpp"
#include "tools/lab/inject/sender.hpp"

namespace palpate::faults {
namespace {

TEST(FaultWire, OutlivesMalformedPacketsAndKeepsWhatIsRight) {
  const runs::Urls urls = runs::private_urls();
  std::unique_ptr<FaultWire> wire;
  try {
    wire = std::make_unique<FaultWire>(urls);
  } catch (const std::runtime_error& error) {
    GTEST_SKIP() << error.what();
  }
  wire->begin();
  inject::Sender sender(bus::parse_udpm_url(urls.housekeeping), 20000);
  inject::PacketSource source(1, inject::malformed_kinds(),
                              {{"SHAPE", shape_t::getHash(), 300},
                               {"HEALTH", health_t::getHash(), health_t().getEncodedSize()}});
  for (int i = 0; i < 3000; ++i) sender.send(source.next());
  sender.flush();

  const auto daemon = bus::make_lcm_bus(urls.housekeeping);
  bus::TypedPublisher<health_t> publisher(*daemon, "HEALTH");
  health_t health{};
  health.session = 5;
  for (int i = 0; i < 50; ++i) {
    health.utime = bus::wall_clock_us();
    health.seq = i;
    health.state = 2;
    publisher.publish(health);
    common::sleep_for(0.01);
  }
  const Trace trace = wire->trace(static_cast<int>(wire->now() * 1e3) + 100, {}, kTick);
  EXPECT_GT(trace.undecoded, 0) << "what has a name that the daemon uses is looked at";
  ASSERT_FALSE(trace.health.empty());
  EXPECT_EQ(trace.health.back().state, 2);
}

}  // namespace
}  // namespace palpate::faults
