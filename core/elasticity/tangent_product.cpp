#include "core/elasticity/tangent_product.hpp"

namespace palpate::elasticity {
namespace {
// Relative to the body's size: rounding errors in single precision stay below 1e-4.
constexpr double kMove = 2e-3;
}  // namespace

TangentProduct::TangentProduct(const Body& body, const std::vector<Lame>& materials,
                               const std::vector<int>& numbering, Precision precision)
    : forces_(make_element_forces(body.mesh, materials, numbering, precision)),
      x_(NodalField::Zero(4, body.mesh.node_count())),
      forward_(x_),
      backward_(x_) {
  const Eigen::Vector3d size =
      body.mesh.nodes.rowwise().maxCoeff() - body.mesh.nodes.rowwise().minCoeff();
  move_ = kMove * size.maxCoeff();
}

const NodalField& TangentProduct::multiply(const NodalField& x, const NodalField& column) noexcept {
  const double largest = column.cwiseAbs().maxCoeff();
  forward_.setZero();
  if (!(largest > 0)) return forward_;
  const double step = move_ / largest;
  backward_.setZero();
  x_ = x + step * column;
  forces_->add(x_, 0, forward_);
  x_ = x - step * column;
  forces_->add(x_, 0, backward_);
  forward_ = (forward_ - backward_) / (2 * step);
  return forward_;
}

}  // namespace palpate::elasticity
