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

/// Between neighbouring nodes: a face of six nodes (three corners, then the middles of its sides)
/// is divided into four triangles.
void add_triangles(const std::vector<int>& face, std::vector<std::int32_t>& triangles) {
  constexpr int kOfCorners[] = {0, 1, 2};
  constexpr int kOfSix[] = {0, 3, 5, 3, 1, 4, 5, 4, 2, 3, 4, 5};
  const auto add = [&](const auto& nodes) {
    for (const int i : nodes) triangles.push_back(face[static_cast<std::size_t>(i)]);
  };
  if (face.size() == 6) {
    add(kOfSix);
  } else {
    add(kOfCorners);
  }
}

shape_mesh_t mesh_message(const registry::Object& object) {
  const mesh::ElementMesh& mesh = object.body.mesh;
  shape_mesh_t message{};
  message.mesh_hash = object.hash;
  message.element_kind = shape_mesh_t::QUADRATIC_TETRAHEDRA;
  if (mesh.order == mesh::ElementOrder::kLinear)
    message.element_kind = shape_mesh_t::LINEAR_TETRAHEDRA;
  message.node_count = mesh.node_count();
  message.element_size = mesh.nodes_per_element();
  for (Eigen::Index i = 0; i < mesh.nodes.size(); ++i)
    message.rest_xyz.push_back(static_cast<float>(mesh.nodes.data()[i]));
  message.elements.assign(mesh.elements.data(), mesh.elements.data() + mesh.elements.size());
  for (const std::vector<int>& face : object.surface.triangle_nodes)
    add_triangles(face, message.triangles);
  message.constrained.assign(object.body.fixed_nodes.begin(), object.body.fixed_nodes.end());
  return message;
}

}  // namespace

MeshTelemetry::MeshTelemetry(bus::MessageBus& housekeeping, const registry::Object& object)
    : shape_(housekeeping, channel::kShape, bus::Urgency::kLater, object.hash,
             object.body.mesh.node_count()),
      mesh_(housekeeping, channel::kShapeMesh, bus::Urgency::kLater, mesh_message(object)) {}

void MeshTelemetry::publish_shape(const pipeline::Pipeline& pipeline, std::int64_t age_us,
                                  bus::HeaderStamper& stamp, std::int64_t utime) noexcept {
  const estimation::Estimate& estimate = pipeline.estimate();
  const std::vector<float>* deviation = estimate.node_deviation;
  shape_.publish(
      {pipeline.model().positions().data(), deviation == nullptr ? nullptr : deviation->data(),
       shape_status(estimate.step.status),
       static_cast<std::int32_t>(std::min<std::int64_t>(age_us, 2'000'000'000))},
      stamp, utime);
}

}  // namespace palpate::daemon
