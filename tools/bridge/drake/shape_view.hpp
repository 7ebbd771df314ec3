#pragma once

#include <cstdint>
#include <drake/lcmt_viewer_link_data.hpp>
#include <string_view>
#include <vector>

#include "core/math/rigid.hpp"
#include "tools/bridge/common/surface.hpp"

namespace palpate::drake_bridge {

/// palpated's SHAPE as the message that meldis draws on DRAKE_VIEWER_DEFORMABLE: the surface's
/// vertices and triangles in O, with the pose of O.
class ShapeView {
 public:
  static constexpr const char* kChannel = "DRAKE_VIEWER_DEFORMABLE";

  struct Options {
    math::Pose X_WO = math::Pose::Identity();        // of the mesh's rest frame in the base
    std::vector<double> color = {0.9, 0.6, 0.3, 1};  // red, green, blue, opacity
    double rate = 20;                                // 1/s, at most
  };

  explicit ShapeView(const Options& options);

  /// Takes a message of palpated's housekeeping, of any channel and content. True if message() is
  /// then to be published. `utime`: us, of any clock.
  bool take(std::string_view channel, const void* data, int size, std::int64_t utime);
  const ::drake::lcmt_viewer_link_data& message() const { return message_; }

 private:
  bridge::Surface surface_;
  ::drake::lcmt_viewer_link_data message_{};
};

}  // namespace palpate::drake_bridge
