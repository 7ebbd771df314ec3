#include "core/elasticity/static_response.hpp"

#include <Eigen/LU>
#include <utility>

namespace palpate::elasticity {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;

/// Derivatives of the Lame parameters with respect to Poisson's ratio: forces are linear in the
/// parameters with every law.
ElementMaterials materials_by_poisson(const Body& body) {
  std::vector<Lame> all;
  for (int e = 0; e < body.mesh.element_count(); ++e) {
    const Material& m = body.material_of(e);
    const double nu = m.poisson_ratio, s = (1 + nu) * (1 - 2 * nu);
    all.push_back({-m.young_modulus / (2 * (1 + nu) * (1 + nu)),
                   m.young_modulus * (1 + 2 * nu * nu) / (s * s)});
  }
  return {std::move(all), body.law};
}

}  // namespace

/// Several changes p at once: their prescribed displacements and their loads. The first column of a
/// kind that is not requested is -1.
struct StaticResponse::Columns {
  Columns(const Body& body, const Snapshot& at, int free_directions) {
    for (std::size_t g = 0; g < body.grasps.size(); ++g) {
      if (at.held[g]) motion[g] = take(6);
    }
    parameters = take(3);
    for (int c = 0; c < kContactSlots; ++c) {
      if (at.contacts[c].count > 0) force[c] = take(3);
    }
    if (!at.touching.empty()) obstacle = take(free_directions);
    const int padded = (count + 3) / 4 * 4;
    moved.setZero(3 * body.mesh.node_count(), padded);
    loaded = product = moved;
  }

  int take(int columns) {
    count += columns;
    return count - columns;
  }

  std::array<int, 2> motion{-1, -1};
  int parameters = 0;
  std::array<int, kContactSlots> force{-1, -1, -1, -1};
  int obstacle = -1;  // by free direction
  int count = 0;
  factor::NodalColumns moved, loaded;
  factor::NodalColumns product;  // K times moved
};

StaticResponse::StaticResponse(const Body& body, const ElementSet& elements,
                               const factor::BlockPattern& pattern,
                               std::vector<collision::FreeDirection> free)
    : body_(body),
      pattern_(pattern),
      free_(std::move(free)),
      nodal_mass_(elements.nodal_mass()),
      forces_(body.mesh, elements.materials()),
      poisson_forces_(body.mesh, materials_by_poisson(body)) {}

void StaticResponse::compute(const Snapshot& at, const factor::BlockMatrix& K,
                             const factor::SupernodalFactor& factor, Sensitivity& out) {
  const int free = static_cast<int>(free_.size());
  out.resize(body_.mesh.node_count(), free);
  Matrix3Xd internal, by_poisson;
  forces_.evaluate(at.positions, internal);
  poisson_forces_.evaluate(at.positions, by_poisson);
  const Matrix3Xd weight = at.gravity_O * nodal_mass_.transpose();

  Matrix3Xd external = at.loads + weight;
  for (const TouchingPoint& touching : at.touching) {
    for (int i = 0; i < touching.point.count; ++i)
      external.col(touching.point.nodes[i]) += touching.point.weights[i] * touching.force;
  }

  Columns columns(body_, at, free);
  prescribe(at, columns);
  const auto stacked = [](const Matrix3Xd& m) {
    return Eigen::Map<const Eigen::VectorXd>(m.data(), m.size());
  };
  columns.loaded.col(columns.parameters + Sensitivity::kLogYoung) = -stacked(internal);
  columns.loaded.col(columns.parameters + Sensitivity::kPoisson) = -stacked(by_poisson);
  columns.loaded.col(columns.parameters + Sensitivity::kLogDensity) = stacked(weight);
  solve(K, factor, at.held, columns);
  if (!at.touching.empty()) add_contact(at, K, factor, columns, out);

  for (int g = 0; g < 2; ++g) {
    if (columns.motion[g] >= 0) out.dx_dxi[g] = columns.moved.middleCols<6>(columns.motion[g]);
  }
  out.dx_dparameter = columns.moved.middleCols<3>(columns.parameters);
  for (int c = 0; c < kContactSlots; ++c) {
    if (columns.force[c] >= 0) out.dx_dforce[c] = columns.moved.middleCols<3>(columns.force[c]);
  }
  if (columns.obstacle >= 0) out.dx_dobstacle = columns.moved.middleCols(columns.obstacle, free);
  for (int g = 0; g < 2; ++g) {
    if (columns.motion[g] < 0) continue;
    const Wrenches w = wrenches(at, g, internal - external, columns);
    for (int b = 0; b < 2; ++b) {
      if (columns.motion[b] >= 0) out.dw_dxi[g][b] = w.middleCols<6>(columns.motion[b]);
    }
    out.dw_dparameter[g] = w.middleCols<3>(columns.parameters);
    out.reaction[g] = reaction(at, g, internal - external);
    for (int c = 0; c < kContactSlots; ++c) {
      if (columns.force[c] >= 0) out.dw_dforce[g][c] = w.middleCols<3>(columns.force[c]);
    }
    if (columns.obstacle >= 0) out.dw_dobstacle[g] = w.middleCols(columns.obstacle, free);
  }
  out.smallest_pivot = factor.pivots(at.held).smallest;
  out.valid = true;
}

