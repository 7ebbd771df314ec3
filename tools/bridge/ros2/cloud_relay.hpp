#pragma once

#include <atomic>
#include <lcm/lcm-cpp.hpp>
#include <string>
#include <thread>

#include "sensors.hpp"

namespace palpate::ros2_bridge {

/// A depth camera's clouds for palpate-see, in a thread of its own: sensor_msgs/PointCloud2 as
/// lcmt_point_cloud. By liblcm, which publishes messages of any size.
class CloudRelay {
 public:
  struct Options {
    std::string topic;
    std::string channel = "POINT_CLOUD";
    std::string url;  // of LCM
    Clock clock;
  };

  /// Throws std::runtime_error if LCM cannot be opened.
  CloudRelay(const Participant& participant, const Options& options);
  ~CloudRelay();
  CloudRelay(const CloudRelay&) = delete;
  CloudRelay& operator=(const CloudRelay&) = delete;

  /// What it has counted is readable by any thread.
  const Intake& intake() const { return intake_; }

 private:
  void run();

  Options options_;
  Reader<PointCloud2> clouds_;
  Intake intake_;
  lcm::LCM lcm_;
  dds_entity_t waitset_, ended_;
  std::thread thread_;
};

}  // namespace palpate::ros2_bridge
