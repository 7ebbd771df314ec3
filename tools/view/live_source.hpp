#pragma once

#include <functional>
#include <list>
#include <string>
#include <vector>

#include "rt/bus/lcm_bus.hpp"
#include "tools/view/scene.hpp"

namespace palpate::view {

/// Receives the daemon's and the simulator's messages from LCM's multicast groups into a scene.
/// Does not use liblcm, which a malformed packet can crash: rt/bus checks framing, channel and size
/// before anything is decoded. Unlike the daemon's own receiver it accepts messages of any size,
/// since shapes and meshes have no fixed size.
class LiveSource {
 public:
  /// Joins the group of each URL. `names`: of channels on these buses. Throws std::invalid_argument
  /// or std::runtime_error with the remedy.
  explicit LiveSource(const std::vector<std::string>& urls, bus::ChannelNames names = {});

  /// Receives every message, whatever its channel; valid during the call.
  using Listener = std::function<void(std::string_view channel, const void* data, int size,
                                      std::int64_t time_us)>;
  void listen_by(Listener listener) { listener_ = std::move(listener); }

  /// Handles everything received since the last call, without waiting; a flood is cut off after
  /// `most` datagrams per group.
  void receive(Scene& scene, int most = 20'000);

  /// Handles one datagram, as receive() does.
  void handle(Scene& scene, const std::uint8_t* data, int size, std::int64_t time_us);

  const bus::DatagramCounters& counters() const { return counters_; }

 private:
  bus::ChannelNames names_;
  Listener listener_;
  std::list<bus::UdpmSocket> sockets_;
  bus::DatagramCounters counters_;  // unsubscribed: of channels that the scene does not show
};

}  // namespace palpate::view
