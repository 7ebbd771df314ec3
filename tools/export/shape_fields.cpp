#include "tools/export/shape_fields.hpp"

#include <Eigen/LU>
#include <Eigen/SparseCholesky>
#include <algorithm>

#include "core/elasticity/element_stress.hpp"
#include "core/mesh/element_mesh.hpp"
#include "tools/export/element_gradients.hpp"

namespace palpate::exporting {
namespace {

constexpr int kIterations = 12;
constexpr double kEnough = 1e-9;  // of the residual at the midpoints; ends the iteration

mesh::TetrahedralMesh tetrahedra_of(const log::MeshMessage& corners) {
  mesh::TetrahedralMesh mesh;
  mesh.nodes = corners.nodes;
  mesh.tetrahedra = corners.elements;
  return mesh;
}

Eigen::Matrix<double, 6, 1> six(const Eigen::Matrix3d& m) {
  return (Eigen::Matrix<double, 6, 1>() << m(0, 0), m(1, 1), m(2, 2), m(0, 1), m(0, 2), m(1, 2))
      .finished();
}

double equivalent(const Eigen::Matrix<double, 6, 1>& strain) {
  // von_mises is sqrt(3/2 |dev|^2); for strains the factor is sqrt(2/3 |dev|^2).
  return elasticity::von_mises(strain) * 2 / 3;
}

/// Half of the force on each midside node is assigned to either end of its side.
void spread_to_corners(const Eigen::MatrixXi& elements, Eigen::Index corners,
                       Eigen::Matrix3Xd& force) {
  for (Eigen::Index e = 0; e < elements.cols(); ++e)
    for (int m = 0; m < 6; ++m) {
      const int middle = elements(4 + m, e);
      if (middle < corners) continue;
      for (const int end : mesh::kTetrahedronEdges[m])
        force.col(elements(end, e)) += 0.5 * force.col(middle);
      force.col(middle).setZero();  // the other elements at this node then find nothing left
    }
}

}  // namespace

MidsideNodes::MidsideNodes(const log::MeshMessage& corners) : mesh_(corners) {
  const mesh::ElementMesh quadratic =
      mesh::make_element_mesh(tetrahedra_of(corners), mesh::ElementOrder::kQuadratic);
  mesh_.nodes = quadratic.nodes;
  mesh_.elements = quadratic.elements;
  gradients_ = std::make_unique<ElementGradients>(mesh_);
  const auto first = corners.nodes.cols();
  ends_.resize(static_cast<std::size_t>(mesh_.nodes.cols() - first));
  for (int e = 0; e < quadratic.element_count(); ++e)
    for (int m = 0; m < 6; ++m)
      ends_[static_cast<std::size_t>(quadratic.elements(4 + m, e) - first)] = {
          quadratic.elements(mesh::kTetrahedronEdges[m][0], e),
          quadratic.elements(mesh::kTetrahedronEdges[m][1], e)};
  std::vector<char> held(static_cast<std::size_t>(first), 0);
  for (const int node : corners.constrained) held[static_cast<std::size_t>(node)] = 1;
  unknown_.assign(static_cast<std::size_t>(mesh_.nodes.cols()), -1);
  for (std::size_t m = 0; m < ends_.size(); ++m)
    if (!held[static_cast<std::size_t>(ends_[m].first)] ||
        !held[static_cast<std::size_t>(ends_[m].second)])
      unknown_[static_cast<std::size_t>(first) + m] = unknown_count_++;
}

Eigen::Matrix3Xd MidsideNodes::halfway(const Eigen::Matrix3Xd& corners) const {
  Eigen::Matrix3Xd x(3, mesh_.nodes.cols());
  x.leftCols(corners.cols()) = corners;
  for (std::size_t m = 0; m < ends_.size(); ++m)
    x.col(corners.cols() + static_cast<Eigen::Index>(m)) =
        0.5 * (corners.col(ends_[m].first) + corners.col(ends_[m].second));
  return x;
}

Eigen::VectorXd MidsideNodes::out_of_balance(const Eigen::Matrix3Xd& x,
                                             double poisson_ratio) const {
  const Stiffness unit{1, poisson_ratio};
  Eigen::VectorXd force = Eigen::VectorXd::Zero(3 * unknown_count_);
  for (int e = 0; e < gradients_->element_count(); ++e)
    for (int p = 0; p < gradients_->points_per_element(); ++p) {
      const Eigen::Matrix3d F = gradients_->at(e, p, x);
      // P = J sigma F^-T, written without the inverse.
      const Eigen::Matrix3d P = corotational_first_stress(F, unit);
      const Eigen::MatrixX3d& gradient = gradients_->gradients(e, p);
      for (int i = 4; i < 10; ++i) {
        const int place = unknown_[static_cast<std::size_t>(mesh_.elements(i, e))];
        if (place >= 0)
          force.segment<3>(3 * place) += gradients_->volume(e, p) * P * gradient.row(i).transpose();
      }
    }
  return force;
}

Eigen::Matrix3Xd MidsideNodes::at(const Eigen::Matrix3Xd& corners, double poisson_ratio) {
  if (poisson_ratio_ != poisson_ratio) {
    elasticity::Body body;
    body.mesh.order = mesh::ElementOrder::kQuadratic;
    body.mesh.corner_count = static_cast<int>(corners.cols());
    body.mesh.nodes = mesh_.nodes;
    body.mesh.elements = mesh_.elements;
    body.material.young_modulus = 1;
    body.material.poisson_ratio = poisson_ratio;
    elements_ = std::make_unique<elasticity::ElementSet>(body);
    poisson_ratio_ = poisson_ratio;
  }
  const Eigen::Matrix3Xd straight = halfway(corners);
  if (unknown_count_ == 0) return straight;
  Eigen::Matrix3Xd x = straight;
  if (bow_.cols() == x.cols()) x += bow_;
  Eigen::VectorXd force = out_of_balance(x, poisson_ratio);
  const double enough = kEnough * out_of_balance(straight, poisson_ratio).norm() + 1e-15;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver;
  for (int k = 0; k < kIterations && force.norm() > enough; ++k) {
    std::vector<Eigen::Triplet<double>> entries;
    Eigen::MatrixXd K;
    for (int e = 0; e < elements_->element_count(); ++e) {
      elements_->stiffness(e, x, elasticity::Tangent::kSemidefinite, 0, K);
      for (int i = 4; i < 10; ++i)
        for (int j = 4; j < 10; ++j) {
          const int row = unknown_[static_cast<std::size_t>(mesh_.elements(i, e))],
                    column = unknown_[static_cast<std::size_t>(mesh_.elements(j, e))];
          if (row < 0 || column < 0) continue;
          for (int a = 0; a < 3; ++a)
            for (int b = 0; b < 3; ++b)
              entries.emplace_back(3 * row + a, 3 * column + b, K(3 * i + a, 3 * j + b));
        }
    }
    Eigen::SparseMatrix<double> matrix(3 * unknown_count_, 3 * unknown_count_);
    matrix.setFromTriplets(entries.begin(), entries.end());
    solver.compute(matrix);
    if (solver.info() != Eigen::Success) break;
    const Eigen::VectorXd step = solver.solve(force);
    bool is_better = false;
    for (double share = 1; share > 0.05 && !is_better; share /= 2) {
      Eigen::Matrix3Xd tried = x;
      for (std::size_t node = 0; node < unknown_.size(); ++node)
        if (unknown_[node] >= 0)
          tried.col(static_cast<Eigen::Index>(node)) -= share * step.segment<3>(3 * unknown_[node]);
      const Eigen::VectorXd left = out_of_balance(tried, poisson_ratio);
      is_better = left.norm() < force.norm();
      if (!is_better) continue;
      x = tried;
      force = left;
    }
    if (!is_better) break;
  }
  if (!x.allFinite()) x = straight;
  bow_ = x - straight;
  return x;
}

ShapeEvaluator::ShapeEvaluator(const log::MeshMessage& mesh, Law law)
    : law_(law),
      mesh_(mesh),
      element_volume_(Eigen::VectorXd::Zero(mesh.elements.cols())),
      node_volume_(Eigen::VectorXd::Zero(mesh.nodes.cols())) {
  if (mesh.element_kind == shape_mesh_t::QUADRATIC_TETRAHEDRA && mesh.elements.rows() == 4)
    midsides_ = std::make_unique<MidsideNodes>(mesh);
  else
    gradients_ = std::make_unique<ElementGradients>(mesh);
  for (int e = 0; e < gradients().element_count(); ++e) {
    for (int p = 0; p < gradients().points_per_element(); ++p)
      element_volume_(e) += gradients().volume(e, p);
    for (int i = 0; i < mesh_.elements.rows(); ++i)
      node_volume_(mesh_.elements(i, e)) += element_volume_(e);
  }
}

const ElementGradients& ShapeEvaluator::gradients() const {
  return midsides_ ? midsides_->gradients() : *gradients_;
}

ShapeFields ShapeEvaluator::at(const Eigen::Matrix3Xd& positions,
                               const std::optional<Stiffness>& stiffness) const {
  constexpr double kUsualPoissonRatio = 0.3;
  ShapeFields fields;
  fields.displacement = positions - mesh_.nodes;
  const Eigen::Matrix3Xd x =
      midsides_
          ? midsides_->at(positions, stiffness ? stiffness->poisson_ratio : kUsualPoissonRatio)
          : positions;
  add_strain(x, fields);
  if (stiffness) add_stress(x, *stiffness, fields);
  return fields;
}

void ShapeEvaluator::add_strain(const Eigen::Matrix3Xd& x, ShapeFields& fields) const {
  const ElementGradients& elements = gradients();
  fields.strain = Tensors::Zero(6, elements.element_count());
  fields.equivalent_strain.resize(elements.element_count());
  for (int e = 0; e < elements.element_count(); ++e) {
    for (int p = 0; p < elements.points_per_element(); ++p) {
      const Eigen::Matrix3d F = elements.at(e, p, x);
      fields.strain.col(e) += elements.volume(e, p) / element_volume_(e) *
                              six(0.5 * (F.transpose() * F - Eigen::Matrix3d::Identity()));
    }
    fields.equivalent_strain(e) = equivalent(fields.strain.col(e));
  }
}

void ShapeEvaluator::add_stress(const Eigen::Matrix3Xd& x, const Stiffness& stiffness,
                                ShapeFields& fields) const {
  const ElementGradients& elements = gradients();
  fields.stress = Tensors::Zero(6, elements.element_count());
  fields.von_mises.resize(elements.element_count());
  fields.force = Eigen::Matrix3Xd::Zero(3, x.cols());
  for (int e = 0; e < elements.element_count(); ++e) {
    double deformed = 0;
    for (int p = 0; p < elements.points_per_element(); ++p) {
      const Eigen::Matrix3d F = elements.at(e, p, x);
      const double J = std::max(F.determinant(), kSmallestVolumeShare);
      const Eigen::Matrix3d stress = cauchy_stress(law_, F, stiffness);
      const double volume = elements.volume(e, p) * J;
      deformed += volume;
      fields.stress.col(e) += volume * six(stress);
      if (F.determinant() < kSmallestVolumeShare) continue;  // numerically singular
      // Gradients in the current shape: those at rest times F^-1.
      const Eigen::MatrixX3d gradient = elements.gradients(e, p) * F.inverse();
      for (int i = 0; i < elements.elements().rows(); ++i)
        fields.force.col(elements.elements()(i, e)) +=
            volume * stress * gradient.row(i).transpose();
    }
    fields.stress.col(e) /= deformed;
    fields.von_mises(e) = elasticity::von_mises(fields.stress.col(e));
  }
  if (midsides_) spread_to_corners(elements.elements(), mesh_.nodes.cols(), fields.force);
  fields.force.conservativeResize(3, mesh_.nodes.cols());
}

Eigen::VectorXd ShapeEvaluator::at_nodes(const Eigen::VectorXd& by_element) const {
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(mesh_.nodes.cols());
  for (int e = 0; e < mesh_.elements.cols(); ++e)
    for (int i = 0; i < mesh_.elements.rows(); ++i)
      sum(mesh_.elements(i, e)) += element_volume_(e) * by_element(e);
  return (node_volume_.array() > 0).select(sum.array() / node_volume_.array().max(1e-300), 0);
}

}  // namespace palpate::exporting
