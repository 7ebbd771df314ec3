#include "rt/pipeline/shape_watch.hpp"

namespace palpate::pipeline {
namespace {

constexpr double kEnd = 0.9;  // of the largest strain

}  // namespace

ShapeWatch::ShapeWatch(const registry::Object& object) : jump_(object.body.mesh.nodes) {
  if (!object.largest_strain) return;
  largest_strain_ = *object.largest_strain;
  scan_.emplace(object.body);
}

bool ShapeWatch::update(const Eigen::Matrix3Xd& positions, double dt) noexcept {
  if (scan_) {
    scan_->look(positions);
    if (scan_->largest() > largest_strain_) {
      condition_ = {LifeCycle::kDegraded,
                    "strains exceed object.material.largest_strain, up to which the material's law "
                    "holds"};
    } else if (scan_->largest() < kEnd * largest_strain_) {
      condition_ = {LifeCycle::kActive, ""};
    }
  }
  return jump_.update(positions, dt);
}

void ShapeWatch::forget() noexcept {
  jump_.forget();
  if (scan_) scan_->reset();
  condition_ = {LifeCycle::kActive, ""};
}

}  // namespace palpate::pipeline
