#pragma once

#include "core/elasticity/deformation_model.hpp"
#include "core/estimation/wrench_filter.hpp"

namespace palpate::estimation {

/// How held patches and the wrenches of their hands follow the states of a filter where a grasp
/// gives way. A model's sensitivities are those of patches that move as they are told; a hand tells
/// its patch only so much, since what lies between gives by the compliance C times the wrench w:
/// with K = dw/dxi and B = dw/dp of firmly held patches, dw = (I + K C)^-1 (K dxi + B dp) and the
/// patch moves by dxi - C dw. Pads and what grasp_give() adds both count. Nothing allocates.
class PatchMotion {
 public:
  using Wrenches = Eigen::Matrix<double, 12, 12>;

  /// No motion yet, of this many states that the shape follows (WrenchFilter::shape_size()).
  explicit PatchMotion(int shape_size);

  /// `X_OG`: where the grasps are held; `stiffness`: Young's modulus over the model's. The model's
  /// sensitivity must be valid.
  void update(const elasticity::DeformationModel& model, const WrenchFilter& filter,
              const std::array<math::Pose, 2>& X_OG, double stiffness) noexcept;

  /// Derivative, by the states that the shape follows, of what a model's sensitivities are by: rows
  /// of grasps are motions of their patches (m, rad, in O), others log E and virtual loads (N).
  const WrenchFilter::ShapeMatrix& by_state() const noexcept { return by_state_; }
  /// (I + K C)^-1, six rows a grasp: what hands feel of the wrenches of firmly held patches.
  const Wrenches& felt() const noexcept { return felt_; }
  /// Derivative, by the same, of the hands' wrenches over `stiffness`, in O, six rows a grasp.
  using WrenchRows = Eigen::Matrix<double, 12, Eigen::Dynamic, 0, 12, WrenchFilter::kMostShape>;
  const WrenchRows& wrench_by_state() const noexcept { return wrench_by_state_; }

 private:
  WrenchFilter::ShapeMatrix by_state_;
  WrenchRows wrench_by_state_;
  Wrenches felt_ = Wrenches::Identity();
};

}  // namespace palpate::estimation
