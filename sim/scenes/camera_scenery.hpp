#pragma once

#include <string>
#include <vector>

#include "sim/camera/depth_camera.hpp"
#include "sim/object/hyperelastic_plant.hpp"
#include "sim/robot/robot.hpp"
#include "sim/scenes/scene.hpp"

namespace palpate::scenes {

/// Bodies in view of a scene's camera: arms and hands as the primitive shapes of their URDF file,
/// the object, and a block of the test rig behind the clamped face.
class CameraScenery {
 public:
  CameraScenery(const Scene& scene, const std::vector<Arm>& arms);

  /// All bodies at their current poses, in W of the first arm. A copy, which another thread may
  /// render.
  std::vector<camera::Body> now(const std::vector<Arm>& arms, const object::Plant& plant) const;

 private:
  struct Visual {
    std::size_t arm;
    std::string link;
    camera::Body body;  // posed in the link
  };
  std::vector<Visual> visuals_;
  std::vector<camera::Body> still_;
  math::Pose X_WO_;
  draw::Colour object_colour_;
};

}  // namespace palpate::scenes
