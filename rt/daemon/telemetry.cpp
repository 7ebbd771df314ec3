#include "rt/daemon/telemetry.hpp"

#include <algorithm>
#include <cmath>

#include "rt/daemon/text.hpp"

namespace palpate::daemon {
namespace {

constexpr double kNotEstimated = -1;
constexpr const char* kCommandChannels[] = {"TWIST_COMMAND", "TWIST_COMMAND_1"};

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

void put(const math::Vector6d& v, double* out) noexcept { std::copy_n(v.data(), 6, out); }

}  // namespace

Telemetry::Telemetry(bus::MessageBus& control, bus::MessageBus& housekeeping,
                     const component::Pipeline& pipeline, std::int64_t session)
    : contacts_stamp_(session),
      estimate_stamp_(session),
      feature_stamp_(session),
      shape_stamp_(session),
      mesh_stamp_(session),
      contacts_(control, "CONTACTS"),
      estimate_(control, "ESTIMATE"),
      feature_(control, "FEATURE"),
      shape_(housekeeping, "SHAPE"),
      mesh_publisher_(housekeeping, "SHAPE_MESH") {
  for (int arm = 0; arm < pipeline.arm_count(); ++arm)
    commands_.emplace_back(control, kCommandChannels[arm], session);
  put_text(feature_message_.kind, pipeline.feature().kind());
  shape_message_.mesh_hash = pipeline.object().hash;
  shape_message_.node_count = pipeline.object().corners.node_count();
  shape_message_.xyz_count = 3 * shape_message_.node_count;
  shape_message_.xyz.resize(shape_message_.xyz_count);
  shape_.reserve(shape_message_.getEncodedSize());
  prepare_mesh(pipeline);
}

void Telemetry::publish_command(int arm, const control::GateOutput& gate, bool valid,
                                std::int64_t utime) noexcept {
  Command& command = commands_[arm];
  command.stamp.put(command.message, utime);
  command.message.counter = ++command.counter;
  command.message.grasp = arm;
  command.message.valid = valid ? 1 : 0;
  put(gate.V_W_E.vector(), command.message.twist);
  command.publisher.publish(command.message);
}

void Telemetry::publish_state(const component::Pipeline& pipeline, std::int64_t utime) noexcept {
  const sensing::ContactSet& contacts = pipeline.contacts();
  contacts_stamp_.put(contacts_message_, utime);
  contacts_message_.count = contacts.count;
  for (int i = 0; i < contacts.count; ++i) {
    const sensing::Contact& contact = contacts.contacts[i];
    contacts_message_.source[i] = static_cast<int>(contact.source);
    std::copy_n(contact.location.data(), 3, contacts_message_.location[i]);
    put(contact.wrench.vector(), contacts_message_.wrench[i]);
    contacts_message_.deviation[i] = contact.force_deviation;
  }
  contacts_.publish(contacts_message_);

  const estimation::Estimate& estimate = pipeline.estimate();
  estimate_stamp_.put(estimate_message_, utime);
  estimate_message_.status = static_cast<int>(estimate.step.status);
  estimate_message_.grasp_count = static_cast<int>(pipeline.object().body.grasps.size());
  for (int g = 0; g < estimate_message_.grasp_count; ++g) {
    std::copy_n(estimate.X_OG[g].translation().data(), 3, estimate_message_.grasp_position[g]);
    math::wxyz_from_rotation(estimate.X_OG[g].linear(), estimate_message_.grasp_quaternion[g]);
    put(estimate.reaction[g].vector(), estimate_message_.reaction[g]);
    std::fill_n(estimate_message_.grasp_deviation[g], 6, kNotEstimated);
    std::fill_n(estimate_message_.reaction_deviation[g], 6, kNotEstimated);
    std::fill_n(estimate_message_.bias_deviation[g], 6, kNotEstimated);
  }
  const elasticity::Material& material = pipeline.object().body.material;
  estimate_message_.log_young_modulus = std::log(material.young_modulus);
  estimate_message_.log_young_modulus_deviation = kNotEstimated;
  estimate_message_.poisson_ratio = material.poisson_ratio;
  estimate_message_.poisson_ratio_deviation = kNotEstimated;
  estimate_message_.innovation_test = kNotEstimated;
  estimate_message_.unknown_contact_deviation = kNotEstimated;
  estimate_.publish(estimate_message_);

  const component::FeatureState& feature = pipeline.feature_state();
  feature_stamp_.put(feature_message_, utime);
  feature_message_.revision = pipeline.target().revision;
  const auto copy = [](const Eigen::VectorXd& from, double(&to)[32]) noexcept {
    const int count = std::min<int>(32, static_cast<int>(from.size()));
    std::copy_n(from.data(), count, to);
    return count;
  };
  feature_message_.value_count = copy(feature.value, feature_message_.value);
  copy(pipeline.target().value, feature_message_.target);
  feature_message_.error_count = copy(feature.error, feature_message_.error);
  copy(feature.unreachable, feature_message_.unreachable);
  feature_.publish(feature_message_);
}

void Telemetry::publish_shape(component::Pipeline& pipeline, std::int64_t age_us,
                              std::int64_t utime) noexcept {
  shape_stamp_.put(shape_message_, utime);
  shape_message_.status = shape_status(pipeline.estimate().step.status);
  shape_message_.age_us = static_cast<std::int32_t>(std::min<std::int64_t>(age_us, 2'000'000'000));
  const Eigen::Matrix3Xd& x = pipeline.model().positions();
  for (int i = 0; i < shape_message_.xyz_count; ++i) {
    shape_message_.xyz[i] = static_cast<float>(x.data()[i]);
  }
  shape_.publish(shape_message_);
}

/// Chunks of at most 1,000 nodes and as many elements and triangles: below 60 kB each.
void Telemetry::prepare_mesh(const component::Pipeline& pipeline) {
  constexpr int kPerChunk = 1000;
  const component::Object& object = pipeline.object();
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

void Telemetry::publish_mesh_chunk(std::int64_t utime) noexcept {
  if (mesh_.empty()) return;
  shape_mesh_t& message = mesh_[next_chunk_];
  next_chunk_ = (next_chunk_ + 1) % mesh_.size();
  mesh_stamp_.put(message, utime);
  mesh_publisher_.publish(message);
}

}  // namespace palpate::daemon
