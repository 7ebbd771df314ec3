#include "tools/lab/baselines/deformation/as_rigid_as_possible.hpp"

#include <Eigen/LU>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>
#include <utility>

#include "core/elasticity/comparison/lumped_body.hpp"
#include "core/math/option_check.hpp"
#include "core/math/polar.hpp"

namespace palpate::baselines {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using elasticity::Body;
using elasticity::LinearPiece;
using elasticity::StepReport;
using elasticity::StepStatus;

/// Cotangent weights of all edges, by nodes a < b, m.
std::map<std::pair<int, int>, double> cotangent_weights(const mesh::ElementMesh& mesh) {
  constexpr double kLeast = 1e-3;
  std::map<std::pair<int, int>, double> weights;
  for (const LinearPiece& piece : elasticity::linear_pieces(mesh)) {
    // From the first corner; the rows of the inverse are the gradients of the other corners.
    Matrix3d edges;
    for (int i = 0; i < 3; ++i)
      edges.col(i) = mesh.nodes.col(piece.nodes[i + 1]) - mesh.nodes.col(piece.nodes[0]);
    Eigen::Matrix<double, 4, 3> gradients;
    gradients.bottomRows<3>() = edges.inverse();
    gradients.row(0) = -gradients.bottomRows<3>().colwise().sum();
    for (int i = 0; i < 4; ++i) {
      for (int j = i + 1; j < 4; ++j) {
        const auto [a, b] = std::minmax(piece.nodes[i], piece.nodes[j]);
        weights[{a, b}] -= piece.volume * gradients.row(i).dot(gradients.row(j));
      }
    }
  }
  double largest = 0;
  for (const auto& [edge, weight] : weights) largest = std::max(largest, weight);
  for (auto& [edge, weight] : weights) weight = std::max(weight, kLeast * largest);
  return weights;
}

}  // namespace

LaplacianFactor::LaplacianFactor(const Eigen::SparseMatrix<double>& laplacian,
                                 const std::vector<bool>& given) {
  std::vector<int> free_nodes, index(given.size(), -1);
  for (int node = 0; node < static_cast<int>(given.size()); ++node) {
    if (given[node]) continue;
    index[node] = static_cast<int>(free_nodes.size());
    free_nodes.push_back(node);
  }
  const auto n = static_cast<int>(free_nodes.size());
  if (n == 0 || n == static_cast<int>(given.size())) return;
  std::vector<Eigen::Triplet<double>> entries;
  for (int k = 0; k < laplacian.outerSize(); ++k) {
    for (Eigen::SparseMatrix<double>::InnerIterator it(laplacian, k); it; ++it) {
      if (index[it.row()] >= 0 && index[it.col()] >= 0)
        entries.emplace_back(index[it.row()], index[it.col()], it.value());
    }
  }
  Eigen::SparseMatrix<double> A(n, n);
  A.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(A);
  if (factor.info() != Eigen::Success || !(factor.vectorD().minCoeff() > 0)) return;

  nodes_.resize(n);
  for (int i = 0; i < n; ++i) nodes_[factor.permutationP().indices()[i]] = free_nodes[i];
  const Eigen::SparseMatrix<double>& L = factor.matrixL().nestedExpression();
  for (int j = 0; j < n; ++j) {
    start_.push_back(static_cast<int>(row_.size()));
    for (Eigen::SparseMatrix<double>::InnerIterator it(L, j); it; ++it) {
      if (it.row() <= j) continue;
      row_.push_back(static_cast<int>(it.row()));
      lower_.push_back(it.value());
    }
    inverse_d_.push_back(1 / factor.vectorD()[j]);
  }
  start_.push_back(static_cast<int>(row_.size()));
  y_.resize(3, n);
  usable_ = true;
}

void LaplacianFactor::solve(Eigen::Matrix3Xd& b) noexcept {
  const auto n = static_cast<int>(nodes_.size());
  for (int j = 0; j < n; ++j) y_.col(j) = b.col(nodes_[j]);
  for (int j = 0; j < n; ++j) {
    const Eigen::Vector3d value = y_.col(j);
    for (int k = start_[j]; k < start_[j + 1]; ++k) y_.col(row_[k]) -= lower_[k] * value;
  }
  for (int j = n - 1; j >= 0; --j) {
    Eigen::Vector3d value = inverse_d_[j] * y_.col(j);
    for (int k = start_[j]; k < start_[j + 1]; ++k) value -= lower_[k] * y_.col(row_[k]);
    y_.col(j) = value;
    b.col(nodes_[j]) = value;
  }
}

