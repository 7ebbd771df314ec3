#pragma once

#include <urdf_model/model.h>
#include <urdf_world/types.h>

#include <string>

#include "core/math/rigid.hpp"

namespace palpate::registry {

/// The robot that a URDF file describes; never null, has a root link. Throws std::invalid_argument
/// with the path where it cannot be read.
urdf::ModelInterfaceSharedPtr parse_urdf(const std::string& path);

/// Of a joint's or a visual's origin, in the frame that the file gives it in.
math::Pose to_pose(const urdf::Pose& pose);

}  // namespace palpate::registry
