#pragma once

#include <utility>
#include <vector>

#include "rt/config/node.hpp"
#include "sim/object/plant.hpp"

namespace palpate::scenes {

/// A force on one point of the object by something that no sensor of the robot touches. It rises
/// and falls along half a cosine, so that it does not ring.
struct Poke {
  static constexpr double kRamp = 0.1;  // s, or half the duration where that is shorter

  double at = 0;                                    // s, when it begins
  double duration = 0;                              // s, with rise and fall
  Eigen::Vector3d point = Eigen::Vector3d::Zero();  // m, at rest, in O
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  // N, in O

  /// How much of the force acts at `time` (s), 0 to 1.
  double share(double time) const;
};

/// The key `pokes` of a scene: a list of {at, duration, point, force}. Throws config::Error, also
/// where a point lies outside the object of this size (m, from the origin of O).
std::vector<Poke> read_pokes(const config::Node& scene, const Eigen::Vector3d& size);

/// Puts the pokes on the plant, whose applied forces are theirs alone.
class Pokes {
 public:
  explicit Pokes(std::vector<Poke> pokes) : pokes_(std::move(pokes)) {}

  /// Forces of this time (s), for the plant's next step.
  void apply(double time, object::Plant& plant) noexcept;

 private:
  std::vector<Poke> pokes_;
  bool applied_ = false;
};

}  // namespace palpate::scenes
