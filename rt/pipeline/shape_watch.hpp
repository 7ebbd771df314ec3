#pragma once

#include <Eigen/Core>
#include <optional>

#include "core/collision/self_contact_scan.hpp"
#include "core/elasticity/strain_scan.hpp"
#include "core/estimation/shape_jump.hpp"
#include "rt/pipeline/life_cycle.hpp"
#include "rt/registry/object.hpp"

namespace palpate::pipeline {

/// Watches the model's shape: for discontinuities; for parts of the object that touch one another,
/// since the model lets them pass through; and for strains beyond those for which the law of the
/// material holds, where the configuration or a fit states them. Nothing allocates after
/// construction.
class ShapeWatch {
 public:
  ShapeWatch() = default;  // of no object
  explicit ShapeWatch(const registry::Object& object);

  /// Once per tick, at the model's positions. True if the shape has jumped.
  bool update(const Eigen::Matrix3Xd& positions, double dt) noexcept;
  /// Degraded while the object touches itself, and while there is such a strain, which ends below
  /// 0.9 of the limit.
  const Condition& condition() const noexcept { return condition_; }
  /// Forgets what was seen: the shape may change.
  void forget() noexcept;

 private:
  estimation::ShapeJump jump_;
  std::optional<collision::SelfContactScan> touching_;
  double largest_strain_ = 0;
  bool is_beyond_ = false;  // the law's strains
  std::optional<elasticity::StrainScan> scan_;
  Condition condition_;
};

}  // namespace palpate::pipeline
