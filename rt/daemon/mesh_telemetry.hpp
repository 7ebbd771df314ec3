#pragma once

#include "rt/bus/shape_chunks.hpp"
#include "rt/pipeline/pipeline.hpp"
#include "rt/registry/object.hpp"

namespace palpate::daemon {

/// Publishes SHAPE and SHAPE_MESH of one mesh; owns everything whose size depends on it. Allocates
/// in the constructor only.
class MeshTelemetry {
 public:
  MeshTelemetry(bus::MessageBus& housekeeping, const registry::Object& object);

  /// `age_us`: age of the shape.
  void publish_shape(const pipeline::Pipeline& pipeline, std::int64_t age_us,
                     bus::HeaderStamper& stamp, std::int64_t utime) noexcept;
  /// Publishes one chunk of SHAPE_MESH; the next call publishes the next one.
  void publish_mesh_chunk(bus::HeaderStamper& stamp, std::int64_t utime) noexcept {
    mesh_.publish_chunk(stamp, utime);
  }
  int mesh_chunks() const noexcept { return mesh_.chunks(); }

 private:
  bus::ShapePublisher shape_;
  bus::MeshPublisher mesh_;
};

}  // namespace palpate::daemon
