#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "raw_dds.hpp"

namespace fast_peer {

/// An arm and a wrist sensor as nodes of ROS 2, at 1 kHz: the joints follow the last velocities for
/// ever, as a forward_command_controller does.
class FastArm {
 public:
  struct Options {
    std::string states, commands;  // topics of ROS 2
    bool takes_twists = false;     // geometry_msgs/TwistStamped, at which the joints rest
    std::vector<std::string> names;
    std::vector<double> q;            // rad
    std::string wrench, compensated;  // topics of the sensor and of the answer; empty: none
  };

  FastArm(RawDds& dds, const Options& options);
  ~FastArm();

  /// silent, nan, late, short; "" for none. From then on "rested SECONDS" is printed when the
  /// command is zero.
  void set_fault(const std::string& fault);
  /// Number of commands, largest speed (rad/s, or of the twist), then the positions.
  std::string state() const;
  /// Quantiles in ms and numbers of what has arrived since the last call: from a wrench's stamp to
  /// the compensated one with this stamp, and to the next command after that.
  std::string latency();

 private:
  void run();
  void publish_state(std::int64_t now_ns);
  void publish_wrench(std::int64_t now_ns);
  void take_command(const Bytes& message);
  void take_wrench(const Bytes& message);

  RawDds& dds_;
  Options options_;
  mutable std::mutex mutex_;
  std::vector<double> q_, dq_;
  std::string fault_;
  std::int64_t fault_ns_ = 0;  // 0: has been answered
  long commands_ = 0;
  double speed_ = 0;
  std::vector<std::int64_t> waiting_;           // stamps whose command is still to come, ns
  std::vector<double> to_wrench_, to_command_;  // ms
  std::atomic<bool> ended_{false};
  std::thread thread_;
};

}  // namespace fast_peer
