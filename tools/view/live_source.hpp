#pragma once

#include <memory>
#include <string>
#include <vector>

#include "tools/view/scene.hpp"

namespace palpate::view {

/// Statistics of a receiver, for the log.
struct ReceiverCounters {
  std::int64_t datagrams = 0, malformed = 0, of_no_interest = 0;
};

/// Receives the daemon's and the simulator's messages from LCM's multicast groups into a scene.
/// Does not use liblcm, which a malformed packet can crash: rt/bus checks framing, channel and size
/// before anything is decoded. Unlike the daemon's own receiver it accepts messages of any size,
/// since shapes and meshes have no fixed size.
class LiveSource {
 public:
  /// Joins the group of each URL. Throws std::invalid_argument or std::runtime_error with the
  /// remedy.
  explicit LiveSource(const std::vector<std::string>& urls);
  ~LiveSource();

  /// Handles everything received since the last call, without waiting; a flood is cut off after
  /// `most` datagrams per group.
  void receive(Scene& scene, int most = 20'000);

  /// Handles one datagram, as receive() does.
  void handle(Scene& scene, const std::uint8_t* data, int size, std::int64_t time_us);

  const ReceiverCounters& counters() const { return counters_; }

 private:
  struct Sockets;
  std::unique_ptr<Sockets> sockets_;
  std::vector<std::uint8_t> buffer_;
  ReceiverCounters counters_;
};

}  // namespace palpate::view
