#pragma once

#include <netinet/in.h>

#include <string>

namespace palpate::bus {

/// LCM URL of UDP multicast.
struct UdpmUrl {
  std::string address = "239.255.76.67";
  int port = 7667;
  int ttl = 0;                  // 0: this machine only
  int receive_buffer_size = 0;  // bytes; 0: the maximum that the system permits

  /// The URL without options; programs with equal groups receive the same messages.
  std::string group() const { return address + ":" + std::to_string(port); }
  std::string text() const;
  sockaddr_in socket_address() const;
};

/// Parses udpm://[ADDRESS[:PORT]][?ttl=N][&recv_buf_size=BYTES], with LCM's defaults for omitted
/// parts. Throws std::invalid_argument naming the error.
UdpmUrl parse_udpm_url(const std::string& url);

/// Private URL for this machine only: a random group of 239.255.80 to 249, and a port below the
/// range that the system assigns automatically, because a port in use cannot be bound.
UdpmUrl private_url();

/// "cannot DOING URL: reason", and for errors caused by a missing multicast route the command that
/// adds one.
std::string explain_socket_error(const std::string& doing, const UdpmUrl& url, int error);

/// Throws std::runtime_error with the remedy where the system has no route to the group. Asks a
/// socket of its own: one that is connected sends by the interface of the address that it was given
/// then, which need not be the interface of the route that receivers join on.
void require_route(const UdpmUrl& url);

}  // namespace palpate::bus
