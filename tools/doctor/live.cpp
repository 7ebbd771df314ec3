#include <palpate/channels.hpp>
#include <set>

#include "rt/bus/message_bus.hpp"
#include "rt/loop/fixed_rate_loop.hpp"
#include "tools/doctor/checks.hpp"
#include "tools/record/listener.hpp"
#include "tools/record/message_types.hpp"

namespace palpate::doctor {
namespace {

/// Receives until `done` returns true, for at most `seconds`.
template <class Done>
void receive_until(record::Listener& listener, double seconds, Done done) {
  const std::int64_t end = loop::monotonic_ns() + static_cast<std::int64_t>(seconds * 1e9);
  while (!done() && loop::monotonic_ns() < end) listener.receive(50);
}

/// Sends to a different group than the control URL's, so that nothing is disturbed.
Finding check_loopback(const Needs& needs, double seconds) {
  bus::UdpmUrl url = needs.control;
  url.port = bus::private_url().port;
  url.ttl = 0;
  constexpr char kChannel[] = "DOCTOR";
  bool came = false;
  record::Listener listener({{"probe", url}}, [&](const record::Heard& heard) {
    came = came || heard.channel == kChannel;
  });
  const auto sender = bus::make_lcm_bus(url.text());
  const std::int64_t word = 42;
  sender->publish(kChannel, &word, sizeof(word));
  receive_until(listener, seconds, [&] { return came; });
  if (came) return ok("loopback", "a message to " + url.address + " comes back");
  return fail("loopback", "a message to " + url.address + " does not come back",
              "programs of this machine do not hear each other: a firewall, or a device without "
              "multicast",
              "sudo ip link set lo multicast on\nsudo ip route replace 224.0.0.0/4 dev lo\n"
              "sudo nft list ruleset   # what drops 224.0.0.0/4");
}

Finding check_daemons(const Needs& needs, double seconds) {
  std::set<std::int64_t> sessions;
  record::Listener listener(
      {{"housekeeping", needs.housekeeping}}, [&](const record::Heard& heard) {
        const record::MessageType* type = record::type_of(heard.data, heard.size);
        if (heard.channel == channel::kHealth && type != nullptr && type->name == "health_t" &&
            type->fits(heard.data, heard.size) && sessions.size() < 100)
          sessions.insert(record::header_of(heard.data).session);
      });
  receive_until(listener, seconds, [] { return false; });
  const std::string text =
      std::to_string(sessions.size()) + " heard on " + needs.housekeeping.group();
  if (sessions.size() <= 1) return ok("daemons", text);
  return fail("daemons", text,
              "two palpated on one URL command one arm, and their messages cannot be distinguished",
              "pgrep -a palpated   # here and on every machine of the network; end all but one");
}

}  // namespace

Findings check_live(const Needs& needs, double seconds) {
  try {
    return {check_loopback(needs, seconds), check_daemons(needs, seconds)};
  } catch (const std::runtime_error& error) {
    return {fail("loopback", error.what(), "LCM can neither send nor listen",
                 "sudo ip link set lo multicast on\nsudo ip route add 224.0.0.0/4 dev lo")};
  }
}

}  // namespace palpate::doctor
