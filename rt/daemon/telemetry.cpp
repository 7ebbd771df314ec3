#include "rt/daemon/telemetry.hpp"

#include <algorithm>
#include <palpate/channels.hpp>

#include "rt/bus/text.hpp"

namespace palpate::daemon {
namespace {

constexpr double kNotEstimated = -1;
constexpr const char* kCommandChannels[] = {channel::kTwistCommand, channel::kTwistCommand1};

void put(const math::Vector6d& v, double* out) noexcept { std::copy_n(v.data(), 6, out); }

/// estimate_t.status. A slot that never ran has no valid estimate.
std::int32_t estimate_status(pipeline::LifeCycle state) noexcept {
  switch (state) {
    case pipeline::LifeCycle::kActive:
      return static_cast<std::int32_t>(Status::kOk);
    case pipeline::LifeCycle::kDegraded:
      return static_cast<std::int32_t>(Status::kDegraded);
    default:
      return static_cast<std::int32_t>(Status::kFault);
  }
}

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

Telemetry::Telemetry(bus::MessageBus& control, bus::MessageBus& housekeeping,
                     const pipeline::Pipeline& pipeline, std::int64_t session,
                     const bus::Access& access)
    : unknown_stamp_(session),
      estimate_stamp_(session),
      feature_stamp_(session),
      shape_stamp_(session),
      mesh_stamp_(session),
      wrenches_(control, pipeline.arm_count(), session),
      contacts_(control, session),
      unknown_(control, channel::kUnknownContact, bus::Urgency::kLater),
      estimate_(control, channel::kEstimate, bus::Urgency::kLater),
      feature_(control, channel::kFeature, bus::Urgency::kLater),
      discrepancy_(control, session) {
  if (!pipeline.has_object()) return;
  mesh_ = std::make_unique<MeshTelemetry>(housekeeping, pipeline.object());
  for (int arm = 0; arm < pipeline.arm_count(); ++arm)
    commands_.emplace_back(control, kCommandChannels[arm], session, access);
  if (const int count = pipeline.joint_count()) {
    joints_ = std::make_unique<Command<joint_velocity_command_t>>(
        control, channel::kJointVelocityCommand, session, access);
    joints_->message.joint_count = count;
  }
  unknown_message_.force_deviation = kNotEstimated;
  take(pipeline);
}

void Telemetry::take(const pipeline::Pipeline& pipeline) noexcept {
  if (!pipeline.has_object()) return;
  bus::put_text(feature_message_.kind, pipeline.feature().kind());
}

void Telemetry::publish_command(int arm, const control::GateOutput& gate, bool valid,
                                std::int64_t utime) noexcept {
  if (commands_.empty()) return;
  if (arm == 0 && joints_ != nullptr)
    publishes_joints_ = gate.joint_velocity.size() > 0 || (publishes_joints_ && !valid);
  if (arm == 0 && publishes_joints_) {
    std::fill_n(joints_->message.dq, 16, 0.0);
    std::copy_n(gate.joint_velocity.data(), gate.joint_velocity.size(), joints_->message.dq);
    joints_->publish(arm, valid, utime);
    return;
  }
  put(gate.V_W_E.vector(), commands_[arm].message.twist);
  commands_[arm].publish(arm, valid, utime);
}

/// Published while a contact is detected, and once when it ends.
void Telemetry::publish_unknown_contact(const estimation::UnknownContact& contact,
                                        std::int64_t utime) noexcept {
  const bool is_new = contact.found || unknown_message_.force_deviation >= 0;
  if (!is_new) return;
  unknown_stamp_.put(unknown_message_, utime);
  std::copy_n(contact.location_O.data(), 3, unknown_message_.location);
  unknown_message_.location_deviation = contact.location_deviation;
  std::copy_n(contact.force_O.data(), 3, unknown_message_.force);
  unknown_message_.force_deviation = contact.deviation;
  unknown_.publish(unknown_message_);
}

void Telemetry::publish_state(const pipeline::Pipeline& pipeline, std::int64_t utime) noexcept {
  wrenches_.publish(pipeline, utime);
  if (!pipeline.has_object()) return;
  contacts_.publish(pipeline, utime);

  const estimation::Estimate& estimate = pipeline.estimate();
  estimate_stamp_.put(estimate_message_, utime);
  estimate_message_.status = estimate_status(pipeline.components().estimation_condition.state);
  estimate_message_.grasp_count = static_cast<int>(pipeline.object().body.grasps.size());
  for (int g = 0; g < estimate_message_.grasp_count; ++g) {
    std::copy_n(estimate.X_OG[g].translation().data(), 3, estimate_message_.grasp_position[g]);
    math::wxyz_from_rotation(estimate.X_OG[g].linear(), estimate_message_.grasp_quaternion[g]);
    put(estimate.reaction[g].vector(), estimate_message_.reaction[g]);
    put(estimate.bias[g], estimate_message_.bias[g]);
    put(estimate.pose_deviation[g], estimate_message_.grasp_deviation[g]);
    put(estimate.reaction_deviation[g], estimate_message_.reaction_deviation[g]);
    put(estimate.bias_deviation[g], estimate_message_.bias_deviation[g]);
  }
  estimate_message_.log_young_modulus = estimate.log_young_modulus;
  estimate_message_.log_young_modulus_deviation = estimate.log_young_modulus_deviation;
  estimate_message_.poisson_ratio = estimate.poisson_ratio;
  estimate_message_.poisson_ratio_deviation = kNotEstimated;
  estimate_message_.innovation_test = estimate.innovation_test;
  const estimation::UnknownContact& unknown = estimate.unknown_contact;
  std::copy_n(unknown.location_O.data(), 3, estimate_message_.unknown_contact_location);
  std::copy_n(unknown.force_O.data(), 3, estimate_message_.unknown_contact_force);
  estimate_message_.unknown_contact_deviation = unknown.deviation;
  estimate_.publish(estimate_message_);
  publish_unknown_contact(unknown, utime);
  discrepancy_.publish(estimate.discrepancy, estimate_message_.grasp_count, utime);

  const pipeline::FeatureState& feature = pipeline.feature_state();
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

}  // namespace palpate::daemon
