#include "core/solid/strain_energy.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "core/elasticity/stretch_response.hpp"

namespace palpate::solid {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Eigen::VectorXd;

/// mu and lambda and their derivatives; lambda = 0 for nu = 0.5.
struct Lame {
  double mu, mu_E, mu_nu;
  double lambda, lambda_E, lambda_nu;

  explicit Lame(const VectorXd& constants) {
    const double E = constants[0], nu = constants[1], a = 1 + nu, b = 1 - 2 * nu;
    mu_E = 0.5 / a;
    mu = E * mu_E;
    mu_nu = -mu / a;
    const bool is_finite = b > 0;
    lambda_E = is_finite ? nu / (a * b) : 0;
    lambda = E * lambda_E;
    lambda_nu = is_finite ? E * (1 + 2 * nu * nu) / (a * a * b * b) : 0;
  }
};

void reset(Eigen::Index constants, PrincipalStress& r) {
  r.energy = 0;
  r.stress.setZero();
  r.tangent.setZero();
  r.by_constant.setZero(3, constants);
}

class Linear final : public StrainEnergy {
 public:
  Linear() : StrainEnergy("linear", {}) {}

  void evaluate(const Vector3d& x, const VectorXd& c, PrincipalStress& r) const override {
    const Lame lame(c);
    const Vector3d stretch = x.array().exp(), e = stretch.array() - 1;
    const double trace = e.sum();
    r.energy = lame.mu * e.squaredNorm() + lame.lambda * trace * trace / 2;
    r.stress = stretch.array() * (2 * lame.mu * e.array() + lame.lambda * trace);
    r.tangent = lame.lambda * stretch * stretch.transpose();
    r.tangent.diagonal().array() += r.stress.array() + 2 * lame.mu * stretch.array().square();
    r.by_constant.resize(3, 2);
    r.by_constant.col(0) = r.stress / c[0];
    r.by_constant.col(1) = stretch.array() * (2 * lame.mu_nu * e.array() + lame.lambda_nu * trace);
  }
};

/// Laws of the form of StretchLaw.
class Stretches final : public StrainEnergy {
 public:
  explicit Stretches(const elasticity::NamedStretchLaw& named)
      : StrainEnergy(named.name, shape(named)), named_(named) {}

  void evaluate(const Vector3d& x, const VectorXd& c, PrincipalStress& r) const override {
    const Lame lame(c);
    const Logs logs{x[0], x[1], x[2]};
    std::vector<double> shape(c.data() + 2, c.data() + c.size());
    const elasticity::StretchLaw law = named_.make(shape);
    const auto found = elasticity::respond(law, lame.mu, lame.lambda, logs);
    r.energy = found.energy;
    r.stress = Eigen::Map<const Vector3d>(found.stress.data());
    const auto& [xx, yy, zz, xy, xz, yz] = found.tangent;
    r.tangent << xx, xy, xz, xy, yy, yz, xz, yz, zz;
    r.by_constant.resize(3, c.size());
    r.by_constant.col(0) = r.stress / c[0];
    r.by_constant.col(1) = lame.mu_nu * shear_stress(law, logs).array() + lame.lambda_nu * x.sum();
    for (int i = 0; i < named_.exponents; ++i) {
      for (int k = 0; k < 3; ++k) {
        const elasticity::PowerTerm<double> q(law.exponents[i], x[k]);
        r.by_constant(k, 2 + i) = 2 * lame.mu * law.shares[i] * q.by_exponent();
      }
    }
    for (std::size_t i = named_.exponents; i < shape.size(); ++i) {
      // the stress is linear in the shares
      shape[i] = 1;
      const Vector3d all = shear_stress(named_.make(shape), logs);
      shape[i] = 0;
      r.by_constant.col(2 + static_cast<Eigen::Index>(i)) =
          lame.mu * (all - shear_stress(named_.make(shape), logs));
      shape[i] = c[2 + static_cast<Eigen::Index>(i)];
    }
  }

 private:
  using Logs = std::array<double, 3>;

  static std::vector<MaterialConstant> shape(const elasticity::NamedStretchLaw& named) {
    std::vector<MaterialConstant> all;
    for (const auto& c : named.constants)
      all.push_back({c.name, "", c.start, c.lower, c.upper, false});
    return all;
  }
  static Vector3d shear_stress(const elasticity::StretchLaw& law, const Logs& x) {
    const std::array<double, 3> stress = elasticity::shear_response(law, x).stress;
    return {stress[0], stress[1], stress[2]};
  }

