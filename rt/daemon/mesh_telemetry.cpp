#include "rt/daemon/mesh_telemetry.hpp"

#include <algorithm>
#include <palpate/channels.hpp>

namespace palpate::daemon {
namespace {

std::int32_t shape_status(elasticity::StepStatus status) noexcept {
  switch (status) {
    case elasticity::StepStatus::kConverged:
      return shape_t::STATUS_CURRENT;
    case elasticity::StepStatus::kNotConverged:
      return shape_t::STATUS_NOT_CONVERGED;
    case elasticity::StepStatus::kFailed:
      break;
  }
  return shape_t::STATUS_OLD;
}

}  // namespace

MeshTelemetry::MeshTelemetry(bus::MessageBus& housekeeping, const registry::Object& object)
    : shape_(housekeeping, channel::kShape, bus::Urgency::kLater),
      mesh_publisher_(housekeeping, channel::kShapeMesh, bus::Urgency::kLater) {
  shape_message_.mesh_hash = object.hash;
  shape_message_.node_count = object.corners.node_count();
  shape_message_.xyz_count = 3 * shape_message_.node_count;
  shape_message_.xyz.resize(shape_message_.xyz_count);
  // deviations are included if the datagram has room for them
  constexpr int kBytesPerNode = 16, kRoom = 60'000;
  if (kBytesPerNode * shape_message_.node_count < kRoom)
    shape_message_.deviation.resize(shape_message_.node_count);
  shape_message_.deviation_count = static_cast<std::int32_t>(shape_message_.deviation.size());
  shape_.reserve(shape_message_.getEncodedSize());
  prepare_mesh(object);
}

void MeshTelemetry::publish_shape(const pipeline::Pipeline& pipeline, std::int64_t age_us,
                                  bus::HeaderStamper& stamp, std::int64_t utime) noexcept {
  stamp.put(shape_message_, utime);
  shape_message_.status = shape_status(pipeline.estimate().step.status);
  shape_message_.age_us = static_cast<std::int32_t>(std::min<std::int64_t>(age_us, 2'000'000'000));
  const Eigen::Matrix3Xd& x = pipeline.model().positions();
  for (int i = 0; i < shape_message_.xyz_count; ++i) {
    shape_message_.xyz[i] = static_cast<float>(x.data()[i]);
  }
  const std::vector<float>* deviation = pipeline.estimate().node_deviation;
  shape_message_.deviation_count =
      deviation == nullptr ? 0 : static_cast<std::int32_t>(shape_message_.deviation.size());
  std::copy_n(deviation == nullptr ? nullptr : deviation->data(), shape_message_.deviation_count,
              shape_message_.deviation.data());
  shape_.publish(shape_message_);
}

/// Chunks of at most 1,000 nodes, elements and triangles: below 60 kB each.
void MeshTelemetry::prepare_mesh(const registry::Object& object) {
  constexpr int kPerChunk = 1000;
  const mesh::TetrahedralMesh& corners = object.corners;
  const Eigen::Matrix3Xi& triangles = object.surface.triangles;
  const int largest = std::max(
      {corners.node_count(), corners.tetrahedron_count(), static_cast<int>(triangles.cols())});
  const int chunks = (largest + kPerChunk - 1) / kPerChunk;
  for (int chunk = 0; chunk < chunks; ++chunk) {
    shape_mesh_t message{};
    message.mesh_hash = object.hash;
    message.element_kind = shape_mesh_t::QUADRATIC_TETRAHEDRA;
    if (object.body.mesh.order == mesh::ElementOrder::kLinear) {
      message.element_kind = shape_mesh_t::LINEAR_TETRAHEDRA;
    }
    message.chunk = static_cast<std::int16_t>(chunk);
    message.chunks = static_cast<std::int16_t>(chunks);
    message.corner_count = corners.node_count();
    message.first_node = std::min(chunk * kPerChunk, corners.node_count());
    message.element_size = 4;
    const auto take = [chunk](auto& into, const auto& matrix) {
      const int first = std::min<int>(chunk * kPerChunk, static_cast<int>(matrix.cols()));
      const int last = std::min<int>(first + kPerChunk, static_cast<int>(matrix.cols()));
      for (int c = first; c < last; ++c) {
        for (int r = 0; r < matrix.rows(); ++r) {
          into.push_back(
              static_cast<typename std::decay_t<decltype(into)>::value_type>(matrix(r, c)));
        }
      }
      return static_cast<std::int32_t>(into.size());
    };
    message.rest_xyz_count = take(message.rest_xyz, corners.nodes);
    message.element_index_count = take(message.elements, corners.tetrahedra);
    message.triangle_index_count = take(message.triangles, triangles);
    if (chunk == 0) {
      for (int node : object.body.fixed_nodes) {
        if (node < corners.node_count()) message.constrained.push_back(node);
      }
    }
    message.constrained_count = static_cast<std::int32_t>(message.constrained.size());
    mesh_publisher_.reserve(message.getEncodedSize());
    mesh_.push_back(std::move(message));
  }
}

void MeshTelemetry::publish_mesh_chunk(bus::HeaderStamper& stamp, std::int64_t utime) noexcept {
  if (mesh_.empty()) return;
  shape_mesh_t& message = mesh_[next_chunk_];
  next_chunk_ = (next_chunk_ + 1) % mesh_.size();
  stamp.put(message, utime);
  mesh_publisher_.publish(message);
}

}  // namespace palpate::daemon
