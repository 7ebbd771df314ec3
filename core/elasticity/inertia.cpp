#include "core/elasticity/inertia.hpp"

#include <Eigen/SparseCore>

namespace palpate::elasticity {

Inertia::Inertia(const ElementSet& elements, const std::vector<int>& numbering, math::Team& team)
    : team_(team), energies_(static_cast<std::size_t>(team.size())) {
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
  for (int k = 0; k < mass.nonZeros(); ++k) column_.push_back(4 * mass.innerIndexPtr()[k]);
  mass_.assign(mass.valuePtr(), mass.valuePtr() + mass.nonZeros());
}

double Inertia::energy(const NodalField& v, double factor) const noexcept {
  using math::Pack4d;
  Pack4d energy{};
  for (int i = 0; i < v.cols(); ++i) {
    Pack4d sum{};
    for (int k = row_start_[i]; k < row_start_[i + 1]; ++k) {
      sum += mass_[k] * math::load(v.data() + column_[k]);
    }
    energy += sum * math::load(v.data() + 4 * i);
  }
  return 0.5 * factor * (energy[0] + energy[1] + energy[2]);
}

double Inertia::add(const NodalField& x, const NodalField& y, double factor,
                    NodalField& forces) noexcept {
  using math::Pack4d;
  const auto multiply = [&](int member, int size) {
    const math::Share own(static_cast<int>(x.cols()), member, size);
    const auto difference = [&](int offset) {
      return math::load(x.data() + offset) - math::load(y.data() + offset);
    };
    Pack4d energy{};
    for (int i = own.begin; i < own.end; ++i) {
      // two sums, so that consecutive additions are independent
      Pack4d sum{}, odd{};
      int k = row_start_[i];
      const int end = row_start_[i + 1];
      for (; k + 1 < end; k += 2) {
        sum += mass_[k] * difference(column_[k]);
        odd += mass_[k + 1] * difference(column_[k + 1]);
      }
      if (k < end) sum += mass_[k] * difference(column_[k]);
      sum = factor * (sum + odd);
      double* f = forces.data() + 4 * i;
      math::store(math::load(f) + sum, f);
      energy += sum * difference(4 * i);
    }
    energies_[member].sum = energy;
  };
  team_.run(multiply);
  Pack4d energy = energies_[0].sum;
  for (std::size_t m = 1; m < energies_.size(); ++m) energy += energies_[m].sum;
  return 0.5 * (energy[0] + energy[1] + energy[2]);
}

}  // namespace palpate::elasticity
