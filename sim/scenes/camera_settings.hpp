#pragma once

#include "rt/config/node.hpp"
#include "sim/camera/shape_camera.hpp"
#include "sim/scenes/scene.hpp"

namespace palpate::scenes {

/// A scene's key "camera": where it stands (`pose` X_WC, or `eye` and `target` in W, the middle of
/// the object at rest where it is absent), how the object is told from the rest (`segmentation`:
/// colour or truth; `box` in O; `colour`, which the object is painted with; `tolerance`; `margin`)
/// and how far apart its points are (`voxel`). The scene's object and sensors are read before.
/// Throws config::Error.
camera::ShapeCameraOptions read_camera(const config::Node& node, const Scene& scene);

/// `occlusions` of the same key: from `at` on the camera sees and sends nothing for `duration` s.
std::vector<Occlusion> read_occlusions(const config::Node& node);

}  // namespace palpate::scenes
