#include "core/estimation/grasp_compliance.hpp"

#include <Eigen/Dense>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <map>
#include <utility>
#include <vector>

#include "core/elasticity/element_set.hpp"
#include "core/mesh/surface.hpp"

namespace palpate::estimation {
namespace {

using Eigen::Vector3d;
using Motions = Eigen::Matrix<double, Eigen::Dynamic, 6>;  // three rows a node

constexpr int kMostNodes = 2000;

/// Each tetrahedron is divided into eight: four at its corners, four around a diagonal of the inner
/// octahedron.
constexpr int kParts[8][4] = {{0, 4, 6, 7}, {4, 1, 5, 8}, {6, 5, 2, 9}, {7, 8, 9, 3},
                              {4, 6, 7, 9}, {4, 5, 6, 9}, {4, 8, 5, 9}, {4, 7, 8, 9}};

struct Sets {
  std::vector<bool> fixed, held;  // by node; held: by the grasp under consideration
};

Sets sets_of(const elasticity::Body& body, std::size_t grasp) {
  const auto nodes = static_cast<std::size_t>(body.mesh.node_count());
  Sets sets{std::vector<bool>(nodes, false), std::vector<bool>(nodes, false)};
  for (const int node : body.fixed_nodes) sets.fixed[static_cast<std::size_t>(node)] = true;
  for (std::size_t g = 0; g < body.grasps.size(); ++g)
    for (const int node : body.grasps[g].nodes)
      (g == grasp ? sets.held : sets.fixed)[static_cast<std::size_t>(node)] = true;
  return sets;
}

/// The same body with edges half as long. A new node belongs to a set if both its neighbours do.
elasticity::Body refined(const elasticity::Body& body, Sets& sets) {
  const mesh::ElementMesh& coarse = body.mesh;
  mesh::TetrahedralMesh corners;
  corners.nodes = coarse.nodes;
  corners.tetrahedra.resize(4, 8 * coarse.element_count());
  elasticity::Body fine = body;
  fine.element_materials.clear();
  fine.fixed_nodes.clear();
  fine.grasps.clear();
  for (int e = 0; e < coarse.element_count(); ++e) {
    for (int part = 0; part < 8; ++part) {
      Eigen::Vector4i nodes;
      for (int i = 0; i < 4; ++i) nodes[i] = coarse.elements(kParts[part][i], e);
      Eigen::Matrix<double, 3, 4> p;
      for (int i = 0; i < 4; ++i) p.col(i) = coarse.nodes.col(nodes[i]);
      if (elasticity::tetrahedron_volume(p) < 0) std::swap(nodes[2], nodes[3]);
      corners.tetrahedra.col(8 * e + part) = nodes;
      if (!body.element_materials.empty())
        fine.element_materials.push_back(body.element_materials[static_cast<std::size_t>(e)]);
    }
  }
  fine.mesh = mesh::make_element_mesh(corners, mesh::ElementOrder::kQuadratic);
  const auto count = static_cast<std::size_t>(fine.mesh.node_count());
  for (std::vector<bool>* set : {&sets.fixed, &sets.held}) {
    set->resize(count, false);
    for (int e = 0; e < fine.mesh.element_count(); ++e) {
      for (int i = 0; i < 6; ++i) {
        const auto a =
            static_cast<std::size_t>(fine.mesh.elements(mesh::kTetrahedronEdges[i][0], e));
        const auto b =
            static_cast<std::size_t>(fine.mesh.elements(mesh::kTetrahedronEdges[i][1], e));
        (*set)[static_cast<std::size_t>(fine.mesh.elements(4 + i, e))] = (*set)[a] && (*set)[b];
      }
    }
  }
  return fine;
}

/// Displacements of the nodes in `moved` for the six unit motions of G, in G: three rows per node;
/// zero for other nodes.
Motions motions(const elasticity::Body& body, const math::Pose& X_GO,
                const std::vector<bool>& moved) {
  Motions G = Motions::Zero(3 * body.mesh.node_count(), 6);
  for (int node = 0; node < body.mesh.node_count(); ++node) {
    if (!moved[static_cast<std::size_t>(node)]) continue;
    G.block<3, 3>(3 * node, 0).setIdentity();
    G.block<3, 3>(3 * node, 3) = -math::cross_matrix(X_GO * Vector3d(body.mesh.nodes.col(node)));
  }
  return G;
}

/// Distribution of the pad stiffness over the nodes: by area, lumped at the midpoints of the sides,
/// which integrates quadratic functions over a face exactly.
Eigen::VectorXd pad_shares(const elasticity::Body& body, const std::vector<bool>& held) {
  Eigen::VectorXd shares = Eigen::VectorXd::Zero(body.mesh.node_count());
  const mesh::Surface surface = mesh::extract_surface(body.mesh);
  for (const std::vector<int>& nodes : surface.triangle_nodes) {
    if (!std::all_of(nodes.begin(), nodes.begin() + 3,
                     [&](int node) { return held[static_cast<std::size_t>(node)]; }))
      continue;
    const Vector3d a = body.mesh.nodes.col(nodes[0]);
    const double area =
        0.5 * (body.mesh.nodes.col(nodes[1]) - a).cross(body.mesh.nodes.col(nodes[2]) - a).norm();
    for (std::size_t i = 3; i < 6; ++i) shares[nodes[i]] += area / 3;
  }
  return shares / shares.sum();
}

/// Stiffness of the body in the axes of G, 3 n x 3 n.
Eigen::SparseMatrix<double> stiffness(const elasticity::Body& body, const Eigen::Matrix3d& R_GO) {
  const elasticity::ElementSet elements(body);
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::MatrixXd K;
  for (int e = 0; e < elements.element_count(); ++e) {
    elements.stiffness(e, body.mesh.nodes, elasticity::Tangent::kWarped, 0, K);
    for (int a = 0; a < elements.nodes_per_element(); ++a) {
      for (int b = 0; b < elements.nodes_per_element(); ++b) {
        const Eigen::Matrix3d block = R_GO * K.block<3, 3>(3 * a, 3 * b) * R_GO.transpose();
        const int row = 3 * body.mesh.elements(a, e), column = 3 * body.mesh.elements(b, e);
        for (int i = 0; i < 3; ++i)
          for (int j = 0; j < 3; ++j) entries.emplace_back(row + i, column + j, block(i, j));
      }
    }
  }
  Eigen::SparseMatrix<double> sum(3 * body.mesh.node_count(), 3 * body.mesh.node_count());
  sum.setFromTriplets(entries.begin(), entries.end());
  return sum;
}

/// Solves K x = b for the nodes not in `given`; x is zero at the given nodes. False if the
/// remaining nodes are not supported.
bool solve(const Eigen::SparseMatrix<double>& K, const std::vector<bool>& given, Motions& x) {
  std::vector<int> places(static_cast<std::size_t>(K.cols()), -1);
  int count = 0;
  for (Eigen::Index i = 0; i < K.cols(); ++i)
    if (!given[static_cast<std::size_t>(i / 3)]) places[static_cast<std::size_t>(i)] = count++;
  std::vector<Eigen::Triplet<double>> entries;
  Motions b(count, 6);
  for (Eigen::Index column = 0; column < K.cols(); ++column) {
    const int to = places[static_cast<std::size_t>(column)];
    if (to < 0) continue;
    b.row(to) = x.row(column);
    for (Eigen::SparseMatrix<double>::InnerIterator it(K, column); it; ++it) {
      const int row = places[static_cast<std::size_t>(it.row())];
      if (row >= 0) entries.emplace_back(row, to, it.value());
    }
  }
  Eigen::SparseMatrix<double> free(count, count);
  free.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(free);
  if (factor.info() != Eigen::Success || !(factor.vectorD().minCoeff() > 0)) return false;
  b = factor.solve(b).eval();
  x.setZero();
  for (Eigen::Index i = 0; i < K.cols(); ++i) {
    const int from = places[static_cast<std::size_t>(i)];
    if (from >= 0) x.row(i) = b.row(from);
  }
  return b.allFinite();
}

/// Displacement of all nodes and wrench of the hand for unit motions of the hand, the patch moving
/// as a rigid body.
bool rigid_response(const elasticity::Body& body, const math::Pose& X_GO, const Sets& sets,
                    Motions& shape, math::Matrix6d& wrench) {
  const Eigen::SparseMatrix<double> K = stiffness(body, X_GO.linear());
  const Motions G = motions(body, X_GO, sets.held);
  std::vector<bool> given = sets.fixed;
  for (std::size_t i = 0; i < given.size(); ++i) given[i] = given[i] || sets.held[i];
  shape = -(K * G);
  if (!solve(K, given, shape)) return false;
  shape += G;
  wrench = G.transpose() * (K * shape);
  return true;
}

/// The same with the surface of the patch held by springs with a total stiffness of `pads` N/m.
bool sprung_response(const elasticity::Body& body, const math::Pose& X_GO, const Sets& sets,
                     double pads, Motions& shape) {
  Eigen::SparseMatrix<double> K = stiffness(body, X_GO.linear());
  const Eigen::VectorXd springs = pads * pad_shares(body, sets.held);
  shape = motions(body, X_GO, sets.held);
  for (int node = 0; node < body.mesh.node_count(); ++node) {
    shape.middleRows<3>(3 * node) *= springs[node];
    for (int i = 0; i < 3; ++i) K.coeffRef(3 * node + i, 3 * node + i) += springs[node];
  }
  return solve(K, sets.fixed, shape);
}

}  // namespace

math::Matrix6d grasp_compliance(const elasticity::Body& body, std::size_t grasp,
                                const math::Matrix6d& pads) {
  const bool worth = body.mesh.order == mesh::ElementOrder::kQuadratic &&
                     body.mesh.node_count() <= kMostNodes && !pads.isZero(0);
  if (!worth) return pads;
  const math::Pose X_GO = body.grasps[grasp].X_OG_rest.inverse();
  Sets sets = sets_of(body, grasp);
  if (std::find(sets.fixed.begin(), sets.fixed.end(), true) == sets.fixed.end()) return pads;
  Motions S, fine;
  math::Matrix6d wrench;
  if (!rigid_response(body, X_GO, sets, S, wrench)) return pads;
  const double springs = pads.inverse().topLeftCorner<3, 3>().trace() / 3;
  if (!sprung_response(refined(body, sets), X_GO, sets, springs, fine)) return pads;
  // the nodes of the coarse mesh come first in the fine one
  const Motions off = fine.topRows(S.rows()) - S;
  const math::Matrix6d moved = (S.transpose() * S).ldlt().solve(S.transpose() * off);
  const math::Matrix6d compliance = -moved * wrench.inverse();
  return compliance.allFinite() ? compliance : pads;
}

}  // namespace palpate::estimation
