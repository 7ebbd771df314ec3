#pragma once

#include <cstdint>
#include <palpate/truth_contact_t.hpp>
#include <palpate/truth_touch_t.hpp>
#include <vector>

#include "rt/bus/session.hpp"
#include "rt/bus/shape_chunks.hpp"
#include "rt/bus/stamped_publisher.hpp"
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

  std::int64_t mesh_hash() const { return mesh_hash_; }

 private:
  std::int64_t mesh_hash_;
  bus::ShapePublisher shapes_;
  bus::StampedPublisher<truth_contact_t> contacts_;
  bus::StampedPublisher<truth_touch_t> touches_;
  bus::MeshPublisher mesh_;
  bus::HeaderStamper shape_stamp_, mesh_stamp_;
};

}  // namespace palpate::scenes
