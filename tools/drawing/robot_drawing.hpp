#pragma once

#include <string>
#include <vector>

#include "core/math/rigid.hpp"

namespace palpate::drawing {

/// Primitive shape of a link.
struct LinkShape {
  int link = 0;      // in the order of RobotDrawing::place
  std::string kind;  // box, cylinder, sphere
  Eigen::Vector3d
      size;  // m. Box: edge lengths; cylinder: radius, length along z, 0; sphere: radius, 0, 0
  math::Pose X_LV;         // of the shape's centre in the link
  Eigen::Vector3d colour;  // red, green, blue, 0 to 1
};

/// The drawable part of a URDF file, and the poses of its links as a function of its joint
/// positions.
class RobotDrawing {
 public:
  /// Reads an expanded URDF file; meshes in it are omitted. Joints from the root to the link
  /// `flange` are the arm's, those beyond it the hand's, in the file's order along each chain.
  /// Throws std::invalid_argument naming the file and the defect.
  RobotDrawing(const std::string& path, const std::string& flange);

  const std::vector<LinkShape>& shapes() const { return shapes_; }
  int link_count() const { return drawn_links_; }
  int arm_joint_count() const { return arm_joints_; }
  int hand_joint_count() const { return hand_joints_; }

  /// Appends position and quaternion x, y, z, w of each link that has shapes, in the frame A in
  /// which the root has the pose `X_AW`. Joints beyond the given counts stay at zero.
  void place(const math::Pose& X_AW, const double* arm_q, int arm_count, const double* hand_q,
             int hand_count, std::vector<float>& out) const;

 private:
  enum class Motion { kFixed, kTurns, kSlides };
  struct Link {
    int parent = -1;
    math::Pose X_PL = math::Pose::Identity();  // at zero
    Motion motion = Motion::kFixed;
    Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();
    bool of_arm = false;
    int joint = -1;  // among those of arm or hand
    int drawn = -1;  // index among the links that have shapes
  };

  std::vector<Link> links_;  // parents first
  std::vector<LinkShape> shapes_;
  int drawn_links_ = 0, arm_joints_ = 0, hand_joints_ = 0;
};

}  // namespace palpate::drawing
