// Datagrams, each a length of two bytes and that many bytes, passed to the receiver as from its
// socket.

#include <cstring>
#include <palpate/component_command_t.hpp>
#include <palpate/ft_wrench_t.hpp>
#include <palpate/sim_tick_t.hpp>
#include <string_view>

#include "rt/bus/lcm_bus.hpp"
#include "tests/fuzz/target.hpp"

namespace palpate::fuzz {
namespace {

/// The length prefix of a datagram.
std::string length_of(const std::string& bytes) {
  return {static_cast<char>(bytes.size() & 0xff), static_cast<char>(bytes.size() >> 8)};
}

template <class Message>
std::string message(const std::string& channel, const Message& content, const char* magic) {
  std::vector<char> payload(content.getEncodedSize());
  content.encode(payload.data(), 0, static_cast<int>(payload.size()));
  std::string bytes = std::string(magic, 4) + std::string("\0\0\0\1", 4) + channel + '\0';
  bytes.append(payload.begin(), payload.end());
  return length_of(bytes) + bytes;
}

/// A message in two fragments, the last first.
template <class Message>
std::string fragments(const std::string& channel, const Message& content) {
  constexpr std::size_t kHeader = 2 + 8;  // of message(): length, magic number, sequence
  const std::string whole = message(channel, content, "LC03").substr(kHeader);
  const std::size_t name = channel.size() + 1, size = whole.size() - name, half = size / 2;
  const auto half_word = [](std::size_t number) {
    return std::string{static_cast<char>(number >> 8 & 0xff), static_cast<char>(number & 0xff)};
  };
  const auto part = [&](std::size_t at, char number, const std::string& bytes) {
    const std::string datagram = std::string("LC03\0\0\0\1\0\0", 10) + half_word(size) +
                                 std::string(2, '\0') + half_word(at) +
                                 std::string{'\0', number, '\0', '\2'} + bytes;
    return length_of(datagram) + datagram;
  };
  return part(half, 1, whole.substr(name + half)) + part(0, 0, whole.substr(0, name + half));
}

void check_frame(const std::uint8_t* data, int size) {
  bus::DatagramCounters counters;
  bus::UdpmFrame frame{};
  if (!bus::parse_udpm_frame(data, size, counters, frame)) return;
  const auto* channel = reinterpret_cast<const std::uint8_t*>(frame.channel.data());
  require(!frame.channel.empty() && frame.channel.size() <= bus::kLongestChannel, "channel length");
  require(channel == data + bus::kUdpmHeaderSize, "channel's place");
  require(channel[frame.channel.size()] == 0, "the zero after the channel");
  require(frame.payload_size >= 0 && frame.payload + frame.payload_size == data + size, "payload");
}

}  // namespace

std::vector<std::string> seeds() {
  const std::string wrench = message("FT_WRENCH", ft_wrench_t{}, "LC02");
  const std::string fragment = message("FT_WRENCH", ft_wrench_t{}, "LC03");
  const std::string other = message("ANOTHER", ft_wrench_t{}, "LC02");
  const std::string command = message("COMPONENT_COMMAND", component_command_t{}, "LC02");
  return {wrench,
          wrench + wrench + wrench + wrench,
          fragment + wrench + other,
          command,
          other + message("SIM_TICK", sim_tick_t{}, "LC02") + wrench,
          fragments("FT_WRENCH", ft_wrench_t{}) + wrench + fragments("SIM_TICK", sim_tick_t{})};
}

namespace {

/// `largest`: message whose fragments are joined, bytes; 0: none.
void receive(const std::uint8_t* data, std::size_t size, int largest) {
  bus::DatagramCounters counters;
  bus::UdpmReceiver receiver(counters, largest);
  std::vector<bus::Subscription*> subscriptions;
  const auto subscribe = [&](const char* channel, auto type) {
    using Message = decltype(type);
    subscriptions.push_back(
        &receiver.subscribe(channel, type.getEncodedSize(), Message::getHash(), 2));
  };
  subscribe("FT_WRENCH", ft_wrench_t{});
  subscribe("COMPONENT_COMMAND", component_command_t{});
  subscribe("SIM_TICK", sim_tick_t{});

  std::int64_t sent = 0;
  while (size >= 2) {
    const std::size_t length = std::min<std::size_t>(size - 2, data[0] | data[1] << 8);
    const std::vector<std::uint8_t> bytes(data + 2, data + 2 + length);
    check_frame(bytes.data(), static_cast<int>(length));
    receiver.handle(bytes.data(), static_cast<int>(length), ++sent);
    data += 2 + length;
    size -= 2 + length;
  }
  std::int64_t offered = 0;
  for (bus::Subscription* subscription : subscriptions) {
    const bus::SubscriptionCounters& count = subscription->counters();
    offered += count.received + count.wrong_size + count.wrong_type;
    std::int64_t taken = 0;
    for (std::int64_t arrival = 0, last = 0; subscription->take(arrival) != nullptr; ++taken) {
      require(arrival > last && arrival <= sent, "order of arrival");
      last = arrival;
    }
    require(taken == count.received - count.dropped, "what is received is taken or dropped");
  }
  require(counters.received == sent, "each datagram counts");
  const std::int64_t accounted =
      counters.malformed + counters.fragmented + counters.unsubscribed + offered;
  // Fragments that are joined count once, and others may still wait.
  require(largest > 0 ? accounted <= sent : accounted == sent, "each datagram has one reason");
}

}  // namespace
}  // namespace palpate::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  palpate::fuzz::receive(data, size, 0);
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  if (text.find("LC03") != text.npos) palpate::fuzz::receive(data, size, 2048);
  return 0;
}
