#include "rt/pipeline/shape_watch.hpp"

namespace palpate::pipeline {
namespace {

constexpr double kEnd = 0.9;  // of the largest strain

}  // namespace

ShapeWatch::ShapeWatch(const registry::Object& object) : jump_(object.body.mesh.nodes) {
  touching_.emplace(object.body.mesh, object.surface);
  if (!object.largest_strain) return;
  largest_strain_ = *object.largest_strain;
  scan_.emplace(object.body);
}

bool ShapeWatch::update(const Eigen::Matrix3Xd& positions, double dt) noexcept {
  if (scan_) {
    scan_->look(positions);
    is_beyond_ = scan_->largest() > (is_beyond_ ? kEnd : 1) * largest_strain_;
  }
  if (touching_) touching_->look(positions);
  if (touching_ && touching_->node() >= 0) {
    condition_ = {
        LifeCycle::kDegraded,
        "the object touches itself, and the model lets its parts pass through each other"};
  } else if (is_beyond_) {
    condition_ = {LifeCycle::kDegraded,
                  "strains exceed object.material.largest_strain, up to which the material's law "
                  "holds"};
  } else {
    condition_ = {LifeCycle::kActive, ""};
  }
  return jump_.update(positions, dt);
}

void ShapeWatch::forget() noexcept {
  jump_.forget();
  if (scan_) scan_->reset();
  if (touching_) touching_->reset();
  is_beyond_ = false;
  condition_ = {LifeCycle::kActive, ""};
}

}  // namespace palpate::pipeline
