#pragma once

#include <cstdint>
#include <palpate/shape_mesh_t.hpp>
#include <palpate/shape_t.hpp>
#include <palpate/truth_contact_t.hpp>
#include <palpate/truth_touch_t.hpp>
#include <vector>

#include "rt/bus/message_bus.hpp"
#include "rt/bus/session.hpp"
#include "sim/object/plant.hpp"
#include "sim/scenes/fingertips.hpp"

namespace palpate::scenes {

/// TRUTH_SHAPE, TRUTH_CONTACT, TRUTH_TOUCH and TRUTH_MESH on the housekeeping bus, for evaluation
/// only. The shape holds every node of the plant, in O.
class TruthPublisher {
 public:
  TruthPublisher(bus::MessageBus& housekeeping, const object::Plant& plant, std::int64_t session);

  void publish_shape(const object::Plant& plant, std::int64_t utime);
  /// `X_OG`: current poses of the hands, one for each grasp of the plant.
  void publish_contact(const object::Plant& plant, const std::vector<math::Pose>& X_OG,
                       std::int64_t utime);
  void publish_touch(const object::Plant& plant, const FingertipCoupling& fingertips,
                     std::int64_t utime);
  void publish_mesh(std::int64_t utime);

  std::int64_t mesh_hash() const { return shape_.mesh_hash; }

 private:
  bus::TypedPublisher<shape_t> shapes_;
  bus::TypedPublisher<truth_contact_t> contacts_;
  bus::TypedPublisher<truth_touch_t> touches_;
  bus::TypedPublisher<shape_mesh_t> meshes_;
  bus::HeaderStamper shape_stamp_, contact_stamp_, touch_stamp_, mesh_stamp_;
  shape_t shape_;
  std::vector<shape_mesh_t> chunks_;  // of the mesh, which is constant
};

/// The plant's mesh in chunks that each fit a datagram.
std::vector<shape_mesh_t> mesh_chunks(const object::Plant& plant);

}  // namespace palpate::scenes