/// Motions of the held patches and forces at contacts.
void StaticResponse::prescribe(const Snapshot& at, Columns& columns) const {
  for (int g = 0; g < 2; ++g) {
    if (columns.motion[g] < 0) continue;
    for (int node : body_.grasps[g].nodes) {
      auto u = columns.moved.block<3, 6>(3 * node, columns.motion[g]);
      u.leftCols<3>().setIdentity();
      u.rightCols<3>() = -math::cross_matrix(at.positions.col(node) - at.grasps[g].translation());
    }
  }
  for (int c = 0; c < kContactSlots; ++c) {
    const mesh::PointWeights& point = at.contacts[c];
    for (int i = 0; i < point.count; ++i) {
      columns.loaded.block<3, 3>(3 * point.nodes[i], columns.force[c]).diagonal().array() +=
          point.weights[i];
    }
  }
}

/// Overwrites the prescribed displacements in `moved` with x' over all nodes, and sets K x' in
/// `product`.
void StaticResponse::solve(const factor::BlockMatrix& K, const factor::SupernodalFactor& factor,
                           factor::Held held, Columns& columns) const {
  const int count = columns.count;
  K.multiply(columns.moved, columns.product);
  Eigen::MatrixXd rhs(3 * pattern_.size(), count);
  for (int k = 0; k < pattern_.size(); ++k) {
    const int row = 3 * pattern_.node(k);
    rhs.middleRows<3>(3 * k) = columns.loaded.block(row, 0, 3, count) -  //
                               columns.product.block(row, 0, 3, count);
  }
  factor.solve(rhs, held);
  for (int k = 0; k < pattern_.size(); ++k) {
    columns.moved.block(3 * pattern_.node(k), 0, 3, count) += rhs.middleRows<3>(3 * k);
  }
  K.multiply(columns.moved, columns.product);
}

