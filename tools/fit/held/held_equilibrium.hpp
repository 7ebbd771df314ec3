#pragma once

#include <utility>
#include <vector>

#include "core/elasticity/static_solver.hpp"

namespace palpate::fit {

/// Equilibrium of an object in one hand whose pads may yield: the object's patch is at
/// X_OH exp(yield), with yield = -C w in the hand's G and the wrench w of the hand on the object at
/// the origin of that G, by Newton's method over both. Derivatives are those of StaticResponse,
/// chained to the yield by the implicit function theorem.
class HeldEquilibrium {
 public:
  /// Derivatives (m, rad, N, N m) by any number of parameters.
  using Columns = Eigen::Matrix<double, 6, Eigen::Dynamic>;

  /// What the parameters change.
  struct Changes {
    Columns hand;                                       // (dp_O, rotation in O) of X_OH
    Eigen::Matrix<double, 3, Eigen::Dynamic> material;  // as Sensitivity's parameters
    std::vector<std::pair<int, math::Matrix6d>> pads;   // of C, by the parameter of that number
  };

  /// `body` must outlive this. `pads`: compliance C in G; zero: rigid.
  HeldEquilibrium(const elasticity::Body& body, const math::Matrix6d& pads)
      : body_(body), pads_(pads), solver_(body) {}

  /// With the hand at X_OH, from the shape `near` and the pads' `yield`. False if there is none.
  bool solve(const math::Pose& X_OH, const Eigen::Matrix3Xd& near, const math::Vector6d& yield,
             const elasticity::StaticOptions& options = {});
  /// Computes wrench_columns() and node_columns() of the last solution. False if its tangent is not
  /// positive definite.
  bool differentiate(const Changes& changes);

  const Eigen::Matrix3Xd& positions() const { return positions_; }
  const math::Vector6d& yield() const { return yield_; }  // m, rotation vector
  /// Of the hand on the object at the origin of the hand's G, in O.
  const math::Wrench& wrench() const { return wrench_; }
  const Columns& wrench_columns() const { return wrench_columns_; }
  /// Of a node's position, by all parameters.
  Eigen::Matrix3Xd node_columns(int node) const;

 private:
  math::Matrix6d wrench_by_yield() const;
  math::Matrix6d patch_by_yield() const;
  Columns at_hand(const Columns& patch, const Columns& hand, const Columns& wrench) const;

  const elasticity::Body& body_;
  math::Matrix6d pads_;
  elasticity::StaticSolver solver_;
  math::Pose X_OH_ = math::Pose::Identity(), X_OG_ = math::Pose::Identity();  // hand, patch
  math::Vector6d yield_ = math::Vector6d::Zero();
  Eigen::Matrix3Xd positions_;
  math::Wrench wrench_;
  elasticity::Sensitivity response_;
  Columns patch_, wrench_columns_;
  Eigen::Matrix<double, 3, Eigen::Dynamic> material_;
};

}  // namespace palpate::fit
