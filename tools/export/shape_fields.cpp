#include "tools/export/shape_fields.hpp"

#include <Eigen/LU>
#include <algorithm>

#include "core/elasticity/element_stress.hpp"
#include "tools/export/element_gradients.hpp"

namespace palpate::exporting {
namespace {

Eigen::Matrix<double, 6, 1> six(const Eigen::Matrix3d& m) {
  return (Eigen::Matrix<double, 6, 1>() << m(0, 0), m(1, 1), m(2, 2), m(0, 1), m(0, 2), m(1, 2))
      .finished();
}

double equivalent(const Eigen::Matrix<double, 6, 1>& strain) {
  // von_mises is sqrt(3/2 |dev|^2); for strains the factor is sqrt(2/3 |dev|^2).
  return elasticity::von_mises(strain) * 2 / 3;
}

}  // namespace

ShapeEvaluator::ShapeEvaluator(const log::MeshMessage& mesh, Law law)
    : law_(law),
      mesh_(mesh),
      gradients_(mesh),
      element_volume_(Eigen::VectorXd::Zero(mesh.elements.cols())),
      node_volume_(Eigen::VectorXd::Zero(mesh.nodes.cols())) {
  for (int e = 0; e < gradients_.element_count(); ++e) {
    for (int p = 0; p < gradients_.points_per_element(); ++p)
      element_volume_(e) += gradients_.volume(e, p);
    for (int i = 0; i < mesh_.elements.rows(); ++i)
      node_volume_(mesh_.elements(i, e)) += element_volume_(e);
  }
}

ShapeFields ShapeEvaluator::at(const Eigen::Matrix3Xd& positions,
                               const std::optional<Stiffness>& stiffness) const {
  ShapeFields fields;
  fields.displacement = positions - mesh_.nodes;
  add_strain(positions, fields);
  if (stiffness) add_stress(positions, *stiffness, fields);
  return fields;
}

void ShapeEvaluator::add_strain(const Eigen::Matrix3Xd& x, ShapeFields& fields) const {
  const ElementGradients& elements = gradients_;
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
  const ElementGradients& elements = gradients_;
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
}

Eigen::VectorXd ShapeEvaluator::at_nodes(const Eigen::VectorXd& by_element) const {
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(mesh_.nodes.cols());
  for (int e = 0; e < mesh_.elements.cols(); ++e)
    for (int i = 0; i < mesh_.elements.rows(); ++i)
      sum(mesh_.elements(i, e)) += element_volume_(e) * by_element(e);
  return (node_volume_.array() > 0).select(sum.array() / node_volume_.array().max(1e-300), 0);
}

}  // namespace palpate::exporting
