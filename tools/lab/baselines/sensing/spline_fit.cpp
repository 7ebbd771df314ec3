#include "tools/lab/baselines/sensing/spline_fit.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace palpate::baselines {
namespace {

using Eigen::Vector3d;

constexpr double kScale = 0.1;  // m, displacement of a control point for a parameter of 1

}  // namespace

SplineFit::SplineFit(const elasticity::Body& body, const mesh::Surface& surface,
                     const Options& options)
    : CurveFit(body, surface, options, 3 * std::clamp(options.controls, 1, 12),
               kPlaces + 3 * std::max(0, options.controls - 2)),
      controls_(options.controls),
      stretch_(options.stretch),
      bend_(options.bend) {
  if (controls_ < 3 || controls_ > 12 || !(stretch_ > 0) || !(bend_ > 0))
    throw std::invalid_argument("a spline wants 3 to 12 controls, stretch and bend > 0");
  spacing_ = bar().length / (controls_ - 1);
  begin_from(Parameters::Zero(3 * controls_));
}

/// Displacement of control point `index`, counted from one spacing before the clamp. The first two
/// follow from the third by zero displacement and slope at the clamp.
Vector3d SplineFit::control(const Parameters& p, int index) const noexcept {
  if (index == 1) return -0.5 * kScale * p.head<3>();
  return kScale * p.segment<3>(3 * std::max(0, index - 2));
}

SplineFit::Place SplineFit::at(const Parameters& p, double s) const noexcept {
  const double place = std::clamp(s / spacing_, 0.0, controls_ - 1 - 1e-9);
  const int k = static_cast<int>(place);
  const double t = place - k;
  const double value[4] = {std::pow(1 - t, 3) / 6, (3 * t * t * t - 6 * t * t + 4) / 6,
                           (-3 * t * t * t + 3 * t * t + 3 * t + 1) / 6, t * t * t / 6};
  const double slope[4] = {-(1 - t) * (1 - t) / 2, (3 * t * t - 4 * t) / 2,
                           (-3 * t * t + 2 * t + 1) / 2, t * t / 2};
  Place at{bar().root + std::max(s, 0.0) * bar().along(), bar().along()};
  for (int i = 0; i < 4; ++i) {
    const Vector3d d = control(p, k + i);
    at.position += value[i] * d;
    at.slope += slope[i] / spacing_ * d;
  }
  return at;
}

void SplineFit::draw(const Parameters& p, Eigen::Matrix3Xd& shape) const noexcept {
  for (Eigen::Index n = 0; n < shape.cols(); ++n) {
    const Place place = at(p, bar().s[n]);
    const Eigen::Quaterniond turn = Eigen::Quaterniond::FromTwoVectors(bar().along(), place.slope);
    shape.col(n) =
        place.position + turn * bar().offset.col(n) + std::min(bar().s[n], 0.0) * bar().along();
  }
}

void SplineFit::judge(const Parameters& p, Own& residuals) const noexcept {
  for (int i = 0; i < kPlaces; ++i)
    residuals[i] = (at(p, (i + 0.5) / kPlaces * bar().length).slope.norm() - 1) / stretch_;
  for (int i = 0; i + 2 < controls_; ++i) {
    const Vector3d third =
        control(p, i + 4) - 3 * control(p, i + 3) + 3 * control(p, i + 2) - control(p, i + 1);
    residuals.segment<3>(kPlaces + 3 * i) = third / (spacing_ * spacing_ * spacing_ * bend_);
  }
}

}  // namespace palpate::baselines
