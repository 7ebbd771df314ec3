#pragma once

#include "rt/config/node.hpp"
#include "sim/camera/shape_camera.hpp"
#include "sim/scenes/scene.hpp"

namespace palpate::scenes {

/// A scene's key "camera": its pose (`pose` X_WC, or `eye` and `target` in W; default target is the
/// centre of the object at rest), how the object is segmented (`segmentation`: colour or truth;
/// `box` in O; `colour` of the object; `tolerance`; `margin`) and the spacing of its points
/// (`voxel`). Requires the scene's object and sensors to be read already. Throws config::Error.
camera::ShapeCameraOptions read_camera(const config::Node& node, const Scene& scene);

/// `occlusions` of the same key: the camera observes and sends nothing from `at` on for `duration`
/// s.
std::vector<Occlusion> read_occlusions(const config::Node& node);

}  // namespace palpate::scenes
