#include "sim/object/neo_hookean_solid.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>

namespace palpate::object {
namespace {

inline Pack4d greater(Pack4d a, Pack4d b) noexcept { return a > b ? a : b; }

/// l = log J, continued by its tangent below the least volume ratio, and l' = dl / dJ.
struct LogVolume {
  explicit LogVolume(Pack4d J) noexcept {
    const Pack4d guarded = greater(J, math::splat<Pack4d>(NeoHookeanSolid::kLeastVolumeRatio));
    const LogAndInverse found = log_and_inverse(guarded);
    slope = found.inverse;
    value = found.log + (J - guarded) * slope;
  }
  Pack4d value, slope;
};

inline PackTensor cofactor(const PackTensor& f) noexcept {
  return {f[4] * f[8] - f[5] * f[7], f[5] * f[6] - f[3] * f[8], f[3] * f[7] - f[4] * f[6],
          f[7] * f[2] - f[8] * f[1], f[8] * f[0] - f[6] * f[2], f[6] * f[1] - f[7] * f[0],
          f[1] * f[5] - f[2] * f[4], f[2] * f[3] - f[0] * f[5], f[0] * f[4] - f[1] * f[3]};
}

inline Pack4d square(const PackTensor& f) noexcept {
  Pack4d sum{};
  for (const Pack4d& x : f) sum += x * x;
  return sum;
}

/// First Piola-Kirchhoff stress at all points. Returns the largest modulus for a rank-one strain
/// along the most compressed direction n, mu + (mu + lambda (1 - l)) |F^-T n|^2; at rest the other
/// two directions add 2 to |F^-1|^2. In three loops, each short enough for the compiler to
/// vectorise over points.
Pack4d stress(double mu, double lambda, const ElementGradients& F, ElementGradients& P) noexcept {
  std::array<Pack4d, kGaussPoints> log_J, slope;
  for (int point = 0; point < kGaussPoints; ++point) {
    const PackTensor& f = F[point];
    P[point] = cofactor(f);
    log_J[point] = f[0] * P[point][0] + f[1] * P[point][1] + f[2] * P[point][2];
  }
  for (int point = 0; point < kGaussPoints; ++point) {
    const LogVolume volume(log_J[point]);
    log_J[point] = volume.value;
    slope[point] = volume.slope;
  }
  Pack4d modulus{};
  for (int point = 0; point < kGaussPoints; ++point) {
    const Pack4d inverse_squared = square(P[point]) * (slope[point] * slope[point]);
    const Pack4d most = greater(inverse_squared - 2, math::splat<Pack4d>(1));
    modulus = greater(mu + (mu + lambda * (1 - log_J[point])) * most, modulus);
    const Pack4d pressure = (lambda * log_J[point] - mu) * slope[point];
    for (int k = 0; k < 9; ++k) P[point][k] = mu * F[point][k] + pressure * P[point][k];
  }
  return modulus;
}

Pack4d energy_density(double mu, double lambda, const PackTensor& F) noexcept {
  const PackTensor c = cofactor(F);
  const Pack4d log_J = LogVolume(F[0] * c[0] + F[1] * c[1] + F[2] * c[2]).value;
  return 0.5 * mu * (square(F) - 3) - mu * log_J + 0.5 * lambda * log_J * log_J;
}

constexpr int kPowerIterations = 150;

/// Largest eigenvalue of M^-1 A by power iteration. `apply(direction, out)` writes A direction;
/// rows of fixed nodes must be zero.
template <class Operator>
double greatest_eigenvalue(const Eigen::VectorXd& masses, const Operator& apply) {
  std::minstd_rand generator(1);
  Eigen::Matrix3Xd direction(3, masses.size());
  for (double& value : direction.reshaped()) {
    value = static_cast<double>(generator()) / std::minstd_rand::max() - 0.5;
  }
  Eigen::Matrix3Xd image(3, masses.size());
  double eigenvalue = 0;
  for (int i = 0; i < kPowerIterations; ++i) {
    direction /= direction.norm();
    apply(direction, image);
    image.array().rowwise() /= masses.transpose().array();
    eigenvalue = image.norm();
    if (!(eigenvalue > 0)) return 0;
    direction = image;
  }
  return eigenvalue;
}

}  // namespace

NeoHookeanSolid::NeoHookeanSolid(const HexahedralGrid& grid, const SolidOptions& options)
    : material_(options.material),
      viscosity_(options.viscosity),
      maxwell_(options.material, options.maxwell, grid.element_count()) {
  if (!(viscosity_ >= 0)) throw std::invalid_argument("plant: viscosity must not be negative");
  if (options.yield) yield_ = J2Yield(material_, *options.yield, grid.element_count());
  for (int e = 0; e < grid.element_count(); e += kTogether) packs_.emplace_back(grid, e);
  for (const ModulusRegion& region : options.regions) set_modulus(grid, region);
  vary_modulus(grid, options.field);
}

template <class Change>
bool NeoHookeanSolid::change_stiffness(const HexahedralGrid& grid, const Box& box, Change change) {
  if (stiffness_.empty()) {
    Moduli even;
    even.fill(math::splat<Pack4d>(1));
    stiffness_.assign(packs_.size(), even);
  }
  bool found = false;
  for (int e = 0; e < grid.element_count(); ++e) {
    const Eigen::Vector3d lower = grid.nodes().col(grid.elements()(0, e));
    for (int point = 0; point < kGaussPoints; ++point) {
      const Eigen::Array3d at = HexahedronPack::point(point);
      const Eigen::Vector3d p = lower + (at * grid.element_size(e).array()).matrix();
      if (!box.contains(p)) continue;
      Pack4d& stiffness = stiffness_[e / kTogether][point];
      stiffness[e % kTogether] = change(stiffness[e % kTogether], p);
      found = true;
    }
  }
  return found;
}

void NeoHookeanSolid::set_modulus(const HexahedralGrid& grid, const ModulusRegion& region) {
  if (!(region.young_modulus > 0)) {
    throw std::invalid_argument("plant: the young_modulus of a region must be positive");
  }
  const double relative = region.young_modulus / material_.young_modulus();
  if (!change_stiffness(grid, region.box, [relative](double, const auto&) { return relative; }))
    throw std::invalid_argument("plant: a region of the material holds no point");
}

void NeoHookeanSolid::vary_modulus(const HexahedralGrid& grid,
                                   const StiffnessFieldOptions& options) {
  const StiffnessField field(options);
  if (options.deviation == 0) return;
  const Box everywhere{grid.nodes().rowwise().minCoeff(), grid.nodes().rowwise().maxCoeff()};
  change_stiffness(grid, everywhere, [&field](double stiffness, const Eigen::Vector3d& p) {
    return stiffness * field.factor(p);
  });
}

void NeoHookeanSolid::cut(const HexahedralGrid& grid, const Box& box) {
  if (!change_stiffness(grid, box,
                        [](double stiffness, const auto&) { return stiffness * kCutModulus; }))
    throw std::invalid_argument("plant: a cut goes through no point of the material");
}

void NeoHookeanSolid::add_viscous_stress(const ElementGradients& F, const ElementGradients& F_rate,
                                         ElementGradients& P) const noexcept {
  for (int point = 0; point < kGaussPoints; ++point) {
    const PackTensor& f = F[point];
    const PackTensor& v = F_rate[point];
    PackTensor half;  // F' dF/dt
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j)
        half[3 * i + j] = f[i] * v[j] + f[3 + i] * v[3 + j] + f[6 + i] * v[6 + j];
    }
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        Pack4d sum{};
        for (int k = 0; k < 3; ++k) sum += f[3 * i + k] * (half[3 * k + j] + half[3 * j + k]);
        P[point][3 * i + j] += viscosity_ * sum;
      }
    }
  }
}

