#pragma once

#include <string>

#include "tools/export/shape_follower.hpp"

namespace palpate::exporting {

/// Foxglove's messages as JSON; foxglove_schemas.hpp has their schemas.

/// foxglove.SceneUpdate of an instant, in frame O: the estimate as a surface coloured by its
/// displacement (`largest`: m, of the lightest colour), contacts as arrows, feature and target as
/// balls.
std::string estimate_scene(const Instant& instant, double largest);

/// foxglove.SceneUpdate of the true shape, as a wireframe, in frame O.
std::string truth_scene(const Instant& instant);

/// foxglove.PoseInFrame and foxglove.FrameTransform of the flange E in W.
std::string flange_pose(const robot_state_t& state, std::int64_t utime);
std::string flange_transform(const robot_state_t& state, std::int64_t utime);

/// foxglove.FrameTransform of O in W.
std::string object_transform(const math::Pose& X_WO, std::int64_t utime);

/// foxglove.PointCloud of a shape_observation_t, decoded, in W.
std::string point_cloud(const log::Record& observation, std::int64_t utime);

}  // namespace palpate::exporting
