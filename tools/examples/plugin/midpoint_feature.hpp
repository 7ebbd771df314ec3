#pragma once

#include <vector>

#include "rt/plugin/plugin.hpp"

namespace example {

/// Example of a user's feature: the midpoint of the two nodes nearest to given points of the rest
/// shape. Value and target: three coordinates in O, m.
class MidpointFeature : public palpate::plugin::PluginFeature {
 public:
  struct Options {
    Eigen::Vector3d first{0, 0, 0}, second{0, 0, 0};  // m, of the rest shape, in O
  };
  static palpate::config::OptionTable<Options> table();

  /// Throws std::invalid_argument if both points have the same node.
  MidpointFeature(const Options& options, const palpate::elasticity::Body& body);

  const char* kind() const override { return "midpoint"; }
  int dimension() const override { return 3; }
  int value_count() const override { return 3; }
  const std::vector<Eigen::Vector3d>& rest_points() const override { return rest_points_; }
  void evaluate(const Eigen::Matrix3Xd& positions, Eigen::Ref<Eigen::VectorXd> value) override;
  void error(const Eigen::Ref<const Eigen::VectorXd>& value,
             const Eigen::Ref<const Eigen::VectorXd>& target,
             Eigen::Ref<Eigen::VectorXd> error) const override;
  const std::vector<int>& support() const override { return support_; }
  const Eigen::SparseMatrix<double>& jacobian() const override { return jacobian_; }
  bool is_valid_target(const double* target, int count) const override;

 private:
  std::vector<Eigen::Vector3d> rest_points_;
  std::vector<int> support_;
  Eigen::SparseMatrix<double> jacobian_;
};

}  // namespace example
