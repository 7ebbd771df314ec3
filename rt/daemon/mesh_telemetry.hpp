#pragma once

#include <palpate/shape_mesh_t.hpp>
#include <palpate/shape_t.hpp>
#include <vector>

#include "rt/bus/message_bus.hpp"
#include "rt/bus/session.hpp"
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
  void publish_mesh_chunk(bus::HeaderStamper& stamp, std::int64_t utime) noexcept;
  int mesh_chunks() const noexcept { return static_cast<int>(mesh_.size()); }

 private:
  void prepare_mesh(const registry::Object& object);

  bus::TypedPublisher<shape_t> shape_;
  bus::TypedPublisher<shape_mesh_t> mesh_publisher_;
  shape_t shape_message_{};
  std::vector<shape_mesh_t> mesh_;
  std::size_t next_chunk_ = 0;
};

}  // namespace palpate::daemon
