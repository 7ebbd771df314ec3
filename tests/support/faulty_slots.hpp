#pragma once

#include <limits>
#include <memory>

#include "core/contact/force_transformer.hpp"
#include "core/shape/feature.hpp"

namespace palpate::support {

/// A force transformer with injectable faults; otherwise it forwards to the wrapped one.
class FaultyTransformer final : public contact::ForceTransformer {
 public:
  explicit FaultyTransformer(const bool& broken) : broken_(broken) {}
  std::unique_ptr<contact::ForceTransformer> good;

  int max_nodes() const noexcept override { return good->max_nodes(); }
  void distribute(const sensing::Contact& contact, const Eigen::Matrix3Xd& positions,
                  contact::ContactLoads& out) noexcept override {
    good->distribute(contact, positions, out);
    if (broken_) out.loads.front().force.y() = std::numeric_limits<double>::quiet_NaN();
  }

 private:
  const bool& broken_;
};

/// The same for a feature.
class FaultyFeature final : public shape::Feature {
 public:
  explicit FaultyFeature(const bool& broken) : broken_(broken) {}
  std::unique_ptr<shape::Feature> good;

  const char* kind() const noexcept override { return good->kind(); }
  int dimension() const noexcept override { return good->dimension(); }
  int value_count() const noexcept override { return good->value_count(); }
  const std::vector<Eigen::Vector3d>& rest_points() const noexcept override {
    return good->rest_points();
  }
  void evaluate(const Eigen::Matrix3Xd& positions,
                Eigen::Ref<Eigen::VectorXd> value) noexcept override {
    good->evaluate(positions, value);
    if (broken_) value[0] = std::numeric_limits<double>::infinity();
  }
  void error(const Eigen::Ref<const Eigen::VectorXd>& value,
             const Eigen::Ref<const Eigen::VectorXd>& target,
             Eigen::Ref<Eigen::VectorXd> error) const noexcept override {
    good->error(value, target, error);
  }
  const std::vector<int>& support() const noexcept override { return good->support(); }
  const Eigen::SparseMatrix<double>& jacobian() const noexcept override { return good->jacobian(); }
  bool is_valid_target(const double* target, int count) const noexcept override {
    return good->is_valid_target(target, count);
  }

 private:
  const bool& broken_;
};

}  // namespace palpate::support
