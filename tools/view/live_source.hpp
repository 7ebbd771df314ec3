#pragma once

#include <memory>
#include <string>
#include <vector>

#include "tools/view/scene.hpp"

namespace palpate::view {

/// What a receiver saw, for the log.
struct ReceiverCounters {
  std::int64_t datagrams = 0, malformed = 0, of_no_interest = 0;
};

/// Takes the daemon's and the simulator's messages from LCM's multicast groups into a scene. Never
/// through liblcm, which a malformed packet kills: framing, channel and size are checked by
/// rt/bus before anything is decoded. Takes messages of any size, which the daemon's own receiver
/// does not, for shapes and meshes have none of their own.
class LiveSource {
 public:
  /// Joins the group of each URL. Throws std::invalid_argument or std::runtime_error with the
  /// remedy.
  explicit LiveSource(const std::vector<std::string>& urls);
  ~LiveSource();

  /// All that has come since the last call, without waiting; a flood is cut off after `most`
  /// datagrams of each group.
  void receive(Scene& scene, int most = 20'000);

  /// One datagram, as receive() handles it.
  void handle(Scene& scene, const std::uint8_t* data, int size, std::int64_t time_us);

  const ReceiverCounters& counters() const { return counters_; }

 private:
  struct Sockets;
  std::unique_ptr<Sockets> sockets_;
  std::vector<std::uint8_t> buffer_;
  ReceiverCounters counters_;
};

}  // namespace palpate::view
