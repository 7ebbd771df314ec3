#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/math/rigid.hpp"
#include "sim/object/fingertip_contact.hpp"

namespace palpate::object {

/// Object of a scene: receives the motions of hands and fingertips, returns their contact forces
/// and the ground truth of its shape. All quantities are in O. Objects that no hand can hold keep
/// the defaults.
class Plant {
 public:
  virtual ~Plant() = default;

  /// Advances by `dt` s. Hands and fingertips move at constant velocity to their commanded poses.
  virtual void step(double dt) noexcept = 0;
  virtual int substeps() const = 0;  // taken by the last step

  /// Centre and velocity of a fingertip at the end of the next step; the first call places it
  /// there.
  virtual void move_fingertip(int tip, const Eigen::Vector3d& centre,
                              const math::Twist& velocity) noexcept = 0;
  virtual int fingertip_count() const = 0;
  virtual const FingertipTouch& touch(int tip) const = 0;
  virtual Eigen::Vector3d fingertip_centre(int tip) const = 0;
  /// Wrench on the tip about its centre, mean over the last step.
  virtual math::Wrench fingertip_wrench(int tip) const = 0;

  /// Adds a force (N) on the material whose rest position is `rest_point`, until clear_forces().
  virtual void push(const Eigen::Vector3d& rest_point, const Eigen::Vector3d& force) noexcept = 0;
  virtual void clear_forces() noexcept = 0;

  virtual int grasp_count() const { return 0; }
  virtual bool grasped(int /*hand*/) const { return false; }
  /// Of hands that can open: let go of the object; hold what is between the jaws.
  virtual void open_hand(int /*hand*/) noexcept {}
  virtual void close_hand(int /*hand*/) noexcept {}
  /// Pose and velocity of a hand at the end of the next step.
  virtual void move_hand(int /*hand*/, const math::Pose& /*X_OG*/,
                         const math::Twist& /*V_O_G*/) noexcept {}
  /// Scripted slip: displacement of a hand along the material from where it first held it (m) and
  /// its rate (m/s), in its G, at the end of the next step.
  virtual void slide_hand(int /*hand*/, const Eigen::Vector3d& /*displacement_G*/,
                          const Eigen::Vector3d& /*rate_G*/) noexcept {}
  /// Wrench of the hand on the object about the origin of its G, mean over the last step.
  virtual math::Wrench hand_wrench(int /*hand*/) const { return {}; }
  /// Fraction of the pads' area that slips.
  virtual double slipping_share(int /*hand*/) const { return 0; }

  virtual const Eigen::Matrix3Xd& positions() const = 0;  // of the nodes, m
  virtual const Eigen::Matrix3Xd& rest_positions() const = 0;
  virtual const Eigen::MatrixXi& elements() const = 0;            // nodes by column: 27 or 4
  virtual const Eigen::Matrix3Xi& surface_triangles() const = 0;  // outward
  virtual const std::vector<int>& clamped_nodes() const = 0;

  /// What the object does differently from its options, for the log.
  virtual std::vector<std::string> remarks() const { return {}; }
};

}  // namespace palpate::object