double NeoHookeanSolid::add_forces(const Eigen::Matrix3Xd& positions,
                                   const Eigen::Matrix3Xd& velocities, double h,
                                   Eigen::Matrix3Xd& forces) noexcept {
  const double mu = material_.shear_modulus, lambda = material_.lame;
  const double modulus_at_rest = 2 * mu + lambda;
  maxwell_.set_step(h);
  double stiffening = 1;
  HexahedronPack::Vectors nodal;
  ElementGradients F, P;
  for (std::size_t n = 0; n < packs_.size(); ++n) {
    const HexahedronPack& pack = packs_[n];
    const int first = static_cast<int>(n) * kTogether;
    pack.gather(positions.data(), nodal);
    pack.gradients(nodal, F);

    Pack4d plastic = math::splat<Pack4d>(1);
    ElementGradients elastic;
    if (!yield_.empty()) {
      elastic = F;
      for (int lane = 0; lane < pack.lanes(); ++lane)
        plastic[lane] = yield_.flow(first + lane, lane, elastic);
    }
    const Pack4d modulus = stress(mu, lambda, yield_.empty() ? F : elastic, P);
    for (int lane = 0; lane < kTogether; ++lane)
      stiffening = std::max(stiffening, plastic[lane] * modulus[lane] / modulus_at_rest);

    for (int lane = 0; lane < pack.lanes() && !yield_.empty(); ++lane)
      yield_.pull_back(first + lane, lane, P);
    for (int lane = 0; lane < pack.lanes() && !maxwell_.empty(); ++lane)
      stiffening = std::max(stiffening, maxwell_.add_stress(first + lane, lane, F, P));
    for (int point = 0; point < kGaussPoints && !stiffness_.empty(); ++point)
      for (Pack4d& x : P[point]) x *= stiffness_[n][point];
    if (viscosity_ > 0) {
      ElementGradients F_rate;
      pack.gather(velocities.data(), nodal);
      pack.gradients(nodal, F_rate);
      add_viscous_stress(F, F_rate, P);
    }
    pack.divergence(P, nodal);
    pack.scatter(nodal, forces.data());
  }
  return stiffening;
}

