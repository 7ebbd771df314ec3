#include "tools/lab/baselines/sensing/euler_bernoulli_fit.hpp"

#include <array>
#include <cmath>
#include <stdexcept>

namespace palpate::baselines {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kCurvature = 5;  // 1/m, for a parameter of 1

}  // namespace

EulerBernoulliFit::EulerBernoulliFit(const elasticity::Body& body, const mesh::Surface& surface,
                                     const Options& options)
    : CurveFit(body, surface, options, 5, 5),
      nominal_young_(body.material.young_modulus),
      log_deviation_(options.log_young_deviation),
      end_deviation_(body.grasps.empty() ? 1e-3 : 10) {
  if (!(log_deviation_ > 0)) throw std::invalid_argument("log_young_deviation must be positive");
  for (int i = 0; i < 2; ++i)
    weight_[i] = body.material.density * bar().area * body.gravity_O.dot(bar().across(i)) /
                 (2 * nominal_young_ * bar().second_moment[i]);
  // A free end bears no load. A hand initially bears the weight: no curvature at either end.
  Parameters first = Parameters::Zero(5);
  for (int i = 0; i < 2 && !body.grasps.empty(); ++i)
    first[2 * i] = -weight_[i] * bar().free_length * bar().free_length / kCurvature;
  begin_from(first);
}

double EulerBernoulliFit::young_modulus() const noexcept {
  return nominal_young_ * std::exp(-parameters()[4]);
}

/// Curvature towards across(i) at s: linear due to end loads, quadratic due to weight, zero in the
/// grasped part. The line's frame rotates about across(i) x along for each.
void EulerBernoulliFit::draw(const Parameters& p, Eigen::Matrix3Xd& shape) const noexcept {
  std::array<Vector3d, kSteps + 1> line;
  std::array<Matrix3d, kSteps + 1> frame;
  line[0] = bar().root;
  frame[0].setIdentity();
  const double L = bar().free_length, ds = L / kSteps;
  for (int k = 0; k < kSteps; ++k) {
    const double s = (k + 0.5) * ds;
    Vector3d turn = Vector3d::Zero();
    for (int i = 0; i < 2; ++i) {
      const double by_loads = kCurvature * (p[2 * i] * (1 - s / L) + p[2 * i + 1] * s / L);
      const double curvature = by_loads + std::exp(p[4]) * weight_[i] * (L - s) * (L - s);
      turn += curvature * bar().along().cross(bar().across(i));
    }
    line[k + 1] = line[k] + ds * frame[k] * math::exp_rotation(0.5 * ds * turn) * bar().along();
    frame[k + 1] = frame[k] * math::exp_rotation(ds * turn);
  }
  for (Eigen::Index n = 0; n < shape.cols(); ++n) {
    const double place = std::min(std::max(bar().s[n] / ds, 0.0), static_cast<double>(kSteps));
    const int k = std::min(static_cast<int>(place), kSteps - 1);
    const double t = place - k;
    const Matrix3d turned =
        frame[k] * math::exp_rotation(t * math::log_rotation(frame[k].transpose() * frame[k + 1]));
    const double beyond = bar().s[n] - place * ds;
    shape.col(n) = (1 - t) * line[k] + t * line[k + 1] + turned * bar().offset.col(n) +
                   beyond * (turned * bar().along());
  }
}

void EulerBernoulliFit::judge(const Parameters& p, Own& residuals) const noexcept {
  residuals.head<4>() = p.head<4>() / end_deviation_;
  residuals[4] = p[4] / log_deviation_;
}

void EulerBernoulliFit::report(estimation::Estimate& estimate) noexcept {
  estimate.log_young_modulus = std::log(young_modulus());
}

}  // namespace palpate::baselines
