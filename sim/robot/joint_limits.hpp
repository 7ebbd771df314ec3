#pragma once

#include <Eigen/Core>

namespace palpate::robot {

/// Limits of joints, one entry per joint.
struct JointLimits {
  Eigen::VectorXd lower, upper;  // rad
  Eigen::VectorXd velocity;      // rad/s
  Eigen::VectorXd torque;        // N m
};

}  // namespace palpate::robot
