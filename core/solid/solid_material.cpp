#include "core/solid/solid_material.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <stdexcept>

namespace palpate::solid {

using Eigen::Matrix3d;
using Matrix9 = Eigen::Matrix<double, 9, 9>;
using Vector9 = Eigen::Matrix<double, 9, 1>;

namespace {

Vector9 flat(const Matrix3d& m) { return Eigen::Map<const Vector9>(m.data()); }

}  // namespace

SolidMaterial make_solid_material(double E, double nu, double mooney, double stiffening) {
  if (!(E > 0) || !std::isfinite(E)) {
    throw std::invalid_argument("Young's modulus must be positive");
  }
  if (!(nu >= 0 && nu < 0.5)) {
    throw std::invalid_argument("Poisson's ratio of a solid must lie in [0, 0.5)");
  }
  const double mu = E / (2 * (1 + nu)), bulk = E / (3 * (1 - 2 * nu));
  const double point = bulk * kPointBulk * mu / (bulk + kPointBulk * mu);
  const auto spread = [&](double shear, double at_points, double at_mean) {
    return SolidCoefficients{0.5 * (1 - mooney) * shear, 0.5 * mooney * shear, stiffening * shear,
                             at_points, at_mean};
  };
  SolidMaterial m;
  m.coefficients = spread(mu, point, bulk - point);
  m.by_young = m.coefficients * (1 / E);
  const double mu_slope = -mu / (1 + nu), bulk_slope = 2 * bulk / (1 - 2 * nu);
  // bulk_point is half the harmonic mean of K and c mu
  const double of_bulk = std::pow(point / bulk, 2);
  const double of_shear = kPointBulk * std::pow(point / (kPointBulk * mu), 2);
  const double point_slope = of_bulk * bulk_slope + of_shear * mu_slope;
  m.by_poisson = spread(mu_slope, point_slope, bulk_slope - point_slope);
  return m;
}

double volume_ratio(const Matrix3d& F, Matrix3d& cofactors, Matrix9* second) {
  cofactors.col(0) = F.col(1).cross(F.col(2));
  cofactors.col(1) = F.col(2).cross(F.col(0));
  cofactors.col(2) = F.col(0).cross(F.col(1));
  if (second) {
    const auto cross = [](const Eigen::Vector3d& v) {
      return (Matrix3d() << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0).finished();
    };
    second->setZero();
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3, k = (i + 2) % 3;
      second->block<3, 3>(3 * i, 3 * j) = -cross(F.col(k));
      second->block<3, 3>(3 * i, 3 * k) = cross(F.col(j));
    }
  }
  return F.col(0).dot(cofactors.col(0));
}

bool point_response(const Matrix3d& F, const SolidCoefficients& c, bool with_tangent,
                    PointResponse& response) {
  Matrix3d cofactors;
  Matrix9 second;
  const double J = volume_ratio(F, cofactors, with_tangent ? &second : nullptr);
  if (!(J > 0)) return false;
  const Matrix3d G = cofactors / J;  // F^-T, derivative of log J
  const Matrix3d C = F.transpose() * F;
  const double i1 = C.trace(), i2 = 0.5 * (i1 * i1 - C.squaredNorm());
  const double a = std::pow(J, -2.0 / 3), b = a * a;
  const Matrix3d i2_slope = 2 * (i1 * F - F * C);
  const Matrix3d first = 2 * a * (F - i1 / 3 * G);           // derivative of the isochoric I1
  const Matrix3d other = b * (i2_slope - 4.0 / 3 * i2 * G);  // derivative of the isochoric I2
  const double e1 = a * i1 - 3, e2 = b * i2 - 3;
  const double w1 = c.c10 + 2 * c.c20 * e1;
  response.energy =
      c.c10 * e1 + c.c01 * e2 + c.c20 * e1 * e1 + c.bulk_point / 2 * (J - 1) * (J - 1);
  response.stress = w1 * first + c.c01 * other + c.bulk_point * (J - 1) * cofactors;
  if (!with_tangent) return true;

  const Vector9 g = flat(G), f = flat(F), q = flat(first), r = flat(other), s = flat(i2_slope);
  // Derivative of G: -F^-T dF^T F^-T = (d cof F) / J - G (G : dF).
  const Matrix9 turn = second / J - g * g.transpose();
  Matrix9& A = response.tangent;
  Matrix9 of_first =
      -2.0 / 3 * q * g.transpose() - 4.0 / 3 * a * g * f.transpose() - 2.0 / 3 * a * i1 * turn;
  of_first.diagonal().array() += 2 * a;
  A = w1 * of_first + 2 * c.c20 * q * q.transpose() + c.bulk_point * (J - 1) * second;
  const Vector9 cof = flat(cofactors);
  A += c.bulk_point * cof * cof.transpose();
  if (c.c01 != 0) {
    // d(2 I1 F - 2 F C) = 4 (F : dF) F + 2 I1 dF - 2 (dF C + F dF^T F + F F^T dF).
    Matrix9 of_slope = 4 * f * f.transpose();
    of_slope.diagonal().array() += 2 * i1;
    const Matrix3d B = F * F.transpose();
    for (int k = 0; k < 3; ++k) {
      for (int l = 0; l < 3; ++l) {
        Matrix3d block = -2 * F.col(l) * F.col(k).transpose();
        block.diagonal().array() -= 2 * C(k, l);
        if (k == l) block -= 2 * B;
        of_slope.block<3, 3>(3 * k, 3 * l) += block;
      }
    }
    A += c.c01 * (-4.0 / 3 * r * g.transpose() +
                  b * (of_slope - 4.0 / 3 * g * s.transpose() - 4.0 / 3 * i2 * turn));
  }
  return true;
}

}  // namespace palpate::solid