namespace {

/// Law of a touching point for small changes: displacement * (u - u_obstacle) + force * f + turn *
/// n' = 0 with n' the change of the normal by rotation of the obstacle.
struct PointLaw {
  Eigen::Matrix3d displacement, force, turn;
};

PointLaw law_of(const TouchingPoint& touching) {
  PointLaw law{Eigen::Matrix3d::Identity(), Eigen::Matrix3d::Zero(), Eigen::Matrix3d::Zero()};
  if (!touching.slips) return law;
  const Vector3d& n = touching.normal;
  const double r_n = n.dot(touching.force);
  const Vector3d q = touching.force / r_n - n;  // friction relative to the normal force
  const Vector3d t1 = n.unitOrthogonal(), t2 = n.cross(t1);
  law.displacement.row(0) = n;
  // f = dr_n (n + q) + r_n (dn + dq), dn = H (u - u_obstacle) + n', dq = -n (q . dn)
  for (int row = 1; row <= 2; ++row) {
    const Vector3d& t = row == 1 ? t1 : t2;
    law.force.row(row) = t - t.dot(q) * n;
    law.turn.row(row) = -r_n * (t + t.dot(q) * q).transpose();
    law.displacement.row(row) = law.turn.row(row) * touching.normal_derivative;
  }
  return law;
}

/// By motion xi of the hand that carries the obstacle: displacement of its material point at the
/// touching point, and change of the normal there.
struct Carried {
  Eigen::Matrix<double, 3, 6> displacement, normal;
};

Carried carried(const TouchingPoint& touching, const Snapshot& at) {
  Carried by_hand;
  by_hand.displacement << Eigen::Matrix3d::Identity(),
      -math::cross_matrix(touching.position - at.grasps[touching.hand].translation());
  by_hand.normal << Eigen::Matrix3d::Zero(), -math::cross_matrix(touching.normal);
  return by_hand;
}

/// The same by motion of the obstacle in a free direction.
std::pair<Vector3d, Vector3d> displaced(const TouchingPoint& touching,
                                        const collision::FreeDirection& direction,
                                        const math::Pose& X_OB) {
  const Vector3d axis = X_OB.linear().col(direction.axis % 3);
  if (direction.axis < 3) return {axis, Vector3d::Zero()};
  return {axis.cross(touching.position - X_OB.translation()), axis.cross(touching.normal)};
}

}  // namespace

