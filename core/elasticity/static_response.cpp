#include "core/elasticity/static_response.hpp"

namespace palpate::elasticity {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;

/// Derivatives of Lame's constants by Poisson's ratio.
std::vector<Lame> lame_by_poisson(const Body& body) {
  std::vector<Lame> all;
  for (int e = 0; e < body.mesh.element_count(); ++e) {
    const Material& m = body.material_of(e);
    const double nu = m.poisson_ratio, s = (1 + nu) * (1 - 2 * nu);
    all.push_back({-m.young_modulus / (2 * (1 + nu) * (1 + nu)),
                   m.young_modulus * (1 + 2 * nu * nu) / (s * s)});
  }
  return all;
}

}  // namespace

/// Changes p side by side: what each prescribes and what each loads, over all nodes.
struct StaticResponse::Columns {
  std::vector<Matrix3Xd> moved, loaded;
  int add(int nodes) {
    moved.emplace_back(Matrix3Xd::Zero(3, nodes));
    loaded.emplace_back(Matrix3Xd::Zero(3, nodes));
    return static_cast<int>(moved.size()) - 1;
  }
};

StaticResponse::StaticResponse(const Body& body, const ElementSet& elements,
                               const BlockPattern& pattern)
    : body_(body),
      pattern_(pattern),
      nodal_mass_(elements.nodal_mass()),
      forces_(make_element_forces(body.mesh, elements.materials(), mesh_numbering(body.mesh),
                                  Precision::kDouble)),
      poisson_forces_(make_element_forces(body.mesh, lame_by_poisson(body),
                                          mesh_numbering(body.mesh), Precision::kDouble)),
      x_(NodalField::Zero(4, body.mesh.node_count())),
      f_(x_) {}

void StaticResponse::internal_forces(ElementForces& elements, const Matrix3Xd& x, Matrix3Xd& f) {
  x_.topRows<3>() = x;
  f_.setZero();
  elements.add(x_, 0, f_);
  f = f_.topRows<3>();
}

void StaticResponse::compute(const Snapshot& at, const BlockMatrix& K,
                             const SupernodalFactor& factor, Sensitivity& out) {
  const int n = body_.mesh.node_count();
  const int grasps = static_cast<int>(body_.grasps.size());
  out.resize(n);
  Matrix3Xd internal, by_poisson;
  internal_forces(*forces_, at.positions, internal);
  internal_forces(*poisson_forces_, at.positions, by_poisson);
  const Matrix3Xd weight = at.gravity_O * nodal_mass_.transpose();
  const Matrix3Xd residual = internal - at.loads - weight;

  Columns columns;
  std::array<int, 2> motion{-1, -1};
  for (int g = 0; g < grasps; ++g) {
    if (!at.held[g]) continue;
    motion[g] = static_cast<int>(columns.moved.size());
    for (int k = 0; k < 6; ++k) {
      Matrix3Xd& u = columns.moved[columns.add(n)];
      const Vector3d axis = Vector3d::Unit(k % 3);
      for (int node : body_.grasps[g].nodes) {
        const Vector3d r = at.positions.col(node) - at.origins[g];
        u.col(node) = k < 3 ? axis : Vector3d(axis.cross(r));
      }
    }
  }
  const int parameters = columns.add(n);
  columns.loaded[parameters] = -internal;
  columns.loaded[columns.add(n)] = -by_poisson;
  columns.loaded[columns.add(n)] = weight;
  std::array<int, kContactSlots> force;
  for (int c = 0; c < kContactSlots; ++c) {
    const mesh::PointWeights& point = at.contacts[c];
    force[c] = point.count > 0 ? static_cast<int>(columns.moved.size()) : -1;
    for (int k = 0; k < 3 && point.count > 0; ++k) {
      Matrix3Xd& f = columns.loaded[columns.add(n)];
      for (int i = 0; i < point.count; ++i) f(k, point.nodes[i]) += point.weights[i];
    }
  }

  const int count = static_cast<int>(columns.moved.size());
  Eigen::MatrixXd rhs(3 * pattern_.size(), count);
  Matrix3Xd product(3, n);
  for (int j = 0; j < count; ++j) {
    K.multiply(columns.moved[j], product);
    for (int k = 0; k < pattern_.size(); ++k) {
      const int node = pattern_.node(k);
      rhs.col(j).segment<3>(3 * k) = columns.loaded[j].col(node) - product.col(node);
    }
  }
  factor.solve(rhs, at.held);

  // x' over all nodes, in place of what was prescribed.
  std::vector<std::array<math::Vector6d, 2>> wrench(count);
  for (int j = 0; j < count; ++j) {
    Matrix3Xd& x = columns.moved[j];
    for (int k = 0; k < pattern_.size(); ++k) {
      x.col(pattern_.node(k)) += rhs.col(j).segment<3>(3 * k);
    }
    K.multiply(x, product);
    product -= columns.loaded[j];
    for (int g = 0; g < grasps; ++g) {
      wrench[j][g].setZero();
      if (!at.held[g]) continue;
      const int k = j - motion[g];
      for (int node : body_.grasps[g].nodes) {
        const Vector3d r = at.positions.col(node) - at.origins[g];
        wrench[j][g].head<3>() += product.col(node);
        wrench[j][g].tail<3>() += r.cross(Vector3d(product.col(node)));
        // The lever arm turns with the hand while the force stays.
        if (k >= 3 && k < 6) {
          wrench[j][g].tail<3>() +=
              Vector3d::Unit(k - 3).cross(r).cross(Vector3d(residual.col(node)));
        }
      }
    }
  }
  const auto stacked = [&](int j) {
    return Eigen::Map<const Eigen::VectorXd>(columns.moved[j].data(), 3 * n);
  };
  for (int g = 0; g < grasps; ++g) {
    for (int k = 0; k < 6 && motion[g] >= 0; ++k) {
      out.dx_dxi[g].col(k) = stacked(motion[g] + k);
      for (int a = 0; a < grasps; ++a) out.dw_dxi[a][g].col(k) = wrench[motion[g] + k][a];
    }
    for (int k = 0; k < 3; ++k) out.dw_dparameter[g].col(k) = wrench[parameters + k][g];
    for (int c = 0; c < kContactSlots; ++c) {
      for (int k = 0; k < 3 && force[c] >= 0; ++k) {
        out.dw_dforce[g][c].col(k) = wrench[force[c] + k][g];
      }
    }
  }
  for (int k = 0; k < 3; ++k) out.dx_dparameter.col(k) = stacked(parameters + k);
  for (int c = 0; c < kContactSlots; ++c) {
    for (int k = 0; k < 3 && force[c] >= 0; ++k) out.dx_dforce[c].col(k) = stacked(force[c] + k);
  }
  out.smallest_pivot = factor.pivots(at.held).smallest;
  out.valid = true;
}

}  // namespace palpate::elasticity
