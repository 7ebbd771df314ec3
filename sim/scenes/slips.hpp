#pragma once

#include <utility>
#include <vector>

#include "rt/config/node.hpp"
#include "sim/object/plant.hpp"

namespace palpate::scenes {

/// A scripted slip: a hand slides along the material, which it holds by the same nodes as before.
/// The displacement grows along half a cosine. No sensor of the hand reports it.
struct Slip {
  double at = 0;        // s, start
  double duration = 0;  // s
  int hand = 0;
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();  // m, of the hand, in its G

  /// Completed fraction of the slip at `time` (s), 0 to 1, and its rate, 1/s.
  double share(double time) const;
  double rate(double time) const;
};

/// The key `slips` of a scene: a list of {at, duration, hand, translation}. Throws config::Error,
/// also for a hand that is none of the `hands` that hold the object.
std::vector<Slip> read_slips(const config::Node& scene, int hands);

/// Slides the hands of the plant.
class Slips {
 public:
  explicit Slips(std::vector<Slip> slips) : slips_(std::move(slips)) {}

  /// Sets the displacements at this time (s), for the end of the plant's next step.
  void apply(double time, object::Plant& plant) const noexcept;

 private:
  std::vector<Slip> slips_;
};

}  // namespace palpate::scenes
