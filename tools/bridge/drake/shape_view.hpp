#pragma once

#include <cstdint>
#include <drake/lcmt_viewer_link_data.hpp>
#include <string_view>
#include <vector>

#include "core/math/rigid.hpp"
#include "rt/bus/shape_chunks.hpp"

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
  bool draw(const shape_t& shape);
  void number(const shape_mesh_t& mesh);

  Options options_;
  bus::MeshAssembler meshes_;
  bus::ShapeAssembler shapes_;
  ::drake::lcmt_viewer_link_data message_{};
  std::int64_t mesh_hash_ = 0, node_count_ = 0;
  bool has_mesh_ = false;
  std::vector<std::int32_t> nodes_;  // of the surface's vertices
  std::int64_t drawn_us_ = 0;
  bool has_drawn_ = false;
};

}  // namespace palpate::drake_bridge
