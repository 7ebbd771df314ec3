#pragma once

#include <array>

#include "core/elasticity/deformation_model.hpp"
#include "core/math/rigid.hpp"

namespace palpate::estimation {

/// Two forces on the inside of the object, spread along its longest axis between what is fixed and
/// what is held: one that is the same all along, and one that goes from -1 to 1, both over ten
/// nodes near the axis, and of weights whose magnitudes sum to 1 or less. They bend the shape as
/// smoothly as an unknown weight would. Nothing physical: they stand for what the model does not
/// know (mesh, Poisson's ratio, uneven foam), so that a shape that is seen can be met exactly.
class VirtualLoads {
 public:
  static constexpr int kCount = 2;
  static constexpr int kStates = 3 * kCount;  // N, in O, one force after the other
  using Forces = math::Vector6d;

  /// No force at all where no node is free.
  explicit VirtualLoads(const elasticity::Body& body);

  /// The model answers for them in its first contact slots from its next factor on.
  void watch(elasticity::DeformationModel& model) const noexcept;
  static bool is_known(const elasticity::Sensitivity& sensitivity) noexcept;
  /// N that move some node by as much as `distance`, m, in the direction that is softest; as much
  /// in others, since what is unknown has no direction: within its plane a plate is a hundred times
  /// as stiff as across, and its model's errors are as much smaller. None along the longest axis:
  /// points on the sides do not tell how they slide along them, so that such loads would take up
  /// whatever else is wrong and wander by millimetres unseen.
  Forces for_distance(double distance, const elasticity::Sensitivity& sensitivity) const noexcept;
  void add_to(Eigen::Matrix3Xd& loads, const Forces& forces) const noexcept;

 private:
  std::array<mesh::PointWeights, kCount> patterns_;
  int axis_ = 0;  // the longest
};

}  // namespace palpate::estimation
