#include "tools/lab/baselines/sensing/shape_matching_fit.hpp"

#include <Eigen/LU>
#include <cmath>
#include <stdexcept>

#include "core/math/polar.hpp"

namespace palpate::baselines {

using Eigen::Matrix3d;
using Eigen::Vector3d;

ShapeMatchingFit::ShapeMatchingFit(const elasticity::Body& body, const mesh::Surface& surface,
                                   const Options& options)
    : CloudEstimator(body, surface, options),
      options_(options),
      rest_(body.mesh.nodes),
      goal_(body.mesh.nodes),
      fixed_(body.fixed_nodes) {
  if (options.regions < 1 || options.candidates < 1 || options.iterations < 1 ||
      !(options.rigidity > 0) || !(options.rigidity <= 1) || !(options.memory > 0))
    throw std::invalid_argument("shape matching with a fit: an option is out of range");
  int axis = 0;
  const Vector3d lower = rest_.rowwise().minCoeff();
  const Vector3d size = Vector3d(rest_.rowwise().maxCoeff()) - lower;
  size.maxCoeff(&axis);
  // linear hat functions along the axis: the weights of a node sum to 1
  const double width = size[axis] / (options.regions + 1);
  for (int r = 0; r < options.regions; ++r) {
    Region region;
    Vector3d centre = Vector3d::Zero();
    double sum = 0;
    for (int n = 0; n < rest_.cols(); ++n) {
      const double place = (rest_(axis, n) - lower[axis]) / width - 1;  // 0 to count - 1
      double weight = 1 - std::abs(place - r);
      if (r == 0 && place < 0) weight = 1;
      if (r == options.regions - 1 && place > r) weight = 1;
      if (!(weight > 1e-6)) continue;
      region.members.push_back({n, weight, rest_.col(n)});
      centre += weight * rest_.col(n);
      sum += weight;
    }
    if (region.members.size() < 4)
      throw std::invalid_argument("shape matching: more regions than the mesh has nodes for");
    centre /= sum;
    Matrix3d moment = Matrix3d::Zero();
    for (Member& member : region.members) {
      member.rest -= centre;
      moment += member.weight * member.rest * member.rest.transpose();
    }
    region.inverse_moment = moment.inverse();
    if (!region.inverse_moment.allFinite())
      throw std::invalid_argument("shape matching: a region is flat; take fewer");
    regions_.push_back(std::move(region));
  }
  for (int c = 0; c < options.candidates; ++c) {
    Candidate candidate;
    candidate.beta = options.candidates == 1 ? 0.5 : 0.98 * c / (options.candidates - 1);
    candidate.x = rest_;
    candidate.rotations.assign(regions_.size(), Eigen::Quaterniond::Identity());
    candidates_.push_back(std::move(candidate));
  }
}

void ShapeMatchingFit::begin(const Eigen::Matrix3Xd& positions) noexcept {
  for (Candidate& candidate : candidates_) {
    candidate.x = positions;
    candidate.squared = 0;
    for (Eigen::Quaterniond& q : candidate.rotations) q.setIdentity();
  }
  best_ = static_cast<int>(candidates_.size()) / 2;
  since_ = 0;
}

/// All candidates are evaluated at the surface points matched by the reported one.
void ShapeMatchingFit::take(elasticity::DeformationModel&) noexcept {
  const double share = 1 - std::exp(-since_ / options_.memory);
  since_ = 0;
  if (matches().count() == 0) return;
  double least = 0;
  for (std::size_t c = 0; c < candidates_.size(); ++c) {
    Candidate& candidate = candidates_[c];
    double squared = 0;
    for (int i = 0; i < matches().count(); ++i) {
      const CloudMatch& match = matches()[i];
      squared += std::pow(match.place.normal.dot(match.point - match.of(candidate.x)), 2);
    }
    candidate.squared += share * (squared / matches().count() - candidate.squared);
    if (c > 0 && !(candidate.squared < least)) continue;
    least = candidate.squared;
    best_ = static_cast<int>(c);
  }
}

/// One iteration of all regions: nodes move to the mean of their regions' goals.
void ShapeMatchingFit::match(Candidate& candidate) noexcept {
  goal_.setZero();
  for (std::size_t r = 0; r < regions_.size(); ++r) {
    const Region& region = regions_[r];
    Vector3d centre = Vector3d::Zero();
    double sum = 0;
    for (const Member& m : region.members) {
      centre += m.weight * candidate.x.col(m.node);
      sum += m.weight;
    }
    centre /= sum;
    Matrix3d moment = Matrix3d::Zero();
    for (const Member& m : region.members)
      moment += m.weight * (candidate.x.col(m.node) - centre) * m.rest.transpose();
    Matrix3d linear = moment * region.inverse_moment;
    const Matrix3d R = math::polar_rotation(linear, candidate.rotations[r]);
    const double volume = linear.determinant();
    // as in Mueller et al. 2005, section 4.3
    linear *= volume > 1e-3 ? 1 / std::cbrt(volume) : 1.0;
    const Matrix3d T = candidate.beta * linear + (1 - candidate.beta) * R;
    for (const Member& m : region.members) goal_.col(m.node) += m.weight * (centre + T * m.rest);
  }
  candidate.x += options_.rigidity * (goal_ - candidate.x);
}

elasticity::StepReport ShapeMatchingFit::advance(double dt, const estimation::EstimationInputs&,
                                                 elasticity::DeformationModel& model) noexcept {
  since_ += dt;
  const elasticity::Body& body = model.body();
  for (Candidate& candidate : candidates_) {
    for (int i = 0; i < options_.iterations; ++i) {
      match(candidate);
      for (const int node : fixed_) candidate.x.col(node) = rest_.col(node);
      for (int g = 0; uses_hand() && g < static_cast<int>(body.grasps.size()); ++g) {
        if (!model.is_held(g)) continue;
        for (const int node : body.grasps[g].nodes)
          candidate.x.col(node) = held_place(g, node, body);
      }
    }
  }
  return carry(candidates_[best_].x, model);
}

}  // namespace palpate::baselines
