#include "tools/lab/baselines/sensing/curve_fit.hpp"

#include <Eigen/Cholesky>
#include <stdexcept>

namespace palpate::baselines {

CurveFit::CurveFit(const elasticity::Body& body, const mesh::Surface& surface,
                   const Options& options, int parameters, int own)
    : CloudEstimator(body, surface, options), options_(options), bar_(find_bar_axis(body)) {
  if (!(options.deviation > 0) || !(options.memory >= 0) || !(options.step > 0))
    throw std::invalid_argument("a fitted curve wants deviation, step > 0 and memory >= 0");
  if (parameters < 1 || parameters > kMost || own > kMostOwn)
    throw std::invalid_argument("a fitted curve has too many parameters");
  parameters_.setZero(parameters);
  first_ = parameters_;
  information_.setZero(parameters, parameters);
  own_.setZero(own);
  own_moved_.setZero(own);
  shape_ = moved_ = body.mesh.nodes;
}

void CurveFit::begin(const Eigen::Matrix3Xd&) noexcept {
  parameters_ = first_;
  draw(parameters_, shape_);
}

void CurveFit::begin_from(const Parameters& parameters) noexcept {
  first_ = parameters;
  parameters_ = parameters;
  draw(parameters_, shape_);
}

void CurveFit::take(elasticity::DeformationModel&) noexcept {
  const int count = matches().count(), rows = count + static_cast<int>(own_.size());
  if (count == 0) return;
  const Eigen::Index size = parameters_.size();
  judge(parameters_, own_);
  for (Eigen::Index k = 0; k < size; ++k) {
    Parameters moved = parameters_;
    moved[k] += options_.step;
    draw(moved, moved_);
    judge(moved, own_moved_);
    for (int i = 0; i < count; ++i) {
      const CloudMatch& match = matches()[i];
      slopes_(k, i) = match.place.normal.dot(match.of(moved_) - match.of(shape_)) /
                      (options_.step * options_.deviation);
    }
    for (Eigen::Index i = 0; i < own_.size(); ++i)
      slopes_(k, count + i) = (own_moved_[i] - own_[i]) / options_.step;
  }
  Parameters vector = Parameters::Zero(size);
  information_.setZero();
  for (int i = 0; i < rows; ++i) {
    double residual = 0;
    if (i < count) {
      const CloudMatch& match = matches()[i];
      residual = match.place.normal.dot(match.point - match.of(shape_)) / options_.deviation;
    } else {
      residual = -own_[i - count];
    }
    for (Eigen::Index a = 0; a < size; ++a) {
      vector[a] += slopes_(a, i) * residual;
      for (Eigen::Index b = 0; b <= a; ++b) information_(a, b) += slopes_(a, i) * slopes_(b, i);
    }
  }
  // The previous parameters act as a prior, so that temporarily unobserved parts do not jump.
  for (Eigen::Index a = 0; a < size; ++a) information_(a, a) += options_.memory + 1e-9;
  const Eigen::LDLT<Eigen::Ref<Square>> factor(information_);
  factor.solveInPlace(vector);
  if (!vector.allFinite()) return;
  const double largest = vector.cwiseAbs().maxCoeff();
  parameters_ += (largest > 0.5 ? 0.5 / largest : 1.0) * vector;
  draw(parameters_, shape_);
}

elasticity::StepReport CurveFit::advance(double, const estimation::EstimationInputs&,
                                         elasticity::DeformationModel& model) noexcept {
  return carry(shape_, model);
}

}  // namespace palpate::baselines