AsRigidAsPossible::AsRigidAsPossible(Body body, const AsRigidAsPossibleOptions& options)
    : ComparisonModel(std::move(body)), options_(options) {
  math::check_option(options.iterations >= 1, "iterations", options.iterations, "at least 1");
  math::check_option(options.accuracy >= 0, "accuracy", options.accuracy, "at least 0");
  const Matrix3Xd& rest = body_.mesh.nodes;
  const int n = body_.mesh.node_count();
  scales_.assign(n, 0);
  std::vector<Eigen::Triplet<double>> entries;
  for (const auto& [nodes, weight] : cotangent_weights(body_.mesh)) {
    const auto [a, b] = nodes;
    edges_.push_back({a, b, weight, rest.col(a) - rest.col(b)});
    for (int node : {a, b}) {
      scales_[node] += weight * edges_.back().rest.squaredNorm() / 3;
      entries.emplace_back(node, node, weight);
    }
    entries.emplace_back(a, b, -weight);
    entries.emplace_back(b, a, -weight);
  }
  for (double& scale : scales_) scale = 1 / scale;
  Eigen::SparseMatrix<double> laplacian(n, n);
  laplacian.setFromTriplets(entries.begin(), entries.end());
  const auto grasps = static_cast<unsigned>(body_.grasps.size());
  for (unsigned set = 0; set < (1u << grasps); ++set) {
    std::vector<bool> given(n, false);
    for (int node : body_.fixed_nodes) given[node] = true;
    for (unsigned g = 0; g < grasps; ++g) {
      if ((set >> g & 1u) == 0) continue;
      for (int node : body_.grasps[g].nodes) given[node] = true;
    }
    factors_.emplace_back(laplacian, given);
  }
  warm_.assign(n, Eigen::Quaterniond::Identity());
  cells_.assign(n, Matrix3d::Zero());
  rotations_.assign(n, Matrix3d::Identity());
  rhs_.setZero(3, n);
}

void AsRigidAsPossible::reset() noexcept {
  ComparisonModel::reset();
  std::fill(warm_.begin(), warm_.end(), Eigen::Quaterniond::Identity());
}

/// Local step: optimal rotations for x_.
void AsRigidAsPossible::rotate() noexcept {
  for (Matrix3d& cell : cells_) cell.setZero();
  for (const Edge& edge : edges_) {
    const Matrix3d moment =
        (x_.col(edge.a) - x_.col(edge.b)) * (edge.weight * edge.rest).transpose();
    cells_[edge.a] += moment;
    cells_[edge.b] += moment;
  }
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    cells_[i] *= scales_[i];
    rotations_[i] = math::polar_rotation(cells_[i], warm_[i]);
  }
}

/// Global step: optimal positions of the free nodes for the rotations. Returns the largest
/// displacement, m.
double AsRigidAsPossible::relocate(LaplacianFactor& factor) noexcept {
  rhs_.setZero();
  for (const Edge& edge : edges_) {
    const Vector3d wanted =
        0.5 * edge.weight * ((rotations_[edge.a] + rotations_[edge.b]) * edge.rest);
    const Vector3d pull = edge.weight * (x_.col(edge.a) - x_.col(edge.b));
    rhs_.col(edge.a) += wanted - pull;
    rhs_.col(edge.b) -= wanted - pull;
  }
  factor.solve(rhs_);
  double largest = 0;
  for (int node : factor.nodes()) {
    x_.col(node) += rhs_.col(node);
    largest = std::max(largest, rhs_.col(node).squaredNorm());
  }
  return std::sqrt(largest);
}

StepReport AsRigidAsPossible::advance(double) noexcept {
  StepReport report;
  held_.place(x_);
  LaplacianFactor& factor = factors_[held_.held_set()];
  double moved = factor.is_usable() ? options_.accuracy + 1 : 0;
  while (moved > options_.accuracy && report.iterations < options_.iterations) {
    rotate();
    moved = relocate(factor);
    ++report.iterations;
  }
  report.status = moved <= options_.accuracy ? StepStatus::kConverged : StepStatus::kNotConverged;
  return report;
}

double AsRigidAsPossible::energy() noexcept {
  rotate();
  double sum = 0;
  for (const Edge& edge : edges_) {
    const Vector3d now = x_.col(edge.a) - x_.col(edge.b);
    for (int node : {edge.a, edge.b})
      sum += edge.weight * (now - rotations_[node] * edge.rest).squaredNorm();
  }
  return sum;
}

}  // namespace palpate::baselines
