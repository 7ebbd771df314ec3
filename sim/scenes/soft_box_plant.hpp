#pragma once

#include <vector>

#include "sim/object/plant.hpp"
#include "sim/robot/dart_soft_body.hpp"

namespace palpate::scenes {

/// DART's soft box as the object of a scene: its core is fixed, fingertips dent its skin, no hand
/// can hold it. The last node is the centre of the core; a tetrahedron joins each skin triangle
/// with it.
class SoftBoxPlant final : public object::Plant {
 public:
  /// Only the radius of the tips is used; friction is that of the box. Throws
  /// std::invalid_argument.
  SoftBoxPlant(const robot::SoftBoxOptions& options, std::vector<object::FingertipOptions> tips);

  /// Lets the box settle with its fingertips standing still; place them before.
  void settle();

  /// DART allocates and may throw bad_alloc, which terminates the program.
  void step(double dt) noexcept override;
  int substeps() const override { return 1; }
  std::string effective_options() const { return body_.effective_options(); }
  /// Tips move at constant velocity, without rotation. First calls must be in the order of tips.
  void move_fingertip(int tip, const Eigen::Vector3d& centre,
                      const math::Twist& velocity) noexcept override;
  int fingertip_count() const override { return static_cast<int>(tips_.size()); }
  const object::FingertipTouch& touch(int tip) const override { return touches_[tip]; }
  Eigen::Vector3d fingertip_centre(int tip) const override { return body_.probe_position(tip); }
  math::Wrench fingertip_wrench(int tip) const override;

  /// Acts on the nearest vertex.
  void push(const Eigen::Vector3d& rest_point, const Eigen::Vector3d& force) noexcept override;
  void clear_forces() noexcept override;

  const Eigen::Matrix3Xd& positions() const override { return positions_; }
  const Eigen::Matrix3Xd& rest_positions() const override { return rest_; }
  const Eigen::MatrixXi& elements() const override { return elements_; }
  const Eigen::Matrix3Xi& surface_triangles() const override { return body_.surface_triangles(); }
  const std::vector<int>& clamped_nodes() const override { return clamped_; }

 private:
  void read_shape();
  void read_touch(int tip);

  double friction_;
  robot::DartSoftBody body_;
  std::vector<object::FingertipOptions> tips_;
  int placed_ = 0;  // tips that have been placed
  std::vector<Eigen::Vector3d> goals_;
  std::vector<object::FingertipTouch> touches_;
  Eigen::Matrix3Xd rest_, positions_;
  Eigen::Matrix3Xd pulls_;  // N, on the vertices
  Eigen::MatrixXi elements_;
  std::vector<int> clamped_;
};

}  // namespace palpate::scenes
