#pragma once

#include "core/shape/feature.hpp"

namespace palpate::baselines {

/// Representation of the feature whose Jacobian a method learns: the feature's own values, or
/// others preferred by its paper.
class FeatureView {
 public:
  virtual ~FeatureView() = default;
  /// Throws std::invalid_argument if the feature cannot be represented. Allocates.
  virtual void resize(const shape::Feature& feature) = 0;
  virtual int rows() const noexcept = 0;
  virtual void measure(const Eigen::VectorXd& value, Eigen::VectorXd& seen) noexcept = 0;
  /// Converts the Jacobian of the representation (rows x 6), at the last measure(), to that of the
  /// feature (dimension x 6).
  virtual void express(const Eigen::MatrixXd& J_seen, Eigen::Ref<Eigen::MatrixXd> J) noexcept = 0;
};

/// The feature's own values.
class PlainView final : public FeatureView {
 public:
  void resize(const shape::Feature& feature) override;
  int rows() const noexcept override { return rows_; }
  void measure(const Eigen::VectorXd& value, Eigen::VectorXd& seen) noexcept override {
    seen = value;
  }
  void express(const Eigen::MatrixXd& J_seen, Eigen::Ref<Eigen::MatrixXd> J) noexcept override {
    J = J_seen;
  }

 private:
  int rows_ = 0;
};

/// Throws std::invalid_argument unless errors of the feature are plain differences of its values.
void check_plain(const shape::Feature& feature);

/// The same; in addition the feature must consist of x, y, z of points.
void check_points(const shape::Feature& feature);

}  // namespace palpate::baselines
