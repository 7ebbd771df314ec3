#include "core/elasticity/element_stress.hpp"

#include <cmath>
#include <optional>
#include <stdexcept>

#include "core/elasticity/principal_kernel.hpp"
#include "core/elasticity/tetrahedron_pack.hpp"

namespace palpate::elasticity {
namespace {

using math::Pack4d;

/// (2 mu E + lambda tr(E) I) (I + E), which is symmetric.
PackSymmetric<Pack4d> kirchhoff(const PackSymmetric<Pack4d>& E, Pack4d mu, Pack4d lambda) {
  const PackSymmetric<Pack4d> squared{
      E[0] * E[0] + E[3] * E[3] + E[4] * E[4], E[3] * E[3] + E[1] * E[1] + E[5] * E[5],
      E[4] * E[4] + E[5] * E[5] + E[2] * E[2], E[0] * E[3] + E[3] * E[1] + E[4] * E[5],
      E[0] * E[4] + E[3] * E[5] + E[4] * E[2], E[3] * E[4] + E[1] * E[5] + E[5] * E[2]};
  const Pack4d pressure = lambda * (E[0] + E[1] + E[2]);
  PackSymmetric<Pack4d> stress;
  for (int k = 0; k < 6; ++k) stress[k] = 2 * mu * (E[k] + squared[k]) + pressure * E[k];
  for (int k = 0; k < 3; ++k) stress[k] += pressure;
  return stress;
}

template <int kNodes>
class PackStress final : public StressEvaluator {
 public:
  explicit PackStress(const ElementSet& elements)
      : law_(elements.materials().law),
        packs_(elements),
        elements_(elements.element_count()),
        x_(NodalField::Zero(4, elements.mesh().node_count())) {}

  void evaluate(const Eigen::Matrix3Xd& x, ElementStress& out) noexcept override {
    x_.topRows<3>() = x;
    out.cauchy.resize(6, elements_);
    out.von_mises.resize(elements_);
    for (std::size_t b = 0; b < packs_.blocks.size(); ++b) {
      evaluate(packs_.blocks[b], packs_.states[b], out);
    }
  }

 private:
  using Packs = TetrahedronPacks<kNodes>;
  using Block = typename Packs::Block;

  void evaluate(const Block& block, typename Packs::State& state, ElementStress& out) noexcept {
    constexpr double kSmallest = 0.01;  // of the volume at rest
    const auto F = block.deformation(x_);
    typename Block::template PerPoint<PackMatrix<Pack4d>> R;
    update_rotations(F, state, R);
    typename Block::template PerPoint<PackSymmetric<Pack4d>> tau;
    if (law_) {
      typename Block::template PerPoint<PrincipalAxes<Pack4d>> at;
      find_principal_axes(state, at);
      for (int p = 0; p < Block::kPoints; ++p) {
        const PrincipalResponse<Pack4d> response(*law_, block.mu(), block.lambda(), at[p].strain);
        PackVector<Pack4d> principal;
        for (int k = 0; k < 3; ++k) principal[k] = response.stress[k] * response.stretch[k];
        tau[p] = from_principal(at[p].axes, principal);
      }
    } else {
      for (int p = 0; p < Block::kPoints; ++p)
        tau[p] = kirchhoff(state[p].strain, block.mu(), block.lambda());
    }
    PackMatrix<Pack4d> sum{};
    Pack4d volume{};
    for (int p = 0; p < Block::kPoints; ++p) {
      const PackMatrix<Pack4d> stress = turned(R[p], tau[p]);
      for (int k = 0; k < 9; ++k) sum[k] += stress[k];
      const PackMatrix<Pack4d>& f = F[p];
      volume += f[0] * (f[4] * f[8] - f[5] * f[7]) - f[1] * (f[3] * f[8] - f[5] * f[6]) +
                f[2] * (f[3] * f[7] - f[4] * f[6]);
    }
    for (int lane = 0; lane < block.count(); ++lane) {
      const double deformed =
          std::max(volume[lane], kSmallest * Block::kPoints) * block.weight()[lane];
      const int e = block.first() + lane;
      out.cauchy.col(e) << sum[0][lane], sum[4][lane], sum[8][lane], sum[1][lane], sum[2][lane],
          sum[5][lane];
      out.cauchy.col(e) /= deformed;
      out.von_mises(e) = von_mises(out.cauchy.col(e));
    }
  }

  std::optional<StretchLaw> law_;
  Packs packs_;
  int elements_;
  NodalField x_;
};

}  // namespace

double von_mises(const Eigen::Matrix<double, 6, 1>& stress) {
  const Eigen::Vector3d normal = stress.head<3>();
  const Eigen::Vector3d deviator = normal.array() - normal.mean();
  return std::sqrt(1.5 * (deviator.squaredNorm() + 2 * stress.tail<3>().squaredNorm()));
}

std::unique_ptr<StressEvaluator> make_stress_evaluator(const ElementSet& elements) {
  if (elements.mesh().order == mesh::ElementOrder::kLinear) {
    return std::make_unique<PackStress<4>>(elements);
  }
  return std::make_unique<PackStress<10>>(elements);
}

ElementStress element_stress(const Body& body, const Eigen::Matrix3Xd& x) {
  body.check();
  if (x.cols() != body.mesh.node_count()) {
    throw std::invalid_argument("element stress: positions are not those of the mesh's nodes");
  }
  ElementStress stress;
  make_stress_evaluator(ElementSet(body))->evaluate(x, stress);
  return stress;
}

}  // namespace palpate::elasticity
