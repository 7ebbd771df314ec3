#pragma once

#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "rt/bus/message_bus.hpp"
#include "sim/scenes/simulation.hpp"

namespace palpate::scenes {

inline const std::string kSixPoses = PALPATE_SOURCE_DIR "/sim/scenes/bar_long_soft_six_poses.yaml";
inline const std::string kControl = PALPATE_SOURCE_DIR "/sim/scenes/bar_long_soft_control.yaml";

/// A coarser bar with softer pads: sufficient for these tests.
inline std::vector<std::string> coarse(std::vector<std::string> overrides = {}) {
  overrides.insert(overrides.end(),
                   {"object.elements=[7, 1, 1]", "object.grasp_box.lower=[0.428, 0, 0]",
                    "object.pads.stiffness=1e4"});
  return overrides;
}

/// A simulation on in-memory buses whose messages are recorded.
struct Stage {
  explicit Stage(const std::string& scene, const std::vector<std::string>& overrides = coarse())
      : simulation(config::Node::load_file(scene, overrides), *control, *housekeeping, {},
                   [this](const std::string& channel, const std::vector<std::uint8_t>& message,
                          std::int64_t utime) {
                     clouds.push_back({channel, message, utime});
                   }) {
    bus::record(*hub, &messages);
  }
  ~Stage() { bus::record(*hub, nullptr); }

  void run(double seconds) {
    for (int i = 0, n = static_cast<int>(seconds * 1000 + 0.5); i < n; ++i) simulation.step();
  }

  template <class Message>
  std::vector<Message> sent(const std::string& channel) const {
    std::vector<Message> found;
    for (const bus::Published& p : messages) {
      if (p.channel != channel) continue;
      found.emplace_back();
      if (found.back().decode(p.data.data(), 0, static_cast<int>(p.data.size())) < 0)
        throw std::runtime_error("cannot decode " + channel);
    }
    return found;
  }

  std::vector<bus::Published> messages;
  std::vector<bus::Published> clouds;  // time_ns: us, when each was sent
  std::shared_ptr<bus::MemoryHub> hub = bus::make_memory_hub();
  std::unique_ptr<bus::MessageBus> control = bus::make_memory_bus(hub);
  std::unique_ptr<bus::MessageBus> housekeeping = bus::make_memory_bus(hub);
  std::unique_ptr<bus::MessageBus> daemon = bus::make_memory_bus(hub);
  Simulation simulation;
};

}  // namespace palpate::scenes