double NeoHookeanSolid::energy(const Eigen::Matrix3Xd& positions) const noexcept {
  double total = 0;
  HexahedronPack::Vectors nodal;
  ElementGradients F;
  for (std::size_t n = 0; n < packs_.size(); ++n) {
    const HexahedronPack& pack = packs_[n];
    const int first = static_cast<int>(n) * kTogether;
    pack.gather(positions.data(), nodal);
    pack.gradients(nodal, F);
    for (int lane = 0; lane < pack.lanes() && !yield_.empty(); ++lane)
      yield_.take_out(first + lane, lane, F);
    for (int point = 0; point < kGaussPoints; ++point) {
      const Pack4d elastic = energy_density(material_.shear_modulus, material_.lame, F[point]);
      for (int lane = 0; lane < pack.lanes(); ++lane) {
        const double stiffness = stiffness_.empty() ? 1 : stiffness_[n][point][lane];
        total += HexahedronPack::weight(point) * pack.volume(lane) * stiffness *
                 (elastic[lane] + maxwell_.energy_density(first + lane, point));
      }
    }
  }
  return total;
}

double critical_step(const HexahedralGrid& grid, NeoHookeanSolid solid,
                     const Eigen::VectorXd& masses, const Eigen::VectorXd& springs,
                     const std::vector<int>& held) {
  const Eigen::Matrix3Xd still = Eigen::Matrix3Xd::Zero(3, grid.node_count());
  const auto hold = [&held](Eigen::Matrix3Xd& values, const Eigen::Matrix3Xd& at) {
    for (const int n : held) values.col(n) = at.col(n);
  };
  double shortest = std::numeric_limits<double>::infinity();
  for (int e = 0; e < grid.element_count(); ++e)
    shortest = std::min(shortest, grid.element_size(e).minCoeff());
  const double tiny = 1e-6 * shortest;
  Eigen::Matrix3Xd moved(3, grid.node_count());
  Eigen::Matrix3Xd back(3, grid.node_count());
  const double stiffest = greatest_eigenvalue(masses, [&](const auto& direction, auto& out) {
    out.setZero();
    back.setZero();
    moved = grid.nodes() - tiny * direction;
    hold(moved, grid.nodes());
    solid.add_forces(moved, still, 0, out);
    moved = grid.nodes() + tiny * direction;
    hold(moved, grid.nodes());
    solid.add_forces(moved, still, 0, back);
    out = (out - back) / (2 * tiny);
    out.array() += direction.array().rowwise() * springs.transpose().array();
    hold(out, still);
  });
  const double frequency = std::sqrt(stiffest);
  if (solid.viscosity() == 0) return 2 / frequency;

  const double damping = greatest_eigenvalue(masses, [&](const auto& direction, auto& out) {
    out.setZero();
    moved = -direction;
    hold(moved, still);
    solid.add_forces(grid.nodes(), moved, 0, out);
    hold(out, still);
  });
  const double xi = damping / (2 * frequency);
  return 2 / frequency * (std::sqrt(xi * xi + 1) - xi);
}

}  // namespace palpate::object
