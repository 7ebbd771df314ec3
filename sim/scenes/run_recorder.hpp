#pragma once

#include <cstdint>
#include <filesystem>
#include <lcm/lcm-cpp.hpp>
#include <memory>
#include <string>
#include <vector>

#include "rt/bus/message_bus.hpp"

namespace palpate::scenes {

/// Buses in memory whose messages are written to LCM logs at simulated times: a simulation that
/// needs neither a network nor a daemon.
class RunRecorder {
 public:
  /// Creates `folder` and sensors.log and truth.log in it, of the control and the housekeeping
  /// bus, and with clouds clouds.log. Throws std::runtime_error.
  RunRecorder(const std::filesystem::path& folder, bool has_clouds);

  bus::MessageBus& control() { return *sensors_.bus; }
  bus::MessageBus& housekeeping() { return *truth_.bus; }
  /// Writes a message of any size at once; as CloudSink.
  void write_cloud(const std::string& channel, const std::vector<std::uint8_t>& message,
                   std::int64_t utime);

  /// Writes what was published since the last call. `utime`: us, simulated. Throws
  /// std::runtime_error if the disk is full.
  void write(std::int64_t utime);

 private:
  struct File {
    explicit File(const std::filesystem::path& to);
    void write(std::int64_t utime, const std::string& channel,
               const std::vector<std::uint8_t>& message);

    std::filesystem::path path;
    lcm::LogFile file;
  };
  struct Log {
    explicit Log(const std::filesystem::path& to);
    void write(std::int64_t utime);

    File file;
    std::shared_ptr<bus::MemoryHub> hub = bus::make_memory_hub();
    std::unique_ptr<bus::MessageBus> bus = bus::make_memory_bus(hub);
    std::vector<bus::Published> published;
  };

  Log sensors_, truth_;
  std::unique_ptr<File> clouds_;
};

}  // namespace palpate::scenes
