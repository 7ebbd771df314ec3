#pragma once

#include "core/estimation/surface_fit.hpp"

namespace palpate::estimation {

/// State that poses, wrenches and observations of the shape determine together, and how the model
/// depends on it. Wrench update, contact tracker and observation update share it.
struct FusedState {
  FusedState(int grasps, const WrenchFilter::Options& options);

  void reset() noexcept;

  /// State that the shape follows at present.
  WrenchFilter::ShapeState applied() const noexcept;
  /// Young's modulus divided by its nominal value, at present.
  double stiffness() const noexcept;
  /// Offset of a grasp from the kinematic pose of its hand, in G, at present.
  math::Pose correction(int grasp) const noexcept;

  /// Derivative of the predicted wrenches of the hands `held`, and of their bias, with respect to
  /// the states, both in O. The model's sensitivity must be valid unless there is no contact.
  WrenchFilter::Rows wrench_rows(const std::array<bool, 2>& held,
                                 const elasticity::DeformationModel& model) const noexcept;
  /// dw / df of one hand for the external contact's force.
  Eigen::Matrix<double, 6, 3> contact_response(
      int grasp, const elasticity::DeformationModel& model) const noexcept;
  SurfaceFit::Basis basis(const elasticity::DeformationModel& model) const noexcept;
  /// Part of a held grasp's predicted wrench that does not belong to the filter's mean: the
  /// corrections not yet faded in, and the virtual loads, which are not physical.
  math::Vector6d wrench_of_shift(int grasp,
                                 const elasticity::DeformationModel& model) const noexcept;
  /// Adds the force of the external contact, if there is one, to the loads of the model.
  void load_with_contact(elasticity::DeformationModel& model) const noexcept;

  WrenchFilter filter;
  PatchMotion motion;
  /// Difference between the state that the shape follows and the filter's mean: corrections by
  /// observations that are not yet faded in.
  WrenchFilter::ShapeState shift;
  /// Poses at which the model holds the grasps.
  std::array<math::Pose, 2> X_OG{math::Pose::Identity(), math::Pose::Identity()};
  mesh::PointWeights contact_point;  // location of the external contact, while there is one
};

std::array<bool, 2> held_grasps(const elasticity::DeformationModel& model, int grasps) noexcept;

}  // namespace palpate::estimation
