#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/math/rigid.hpp"
#include "participant.hpp"
#include "tools/bridge/common/surface.hpp"

namespace palpate::ros2_bridge {

/// palpated's SHAPE as visualization_msgs/Marker: the triangles of the surface, with the pose of O
/// in W.
class ShapeMarker {
 public:
  struct Options {
    std::string topic;
    std::string frame = "base_link";                 // name of W
    math::Pose X_WO = math::Pose::Identity();        // of the mesh's rest frame
    std::vector<double> color = {0.9, 0.6, 0.3, 1};  // red, green, blue, opacity
    double rate = 20;                                // 1/s, at most
  };

  ShapeMarker(const Participant& participant, const Options& options);

  /// Takes a message of palpated's housekeeping, of any channel and content, and publishes the
  /// shape that it completes. `utime`: us, of any clock.
  void take(std::string_view channel, const void* data, int size, std::int64_t utime);

 private:
  std::string frame_;
  std::string name_ = "palpate", none_;
  bridge::Surface surface_;
  Marker marker_{};
  std::vector<Point> points_;
  Writer<Marker> markers_;
};

}  // namespace palpate::ros2_bridge