  const elasticity::NamedStretchLaw& named_;
};

/// Foams: sums of powers.
class Foam final : public StrainEnergy {
 public:
  /// The exponent is `known` if given; otherwise exponents and shares of the terms are constants.
  Foam(std::string name, int terms, const double* known)
      : StrainEnergy(std::move(name), shape(terms, known != nullptr)),
        terms_(terms),
        is_known_(known != nullptr),
        exponent_(known != nullptr ? *known : 0) {}

  void evaluate(const Vector3d& x, const VectorXd& c, PrincipalStress& r) const override {
    const Lame lame(c);
    reset(c.size(), r);
    const double share = terms_ == 2 ? c[4] : 0;
    const Vector3d first =
        add_term(x, c, lame, 1 - share, is_known_ ? exponent_ : c[2], is_known_ ? -1 : 2, r);
    if (terms_ == 2) {
      const Vector3d second = add_term(x, c, lame, share, c[3], 3, r);
      r.by_constant.col(4) = 2 * lame.mu * (second - first);
    }
    r.by_constant.col(0) = r.stress / c[0];
  }

 private:
  static std::vector<MaterialConstant> shape(int terms, bool is_known) {
    if (is_known) return {};
    std::vector<MaterialConstant> result = {{"foam_exponent", "", 4, -40, 60, false}};
    if (terms == 2) {
      result.push_back({"foam_exponent_2", "", -4, -40, 60, false});
      result.push_back({"foam_share_2", "", 0.3, -5, 5, false});
    }
    return result;
  }

  /// Adds a term and returns the derivative of the stress with respect to twice the term's shear
  /// modulus.
  static Vector3d add_term(const Vector3d& x, const VectorXd& c, const Lame& lame, double weight,
                           double exponent, int exponent_index, PrincipalStress& r) {
    using Power = elasticity::PowerTerm<double>;
    const double mu = 2 * weight * lame.mu, mu_nu = 2 * weight * lame.mu_nu;
    Vector3d value, by_a;
    for (int k = 0; k < 3; ++k) {
      const Power q(exponent, x[k]);
      value[k] = q.value();
      by_a[k] = q.by_exponent();
      r.energy += mu * q.integral();
      r.tangent(k, k) += mu * q.by_x;
    }
    if (c[1] < 0.5) {
      const double l = x.sum(), b = 1 - 2 * c[1], beta = c[1] / b;
      const Power q(exponent, -beta * l);
      value.array() -= q.value();
      by_a.array() -= q.by_exponent();
      // negative integral of q(a, -beta l) over l
      r.energy += beta != 0 ? mu * q.integral() / beta : 0;
      r.tangent.array() += mu * beta * q.by_x;
      r.by_constant.col(1).array() += mu * q.by_x * l / (b * b);
    }
    r.stress += mu * value;
    r.by_constant.col(1) += mu_nu * value;
    if (exponent_index >= 0) r.by_constant.col(exponent_index) += mu * by_a;
    return value;
  }

  int terms_;
  bool is_known_;
  double exponent_;
};

std::vector<MaterialConstant> with_moduli(std::vector<MaterialConstant> shape) {
  shape.insert(shape.begin(), {{"young_modulus", "Pa", 1e5, 1, 1e12, true},
                               {"poisson_ratio", "", 0.3, -0.5, 0.4999, false}});
  return shape;
}

}  // namespace

StrainEnergy::StrainEnergy(std::string name, std::vector<MaterialConstant> shape)
    : name_(std::move(name)), constants_(with_moduli(std::move(shape))) {}

const std::vector<std::string>& StrainEnergy::names() {
  static const std::vector<std::string> all = {"linear",      "neo_hookean", "mooney_rivlin",
                                               "ogden_1",     "ogden_2",     "hyperfoam_1",
                                               "hyperfoam_2", "blatz_ko"};
  return all;
}

std::unique_ptr<const StrainEnergy> StrainEnergy::make(const std::string& name) {
  static constexpr double kBlatzKo = -2;
  if (name == "linear") return std::make_unique<Linear>();
  if (const auto* named = elasticity::find_stretch_law(name))
    return std::make_unique<Stretches>(*named);
  if (name == "hyperfoam_1") return std::make_unique<Foam>(name, 1, nullptr);
  if (name == "hyperfoam_2") return std::make_unique<Foam>(name, 2, nullptr);
  if (name == "blatz_ko") return std::make_unique<Foam>(name, 1, &kBlatzKo);
  std::string all;
  for (const std::string& known : names()) all += (all.empty() ? "" : ", ") + known;
  throw std::invalid_argument("no material '" + name + "'; there are " + all);
}

}  // namespace palpate::solid
