#include "sim/scenes/truth_publisher.hpp"

#include <algorithm>
#include <palpate/channels.hpp>

#include "core/math/fnv1a.hpp"

namespace palpate::scenes {
namespace {

/// Numbers of four bytes in one chunk; a datagram takes 60 kB.
constexpr std::size_t kChunkNumbers = 12000;

std::int64_t hash(const object::Plant& plant) {
  const Eigen::Matrix3Xd& nodes = plant.rest_positions();
  math::Fnv1a fnv;
  fnv.add(nodes.data(), sizeof(double) * nodes.size());
  fnv.add(plant.elements().data(), sizeof(int) * plant.elements().size());
  return fnv.signed_value();
}

/// Distributes `values` over as many chunks as needed, in groups that stay together; `add` receives
/// chunk, first and last.
template <class Add>
void deal(std::size_t count, std::size_t group, std::vector<shape_mesh_t>& chunks,
          std::vector<std::size_t>& room, Add add) {
  std::size_t done = 0, chunk = 0;
  while (done < count) {
    if (chunk == chunks.size()) {
      chunks.emplace_back();
      room.push_back(kChunkNumbers);
    }
    const std::size_t n = std::min(count - done, room[chunk] / group * group);
    if (n > 0) add(chunks[chunk], done, done + n);
    room[chunk] -= n;
    done += n;
    if (done < count) ++chunk;
  }
}

}  // namespace

std::vector<shape_mesh_t> mesh_chunks(const object::Plant& plant) {
  std::vector<shape_mesh_t> chunks;
  std::vector<std::size_t> room;
  const Eigen::Matrix3Xd& nodes = plant.rest_positions();
  const Eigen::MatrixXi& elements = plant.elements();
  const Eigen::Matrix3Xi& triangles = plant.surface_triangles();
  const std::vector<int>& clamped = plant.clamped_nodes();

  deal(nodes.size(), 3, chunks, room, [&](shape_mesh_t& c, std::size_t first, std::size_t last) {
    c.first_node = static_cast<std::int32_t>(first / 3);
    c.rest_xyz.assign(nodes.data() + first, nodes.data() + last);
  });
  deal(elements.size(), elements.rows(), chunks, room,
       [&](shape_mesh_t& c, std::size_t first, std::size_t last) {
         c.elements.assign(elements.data() + first, elements.data() + last);
       });
  deal(triangles.size(), 3, chunks, room,
       [&](shape_mesh_t& c, std::size_t first, std::size_t last) {
         c.triangles.assign(triangles.data() + first, triangles.data() + last);
       });
  deal(clamped.size(), 1, chunks, room, [&](shape_mesh_t& c, std::size_t first, std::size_t last) {
    c.constrained.assign(clamped.begin() + first, clamped.begin() + last);
  });
  const std::int64_t name = hash(plant);
  for (std::size_t i = 0; i < chunks.size(); ++i) {
    shape_mesh_t& c = chunks[i];
    c.mesh_hash = name;
    c.element_kind = shape_mesh_t::QUADRATIC_HEXAHEDRA;
    if (elements.rows() == 4) c.element_kind = shape_mesh_t::LINEAR_TETRAHEDRA;
    c.chunk = static_cast<std::int16_t>(i);
    c.chunks = static_cast<std::int16_t>(chunks.size());
    c.corner_count = static_cast<std::int32_t>(nodes.cols());
    c.rest_xyz_count = static_cast<std::int32_t>(c.rest_xyz.size());
    c.element_size = static_cast<std::int32_t>(elements.rows());
    c.element_index_count = static_cast<std::int32_t>(c.elements.size());
    c.triangle_index_count = static_cast<std::int32_t>(c.triangles.size());
    c.constrained_count = static_cast<std::int32_t>(c.constrained.size());
  }
  return chunks;
}

TruthPublisher::TruthPublisher(bus::MessageBus& housekeeping, const object::Plant& plant,
                               std::int64_t session)
    : shapes_(housekeeping, channel::kTruthShape),
      contacts_(housekeeping, channel::kTruthContact),
      touches_(housekeeping, channel::kTruthTouch),
      meshes_(housekeeping, channel::kTruthMesh),
      shape_stamp_(session),
      contact_stamp_(session),
      touch_stamp_(session),
      mesh_stamp_(session),
      shape_{},
      chunks_(mesh_chunks(plant)) {
  shape_.mesh_hash = chunks_.front().mesh_hash;
  shape_.status = shape_t::STATUS_CURRENT;
  shape_.node_count = static_cast<std::int32_t>(plant.positions().cols());
  shape_.xyz_count = 3 * shape_.node_count;
  shape_.xyz.resize(shape_.xyz_count);
}

void TruthPublisher::publish_shape(const object::Plant& plant, std::int64_t utime) {
  shape_stamp_.put(shape_, utime);
  std::copy_n(plant.positions().data(), shape_.xyz_count, shape_.xyz.begin());
  shapes_.publish(shape_);
}

void TruthPublisher::publish_contact(const object::Plant& plant,
                                     const std::vector<math::Pose>& X_OG, std::int64_t utime) {
  truth_contact_t message{};
  contact_stamp_.put(message, utime);
  for (auto& quaternion : message.grasp_quaternion) quaternion[0] = 1;
  for (int i = 0; i < plant.grasp_count(); ++i) {
    if (!plant.grasped(i)) continue;
    message.grasp_count = i + 1;
    Eigen::Map<Eigen::Vector3d>(message.grasp_position[i]) = X_OG[i].translation();
    math::wxyz_from_rotation(X_OG[i].linear(), message.grasp_quaternion[i]);
    Eigen::Map<math::Vector6d>(message.grasp_wrench[i]) = plant.hand_wrench(i).vector();
  }
  contacts_.publish(message);
}

void TruthPublisher::publish_touch(const object::Plant& plant, const FingertipCoupling& fingertips,
                                   std::int64_t utime) {
  truth_touch_t message{};
  touch_stamp_.put(message, utime);
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
  touches_.publish(message);
}

void TruthPublisher::publish_mesh(std::int64_t utime) {
  for (shape_mesh_t& chunk : chunks_) {
    mesh_stamp_.put(chunk, utime);
    meshes_.publish(chunk);
  }
}

}  // namespace palpate::scenes
