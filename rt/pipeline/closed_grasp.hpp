#pragma once

#include <string>

#include "core/math/rigid.hpp"
#include "rt/registry/object.hpp"

namespace palpate::pipeline {

/// A hand that has closed on the object.
struct ClosedGrasp {
  int hand = 0;
  math::Pose X_OG = math::Pose::Identity();  // of the hand when it closed
};

/// What the hand holds, as parameters of the section `object` (YAML): the nodes that are between
/// its jaws while the object has these positions (3 x n, m, in O), and the pose of the hand at rest
/// that leaves them there. Throws config::Error if they are fewer than three or lie on a line.
std::string found_grasp(const registry::Object& object, const ClosedGrasp& grasp,
                        const Eigen::Matrix3Xd& positions);

}  // namespace palpate::pipeline
