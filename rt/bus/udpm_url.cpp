#include "rt/bus/udpm_url.hpp"

#include <arpa/inet.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstring>
#include <random>
#include <stdexcept>

namespace palpate::bus {
namespace {

constexpr char kScheme[] = "udpm://";
constexpr int kLargestBuffer = 1 << 30;

[[noreturn]] void reject(const std::string& url, const std::string& why) {
  throw std::invalid_argument("LCM URL \"" + url + "\": " + why +
                              "; expected udpm://ADDRESS:PORT?ttl=N&recv_buf_size=BYTES, "
                              "for instance udpm://239.255.76.67:7667?ttl=0");
}

int number(const std::string& url, const std::string& name, const std::string& text, int low,
           int high) {
  int value = 0;
  const char* end = text.data() + text.size();
  const auto result = std::from_chars(text.data(), end, value);
  if (result.ec != std::errc() || result.ptr != end || value < low || value > high)
    reject(url, name + " must be " + std::to_string(low) + " to " + std::to_string(high) +
                    ", not \"" + text + "\"");
  return value;
}

void read_group(const std::string& url, const std::string& group, UdpmUrl& out) {
  const std::size_t colon = group.find(':');
  const std::string address = group.substr(0, colon);
  if (!address.empty()) out.address = address;
  if (colon != std::string::npos) out.port = number(url, "port", group.substr(colon + 1), 1, 65535);
  in_addr parsed{};
  if (inet_pton(AF_INET, out.address.c_str(), &parsed) != 1)
    reject(url, "\"" + out.address + "\" is not an IPv4 address");
  if (!IN_MULTICAST(ntohl(parsed.s_addr)))
    reject(url, out.address + " is not a multicast address (224.0.0.0 to 239.255.255.255)");
}

void read_option(const std::string& url, const std::string& option, UdpmUrl& out) {
  const std::size_t equals = option.find('=');
  const std::string key = option.substr(0, equals);
  const std::string value = equals == std::string::npos ? "" : option.substr(equals + 1);
  if (key == "ttl")
    out.ttl = number(url, key, value, 0, 255);
  else if (key == "recv_buf_size")
    out.receive_buffer_size = number(url, key, value, 0, kLargestBuffer);
  else
    reject(url, "unknown option \"" + key + "\"");
}

}  // namespace

std::string UdpmUrl::text() const {
  std::string text = kScheme + group() + "?ttl=" + std::to_string(ttl);
  if (receive_buffer_size > 0) text += "&recv_buf_size=" + std::to_string(receive_buffer_size);
  return text;
}

sockaddr_in UdpmUrl::socket_address() const {
  sockaddr_in result{};
  result.sin_family = AF_INET;
  result.sin_port = htons(static_cast<std::uint16_t>(port));
  inet_pton(AF_INET, address.c_str(), &result.sin_addr);
  return result;
}

UdpmUrl parse_udpm_url(const std::string& url) {
  if (url.rfind(kScheme, 0) != 0) reject(url, "not of the kind udpm");
  UdpmUrl result;
  const std::size_t question = url.find('?');
  const std::size_t begin = std::strlen(kScheme);
  read_group(url, url.substr(begin, question - begin), result);
  for (std::size_t at = question; at != std::string::npos;) {
    const std::size_t next = url.find('&', at + 1);
    read_option(url, url.substr(at + 1, next - at - 1), result);
    at = next;
  }
  return result;
}

UdpmUrl private_url() {
  std::random_device random;
  const auto draw = [&](unsigned low, unsigned high) { return low + random() % (high - low + 1); };
  UdpmUrl url;
  url.address = "239.255." + std::to_string(draw(80, 249)) + "." + std::to_string(draw(1, 250));
  url.port = static_cast<int>(draw(10000, 32000));
  return url;
}

std::string explain_socket_error(const std::string& doing, const UdpmUrl& url, int error) {
  std::string text = "cannot " + doing + " " + url.text() + ": " + std::strerror(error);
  if (error == ENETUNREACH || error == ENODEV || error == EHOSTUNREACH)
    text +=
        ". There is no route for multicast; add one, for one machine alone with\n"
        "  ip link set lo multicast on\n"
        "  ip route add 224.0.0.0/4 dev lo";
  return text;
}

void require_route(const UdpmUrl& url) {
  const int fd = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  const sockaddr_in address = url.socket_address();
  const bool reachable =
      fd >= 0 && connect(fd, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0;
  const int error = errno;
  if (fd >= 0) close(fd);
  if (!reachable) throw std::runtime_error(explain_socket_error("open", url, error));
}

}  // namespace palpate::bus
