#pragma once

#include <urdf_model/model.h>
#include <urdf_world/types.h>

#include <string>

#include "core/math/rigid.hpp"

namespace palpate::registry {

/// Robot described by a URDF file; never null, has a root link. Throws std::invalid_argument with
/// the path if it cannot be read.
urdf::ModelInterfaceSharedPtr parse_urdf(const std::string& path);

/// Pose of the origin of a joint or a visual, in the file's parent frame.
math::Pose to_pose(const urdf::Pose& pose);

}  // namespace palpate::registry
