#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "sim/robot/robot.hpp"

namespace palpate::robot {

inline const std::string kArmUrdf = PALPATE_SOURCE_DIR "/sim/robot/lwr_hand.urdf";

inline Eigen::VectorXd joints(std::initializer_list<double> values) {
  Eigen::VectorXd q(values.size());
  std::copy(values.begin(), values.end(), q.data());
  return q;
}

/// Hand horizontal, elbow up, far from limits and singularities.
inline Eigen::VectorXd ready_pose() { return joints({0.2, -0.4, 0.1, 1.5, -0.1, 0.35, 0.3}); }

/// Postures distributed over the arm's range, with the hand in every direction.
inline std::vector<Eigen::VectorXd> postures() {
  return {joints({0, 0, 0, 0, 0, 0, 0}), ready_pose(),
          joints({0.5, -1.0, 0.3, 1.2, 0.8, -0.9, 1.1}),
          joints({-1.2, 0.7, -0.6, -1.6, 2.0, 1.5, -2.2}),
          joints({2.0, 1.5, 1.0, 1.9, -1.3, 1.0, 0.4})};
}

}  // namespace palpate::robot
