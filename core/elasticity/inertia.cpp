#include "core/elasticity/inertia.hpp"

#include <Eigen/SparseCore>

namespace palpate::elasticity {

Inertia::Inertia(const ElementSet& elements, const std::vector<int>& numbering)
    : difference_(NodalField::Zero(4, static_cast<int>(numbering.size()))) {
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::MatrixXd m;
  for (int e = 0; e < elements.element_count(); ++e) {
    elements.mass(e, m);
    for (int a = 0; a < m.rows(); ++a) {
      for (int b = 0; b < m.cols(); ++b) {
        entries.emplace_back(numbering[elements.mesh().elements(a, e)],
                             numbering[elements.mesh().elements(b, e)], m(a, b));
      }
    }
  }
  const auto n = static_cast<int>(numbering.size());
  Eigen::SparseMatrix<double, Eigen::RowMajor> mass(n, n);
  mass.setFromTriplets(entries.begin(), entries.end());
  row_start_.assign(mass.outerIndexPtr(), mass.outerIndexPtr() + n + 1);
  column_.assign(mass.innerIndexPtr(), mass.innerIndexPtr() + mass.nonZeros());
  mass_.assign(mass.valuePtr(), mass.valuePtr() + mass.nonZeros());
}

double Inertia::add(const NodalField& x, const NodalField& y, double factor,
                    NodalField& forces) noexcept {
  difference_ = x - y;
  double energy = 0;
  for (int i = 0; i < difference_.cols(); ++i) {
    Eigen::Vector4d sum = Eigen::Vector4d::Zero(), odd = sum;
    int k = row_start_[i];
    const int end = row_start_[i + 1];
    for (; k + 1 < end; k += 2) {
      sum += mass_[k] * difference_.col(column_[k]);
      odd += mass_[k + 1] * difference_.col(column_[k + 1]);
    }
    if (k < end) sum += mass_[k] * difference_.col(column_[k]);
    sum = factor * (sum + odd);
    forces.col(i) += sum;
    energy += 0.5 * sum.head<3>().dot(difference_.col(i).head<3>());
  }
  return energy;
}

}  // namespace palpate::elasticity
