#pragma once

#include <cstdint>
#include <filesystem>
#include <lcm/lcm-cpp.hpp>
#include <memory>
#include <vector>

#include "rt/bus/message_bus.hpp"

namespace palpate::scenes {

/// Buses in memory whose messages are written to LCM logs at simulated times: a simulation that
/// needs neither a network nor a daemon.
class RunRecorder {
 public:
  /// Creates `folder` and sensors.log and truth.log in it, of the control and the housekeeping
  /// bus. Throws std::runtime_error.
  explicit RunRecorder(const std::filesystem::path& folder);

  bus::MessageBus& control() { return *sensors_.bus; }
  bus::MessageBus& housekeeping() { return *truth_.bus; }

  /// Writes what was published since the last call. `utime`: us, simulated. Throws
  /// std::runtime_error if the disk is full.
  void write(std::int64_t utime);

 private:
  struct Log {
    explicit Log(const std::filesystem::path& to);
    void write(std::int64_t utime);

    std::filesystem::path path;
    lcm::LogFile file;
    std::shared_ptr<bus::MemoryHub> hub = bus::make_memory_hub();
    std::unique_ptr<bus::MessageBus> bus = bus::make_memory_bus(hub);
    std::vector<bus::Published> published;
  };

  Log sensors_, truth_;
};

}  // namespace palpate::scenes
