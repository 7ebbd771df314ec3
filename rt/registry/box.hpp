#pragma once

#include <Eigen/Core>
#include <string>

#include "rt/config/option.hpp"

namespace palpate::registry {

/// Axis-parallel box of a configuration section with the keys `lower` and `upper`.
struct Box {
  Eigen::Vector3d lower = Eigen::Vector3d::Zero();  // m
  Eigen::Vector3d upper = Eigen::Vector3d::Zero();  // m
};

inline constexpr config::Range kAnywhere{-100, 100};  // m, in a robot cell

/// `frame`: "in W", for the descriptions.
inline config::OptionTable<Box> box_options(const std::string& frame, config::Range range = {}) {
  return config::OptionTable<Box>()
      .vector3("lower", "m", "Lowest corner of the box, " + frame, range, &Box::lower)
      .required()
      .vector3("upper", "m", "Highest corner of the box, " + frame, range, &Box::upper)
      .required();
}

}  // namespace palpate::registry