/// Adds to `moved` and `loaded` the effect of the contact forces, sets K x' in `product`, and the
/// derivatives of the contact forces.
void StaticResponse::add_contact(const Snapshot& at, const factor::BlockMatrix& K,
                                 const factor::SupernodalFactor& factor, Columns& columns,
                                 Sensitivity& out) const {
  const int count = static_cast<int>(at.touching.size());
  Eigen::MatrixXd responses = Eigen::MatrixXd::Zero(3 * pattern_.size(), 3 * count);
  for (int c = 0; c < count; ++c) {
    const mesh::PointWeights& point = at.touching[c].point;
    for (int i = 0; i < point.count; ++i) {
      const int k = pattern_.unknown(point.nodes[i]);
      if (k >= 0) responses.block<3, 3>(3 * k, 3 * c).diagonal().array() += point.weights[i];
    }
  }
  factor.solve(responses, at.held);
  Eigen::MatrixXd compliance = Eigen::MatrixXd::Zero(3 * count, 3 * count);
  // displacements of the points relative to the obstacles, first without changes of contact forces
  Eigen::MatrixXd relative = Eigen::MatrixXd::Zero(3 * count, columns.count);
  Eigen::MatrixXd normals = relative;  // changes of the normals by rotation of the obstacles
  for (int c = 0; c < count; ++c) {
    const TouchingPoint& touching = at.touching[c];
    for (int i = 0; i < touching.point.count; ++i) {
      const int node = touching.point.nodes[i], k = pattern_.unknown(node);
      const double weight = touching.point.weights[i];
      relative.middleRows<3>(3 * c) += weight * columns.moved.block(3 * node, 0, 3, columns.count);
      if (k >= 0) compliance.middleRows<3>(3 * c) += weight * responses.middleRows<3>(3 * k);
    }
    for (std::size_t k = 0; k < free_.size(); ++k) {
      if (free_[k].obstacle != touching.obstacle) continue;
      const auto [displacement, normal] =
          displaced(touching, free_[k], at.obstacles[touching.obstacle]);
      const int column = columns.obstacle + static_cast<int>(k);
      relative.block<3, 1>(3 * c, column) -= displacement;
      normals.block<3, 1>(3 * c, column) = normal;
    }
    if (touching.hand < 0 || columns.motion[touching.hand] < 0) continue;
    const Carried by_hand = carried(touching, at);
    relative.block<3, 6>(3 * c, columns.motion[touching.hand]) -= by_hand.displacement;
    normals.block<3, 6>(3 * c, columns.motion[touching.hand]) = by_hand.normal;
  }
  // Points whose forces are linearly dependent, like the nodes of a face and its centre, share them
  // by this compliance.
  const double weak = 1e-9 * compliance.trace() / (3 * count);
  Eigen::MatrixXd system(3 * count, 3 * count);
  Eigen::MatrixXd changes(3 * count, columns.count);
  for (int c = 0; c < count; ++c) {
    const PointLaw law = law_of(at.touching[c]);
    system.middleRows<3>(3 * c) = law.displacement * compliance.middleRows<3>(3 * c);
    system.block<3, 3>(3 * c, 3 * c) += law.force + weak * law.displacement;
    changes.middleRows<3>(3 * c) =
        -law.displacement * relative.middleRows<3>(3 * c) - law.turn * normals.middleRows<3>(3 * c);
  }
  changes = system.partialPivLu().solve(changes).eval();
  relative += compliance * changes;
  for (int c = 0; c < count; ++c) {
    const TouchingPoint& touching = at.touching[c];
    Eigen::RowVectorXd by_change = touching.normal.transpose() * changes.middleRows<3>(3 * c) +
                                   touching.force.transpose() * normals.middleRows<3>(3 * c);
    if (touching.slips)
      by_change +=
          touching.force.transpose() * touching.normal_derivative * relative.middleRows<3>(3 * c);
    out.dcontact_dobstacle[touching.obstacle] +=
        by_change.segment(columns.obstacle, static_cast<Eigen::Index>(free_.size()));
    for (int g = 0; g < 2; ++g) {
      if (columns.motion[g] >= 0)
        out.dcontact_dxi[touching.obstacle][g] += by_change.segment<6>(columns.motion[g]);
    }
  }
  const Eigen::MatrixXd moved = responses * changes;
  for (int k = 0; k < pattern_.size(); ++k) {
    columns.moved.block(3 * pattern_.node(k), 0, 3, columns.count) += moved.middleRows<3>(3 * k);
  }
  for (int c = 0; c < count; ++c) {
    const mesh::PointWeights& point = at.touching[c].point;
    for (int i = 0; i < point.count; ++i) {
      columns.loaded.block(3 * point.nodes[i], 0, 3, columns.count) +=
          point.weights[i] * changes.middleRows<3>(3 * c);
    }
  }
  K.multiply(columns.moved, columns.product);
}

/// Wrench of hand g. `residual`: forces that the hands must provide.
math::Vector6d StaticResponse::reaction(const Snapshot& at, int g,
                                        const Matrix3Xd& residual) const {
  math::Vector6d w = math::Vector6d::Zero();
  for (int node : body_.grasps[g].nodes) {
    const Vector3d r = at.positions.col(node) - at.grasps[g].translation();
    w.head<3>() += residual.col(node);
    w.tail<3>() += r.cross(residual.col(node));
  }
  return w;
}

/// w' of hand g, one column per change. `residual`: forces that the hands must provide.
StaticResponse::Wrenches StaticResponse::wrenches(const Snapshot& at, int g,
                                                  const Matrix3Xd& residual,
                                                  const Columns& columns) const {
  Wrenches w = Wrenches::Zero(6, columns.moved.cols());
  for (int node : body_.grasps[g].nodes) {
    const Vector3d r = at.positions.col(node) - at.grasps[g].translation();
    const factor::NodalColumns force =
        columns.product.middleRows<3>(3 * node) - columns.loaded.middleRows<3>(3 * node);
    w.topRows<3>() += force;
    w.bottomRows<3>().noalias() += math::cross_matrix(r) * force;
    // the lever arm rotates with the hand while the force is constant
    w.block<3, 3>(3, columns.motion[g] + 3) +=
        math::cross_matrix(residual.col(node)) * math::cross_matrix(r);
  }
  return w;
}

}  // namespace palpate::elasticity
