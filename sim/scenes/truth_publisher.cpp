#include "sim/scenes/truth_publisher.hpp"

#include <palpate/channels.hpp>

#include "core/math/fnv1a.hpp"

namespace palpate::scenes {
namespace {

std::int64_t hash(const object::Plant& plant) {
  const Eigen::Matrix3Xd& nodes = plant.rest_positions();
  math::Fnv1a fnv;
  fnv.add(nodes.data(), sizeof(double) * nodes.size());
  fnv.add(plant.elements().data(), sizeof(int) * plant.elements().size());
  return fnv.signed_value();
}

shape_mesh_t mesh_message(const object::Plant& plant) {
  const Eigen::Matrix3Xd& nodes = plant.rest_positions();
  const Eigen::MatrixXi& elements = plant.elements();
  const Eigen::Matrix3Xi& triangles = plant.surface_triangles();
  shape_mesh_t message{};
  message.mesh_hash = hash(plant);
  message.element_kind = shape_mesh_t::QUADRATIC_HEXAHEDRA;
  if (elements.rows() == 4) message.element_kind = shape_mesh_t::LINEAR_TETRAHEDRA;
  message.node_count = static_cast<std::int32_t>(nodes.cols());
  message.element_size = static_cast<std::int32_t>(elements.rows());
  message.rest_xyz.assign(nodes.data(), nodes.data() + nodes.size());
  message.elements.assign(elements.data(), elements.data() + elements.size());
  message.triangles.assign(triangles.data(), triangles.data() + triangles.size());
  message.constrained.assign(plant.clamped_nodes().begin(), plant.clamped_nodes().end());
  return message;
}

}  // namespace

TruthPublisher::TruthPublisher(bus::MessageBus& housekeeping, const object::Plant& plant,
                               std::int64_t session)
    : mesh_hash_(hash(plant)),
      shapes_(housekeeping, channel::kTruthShape, bus::Urgency::kNow, mesh_hash_,
              static_cast<int>(plant.positions().cols())),
      contacts_(housekeeping, channel::kTruthContact, session),
      touches_(housekeeping, channel::kTruthTouch, session),
      mesh_(housekeeping, channel::kTruthMesh, bus::Urgency::kNow, mesh_message(plant)),
      shape_stamp_(session),
      mesh_stamp_(session) {}

void TruthPublisher::publish_shape(const object::Plant& plant, std::int64_t utime) {
  shapes_.publish({plant.positions().data(), nullptr, shape_t::STATUS_CURRENT, 0}, shape_stamp_,
                  utime);
}

void TruthPublisher::publish_contact(const object::Plant& plant,
                                     const std::vector<math::Pose>& X_OG, std::int64_t utime) {
  truth_contact_t message{};
  for (auto& quaternion : message.grasp_quaternion) quaternion[0] = 1;
  for (int i = 0; i < plant.grasp_count(); ++i) {
    if (!plant.grasped(i)) continue;
    message.grasp_count = i + 1;
    Eigen::Map<Eigen::Vector3d>(message.grasp_position[i]) = X_OG[i].translation();
    math::wxyz_from_rotation(X_OG[i].linear(), message.grasp_quaternion[i]);
    Eigen::Map<math::Vector6d>(message.grasp_wrench[i]) = plant.hand_wrench(i).vector();
  }
  contacts_.publish(message, utime);
}

void TruthPublisher::publish_touch(const object::Plant& plant, const FingertipCoupling& fingertips,
                                   std::int64_t utime) {
  truth_touch_t message{};
  message.fingertip_count = fingertips.finger_count();
  for (int i = 0; i < fingertips.tip_count(); ++i) {
    const object::FingertipTouch& touch = plant.touch(i);
    if (!touch.touching) continue;
    const int finger = fingertips.finger(i);
    message.contact[finger] = truth_touch_t::SLIPPING;
    if (touch.sticking) message.contact[finger] = truth_touch_t::STICKING;
    Eigen::Map<Eigen::Vector3d>(message.position[finger]) = touch.point;
    Eigen::Map<Eigen::Vector3d>(message.force[finger]) = -touch.force;
    message.radius[finger] = sensors::radius_of(touch.area);
    message.slipped[finger] = touch.slipped;
  }
  touches_.publish(message, utime);
}

void TruthPublisher::publish_mesh(std::int64_t utime) {
  for (int chunk = 0; chunk < mesh_.chunks(); ++chunk) mesh_.publish_chunk(mesh_stamp_, utime);
}

}  // namespace palpate::scenes
