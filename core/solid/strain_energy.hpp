#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

namespace palpate::solid {

/// Constant of a material.
struct MaterialConstant {
  std::string name;
  std::string unit;  // SI unit, "" for a ratio
  double start = 0;  // plausible initial value
  double lower = 0;  // permitted range, bounds included
  double upper = 0;
  bool is_logarithmic = false;  // scaled logarithmically
};

/// Response of an isotropic material to the logarithms x_k of its principal stretches.
struct PrincipalStress {
  double energy = 0;             // Psi, J/m^3 of rest volume
  Eigen::Vector3d stress;        // tau_k = dPsi/dx_k: principal Kirchhoff stress, Pa
  Eigen::Matrix3d tangent;       // dtau_k/dx_l, symmetric
  Eigen::Matrix3Xd by_constant;  // derivative of tau_k with respect to the constants
};

/// Isotropic elastic material defined by its strain energy, for fitting.
///
/// The first two constants of every material are `young_modulus` E and `poisson_ratio` nu at small
/// strain, so that materials can be compared and experiments can share them; the others describe
/// the change of stiffness with strain. mu = E / (2 (1 + nu)),
/// lambda = E nu / ((1 + nu) (1 - 2 nu)), l = sum x_k = log J, q(a, x) = (exp(a x) - 1) / a:
///
///   linear         Psi = mu sum e^2 + lambda/2 (sum e)^2, e_k = exp(x_k) - 1: co-rotational
///   neo_hookean, mooney_rivlin, ogden_1, ogden_2: elasticity::stretch_laws()
///   hyperfoam_1, _2  tau_k = 2 sum_i mu_i (q(a_i, x_k) - q(a_i, -beta l)), beta = nu / (1 - 2 nu);
///                  `foam_exponent`, `foam_exponent_2`, `foam_share_2` (Storakers 1986)
///   blatz_ko       hyperfoam_1 with a = -2 (Blatz and Ko 1962)
///
/// nu = 0.5 is permitted: the term with lambda is then omitted, and the caller adds the pressure
/// that keeps l = 0.
class StrainEnergy {
 public:
  virtual ~StrainEnergy() = default;

  /// Throws std::invalid_argument, listing all names, if there is no such material.
  static std::unique_ptr<const StrainEnergy> make(const std::string& name);
  static const std::vector<std::string>& names();

  const std::string& name() const { return name_; }
  const std::vector<MaterialConstant>& constants() const { return constants_; }

  /// `constants`: as in constants(), E > 0, -1 < nu <= 0.5.
  virtual void evaluate(const Eigen::Vector3d& log_stretches, const Eigen::VectorXd& constants,
                        PrincipalStress& result) const = 0;

 protected:
  StrainEnergy(std::string name, std::vector<MaterialConstant> shape);

 private:
  std::string name_;
  std::vector<MaterialConstant> constants_;
};

/// Bar under uniaxial stress with free sides.
struct UniaxialStress {
  double stress = 0;      // nominal stress: force per rest area, Pa
  double lateral = 1;     // lateral stretch
  double by_stretch = 0;  // derivative of the stress
  double lateral_by_stretch = 0;
  Eigen::VectorXd by_constant;          // derivative of the stress
  Eigen::VectorXd lateral_by_constant;  // derivative of the lateral stretch
};

/// Finds the lateral stretch at which the sides carry no stress (nu = 0.5: that which conserves the
/// volume), and the response. False if there is none, or `stretch` is not positive.
bool respond_uniaxially(const StrainEnergy& material, const Eigen::VectorXd& constants,
                        double stretch, UniaxialStress& result);

}  // namespace palpate::solid
