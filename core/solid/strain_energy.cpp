#include "core/solid/strain_energy.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

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

/// q(a, x) = (exp(a x) - 1) / a, its derivatives, and its integral from 0 to x.
struct Power {
  double value, by_x, by_a, integral;

  Power(double a, double x) {
    const double y = a * x;
    by_x = std::exp(y);
    if (std::abs(y) < 1e-3) {  // series where the closed forms suffer from cancellation
      value = x * (1 + y / 2 + y * y / 6 + y * y * y / 24);
      by_a = x * x * (1.0 / 2 + y / 3 + y * y / 8 + y * y * y / 30);
      integral = x * x * (1.0 / 2 + y / 6 + y * y / 24 + y * y * y / 120);
    } else {
      value = std::expm1(y) / a;
      by_a = (x * by_x - value) / a;
      integral = (value - x) / a;
    }
  }
};

/// Adds `lambda` l^2 / 2 to the energy, and its contributions to the derivatives.
void add_volume(double lambda, double l, PrincipalStress& r) {
  r.energy += lambda * l * l / 2;
  r.stress.array() += lambda * l;
  r.tangent.array() += lambda;
}

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

class MooneyRivlin final : public StrainEnergy {
 public:
  MooneyRivlin() : StrainEnergy("mooney_rivlin", {{"mooney_share", "", 0.3, -5, 5, false}}) {}

  void evaluate(const Vector3d& x, const VectorXd& c, PrincipalStress& r) const override {
    const Lame lame(c);
    const double share = c[2], l = x.sum();
    const Vector3d square = (2 * x).array().exp();
    const double I1 = square.sum();
    const Vector3d others = I1 - square.array();
    const double I2 = square.dot(others) / 2;
    const double c10 = (1 - share) * lame.mu / 2, c01 = share * lame.mu / 2;

    reset(3, r);
    r.energy = c10 * (I1 - 3) + c01 * (I2 - 3) - (2 * c10 + 4 * c01) * l;
    // derivatives with respect to c10 and c01, the latter including its part of the volume term
    const Vector3d by_c10 = 2 * square.array() - 2;
    const Vector3d by_c01 = 2 * square.array() * others.array() - 4;
    r.stress = c10 * by_c10 + c01 * by_c01;
    r.tangent = 4 * c01 * square * square.transpose();
    r.tangent.diagonal() = 4 * square.array() * (c10 + c01 * others.array());
    const bool is_compressible = c[1] < 0.5;
    const double volume = is_compressible ? lame.lambda - 4 * c01 : 0;
    add_volume(volume, l, r);
    const Vector3d by_c01_all = by_c01.array() - (is_compressible ? 4 * l : 0);
    const Vector3d by_mu = ((1 - share) * by_c10 + share * by_c01_all) / 2;
    r.by_constant.col(0) = r.stress / c[0];
    r.by_constant.col(1) = (lame.mu_nu * by_mu).array() + lame.lambda_nu * l;
    r.by_constant.col(2) = lame.mu / 2 * (by_c01_all - by_c10);
  }
};

/// Sums of powers: Ogden's materials, including the neo-Hookean one, and the foams.
class Powers final : public StrainEnergy {
 public:
  /// Exponents are `known` if given; otherwise exponents and shares of the terms are constants.
  Powers(std::string name, int terms, bool is_foam, const double* known)
      : StrainEnergy(std::move(name), shape(terms, is_foam, known != nullptr)),
        terms_(terms),
        is_foam_(is_foam),
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
    if (!is_foam_) {
      const double l = x.sum();
      add_volume(lame.lambda, l, r);
      r.by_constant.col(1).array() += lame.lambda_nu * l;
    }
    r.by_constant.col(0) = r.stress / c[0];
  }

 private:
  static std::vector<MaterialConstant> shape(int terms, bool is_foam, bool is_known) {
    if (is_known) return {};
    const std::string prefix = is_foam ? "foam_" : "ogden_";
    std::vector<MaterialConstant> result = {
        {prefix + "exponent", "", is_foam ? 4.0 : 2.0, -40, 60, false}};
    if (terms == 2) {
      result.push_back({prefix + "exponent_2", "", is_foam ? -4.0 : -2.0, -40, 60, false});
      result.push_back({prefix + "share_2", "", 0.3, -5, 5, false});
    }
    return result;
  }

  /// Adds a term and returns the derivative of the stress with respect to twice the term's shear
  /// modulus.
  Vector3d add_term(const Vector3d& x, const VectorXd& c, const Lame& lame, double weight,
                    double exponent, int exponent_index, PrincipalStress& r) const {
    const double mu = 2 * weight * lame.mu, mu_nu = 2 * weight * lame.mu_nu;
    Vector3d value, by_a;
    for (int k = 0; k < 3; ++k) {
      const Power q(exponent, x[k]);
      value[k] = q.value;
      by_a[k] = q.by_a;
      r.energy += mu * q.integral;
      r.tangent(k, k) += mu * q.by_x;
    }
    if (is_foam_ && c[1] < 0.5) {
      const double l = x.sum(), b = 1 - 2 * c[1], beta = c[1] / b;
      const Power q(exponent, -beta * l);
      value.array() -= q.value;
      by_a.array() -= q.by_a;
      // negative integral of q(a, -beta l) over l
      r.energy += beta != 0 ? mu * q.integral / beta : 0;
      r.tangent.array() += mu * beta * q.by_x;
      r.by_constant.col(1).array() += mu * q.by_x * l / (b * b);
    }
    r.stress += mu * value;
    r.by_constant.col(1) += mu_nu * value;
    if (exponent_index >= 0) r.by_constant.col(exponent_index) += mu * by_a;
    return value;
  }

  int terms_;
  bool is_foam_, is_known_;
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
  static constexpr double kNeoHookean = 2, kBlatzKo = -2;
  if (name == "linear") return std::make_unique<Linear>();
  if (name == "neo_hookean") return std::make_unique<Powers>(name, 1, false, &kNeoHookean);
  if (name == "mooney_rivlin") return std::make_unique<MooneyRivlin>();
  if (name == "ogden_1") return std::make_unique<Powers>(name, 1, false, nullptr);
  if (name == "ogden_2") return std::make_unique<Powers>(name, 2, false, nullptr);
  if (name == "hyperfoam_1") return std::make_unique<Powers>(name, 1, true, nullptr);
  if (name == "hyperfoam_2") return std::make_unique<Powers>(name, 2, true, nullptr);
  if (name == "blatz_ko") return std::make_unique<Powers>(name, 1, true, &kBlatzKo);
  std::string all;
  for (const std::string& known : names()) all += (all.empty() ? "" : ", ") + known;
  throw std::invalid_argument("no material '" + name + "'; there are " + all);
}

}  // namespace palpate::solid
