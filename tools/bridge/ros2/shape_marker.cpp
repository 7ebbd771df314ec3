#include "shape_marker.hpp"

#include <algorithm>
#include <cmath>

#include "conversions.hpp"

namespace palpate::ros2_bridge {
namespace {

constexpr std::int32_t kTriangleList = 11;  // Marker.type; its action 0 is to add or change

}  // namespace

ShapeMarker::ShapeMarker(const Participant& participant, const Options& options)
    : frame_(options.frame),
      surface_(options.rate),
      markers_(participant, {options.topic, Quality::kReliable}) {
  marker_.header.frame_id = frame_.data();
  marker_.ns = name_.data();
  marker_.type = kTriangleList;
  marker_.pose = pose_message(options.X_WO);
  marker_.scale = {1, 1, 1};
  // It disappears when palpated has ended.
  marker_.lifetime.sec = static_cast<std::int32_t>(std::ceil(3 / std::min(options.rate, 3.0)));
  const auto channel = [&](int i) { return static_cast<float>(options.color[i]); };
  marker_.color = {channel(0), channel(1), channel(2), channel(3)};
  for (char** text :
       {&marker_.texture_resource, &marker_.texture.header.frame_id, &marker_.texture.format,
        &marker_.text, &marker_.mesh_resource, &marker_.mesh_file.filename})
    *text = none_.data();
}

void ShapeMarker::take(std::string_view channel, const void* data, int size, std::int64_t utime) {
  if (!surface_.take(channel, data, size, utime)) return;
  points_.clear();
  for (const std::int32_t vertex : surface_.triangles()) {
    const float* const xyz = &surface_.vertices()[3 * static_cast<std::size_t>(vertex)];
    points_.push_back({xyz[0], xyz[1], xyz[2]});
  }
  refer(marker_.points, points_);
  marker_.header.stamp = stamp_of(surface_.utime());
  markers_.write(marker_);
}

}  // namespace palpate::ros2_bridge
