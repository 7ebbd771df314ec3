#include <cmath>

#include "core/solid/strain_energy.hpp"

namespace palpate::solid {
namespace {

using Eigen::VectorXd;

/// The co-rotational material is linear along the axis for any nu.
void respond_linearly(const VectorXd& constants, double stretch, UniaxialStress& r) {
  const double E = constants[0], nu = constants[1], strain = stretch - 1;
  r.stress = E * strain;
  r.lateral = 1 - nu * strain;
  r.by_stretch = E;
  r.lateral_by_stretch = -nu;
  r.by_constant = Eigen::Vector2d(strain, 0);
  r.lateral_by_constant = Eigen::Vector2d(0, -strain);
}

/// A pressure conserves the volume; it follows from the stress-free sides.
void respond_at_constant_volume(const StrainEnergy& material, const VectorXd& constants,
                                double stretch, UniaxialStress& r) {
  const double x = std::log(stretch);
  PrincipalStress s;
  material.evaluate({x, -x / 2, -x / 2}, constants, s);
  const double tau = s.stress[0] - s.stress[1];
  const double tau_x = (s.tangent(0, 0) - s.tangent(0, 1)) -
                       (s.tangent(1, 0) - 0.5 * (s.tangent(1, 1) + s.tangent(1, 2)));
  r.stress = tau / stretch;
  r.lateral = std::exp(-x / 2);
  r.by_stretch = (tau_x - tau) / (stretch * stretch);
  r.lateral_by_stretch = -0.5 * r.lateral / stretch;
  r.by_constant = (s.by_constant.row(0) - s.by_constant.row(1)).transpose() / stretch;
  r.by_constant[1] = 0;  // nu is constant
  r.lateral_by_constant = VectorXd::Zero(constants.size());
}

/// Newton's method for the lateral logarithmic stretch y at which tau_2(x, y, y) = 0.
bool find_lateral(const StrainEnergy& material, const VectorXd& constants, double x, double& y,
                  PrincipalStress& s) {
  constexpr int kSteps = 60;
  constexpr double kLongest = 0.3, kStretchTolerance = 1e-13;
  for (int step = 0; step < kSteps; ++step) {
    material.evaluate({x, y, y}, constants, s);
    const double slope = s.tangent(1, 1) + s.tangent(1, 2);
    if (!(slope > 0) || !std::isfinite(s.stress[1])) return false;
    double change = -s.stress[1] / slope;
    if (std::abs(change) > kLongest) change = std::copysign(kLongest, change);
    y += change;
    if (std::abs(change) < kStretchTolerance * (1 + std::abs(y))) {
      material.evaluate({x, y, y}, constants, s);
      return true;
    }
  }
  return false;
}

}  // namespace

bool respond_uniaxially(const StrainEnergy& material, const VectorXd& constants, double stretch,
                        UniaxialStress& r) {
  if (material.name() == "linear") {
    respond_linearly(constants, stretch, r);
    return true;
  }
  if (!(stretch > 0)) return false;
  if (!(constants[1] < 0.5)) {
    respond_at_constant_volume(material, constants, stretch, r);
    return true;
  }
  const double x = std::log(stretch);
  double y = -constants[1] * x;
  PrincipalStress s;
  if (!find_lateral(material, constants, x, y, s)) return false;
  const double slope = s.tangent(1, 1) + s.tangent(1, 2);
  const double coupling = s.tangent(0, 1) + s.tangent(0, 2);
  const double y_x = -s.tangent(1, 0) / slope;
  const VectorXd y_c = -s.by_constant.row(1).transpose() / slope;
  r.stress = s.stress[0] / stretch;
  r.lateral = std::exp(y);
  r.by_stretch = (s.tangent(0, 0) + coupling * y_x - s.stress[0]) / (stretch * stretch);
  r.lateral_by_stretch = r.lateral * y_x / stretch;
  r.by_constant = (s.by_constant.row(0).transpose() + coupling * y_c) / stretch;
  r.lateral_by_constant = r.lateral * y_c;
  return std::isfinite(r.stress);
}

}  // namespace palpate::solid
