#include "tests/bench/core/elasticity/candidate_elements.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <map>
#include <set>
#include <stdexcept>
#include <string>

#include "core/math/polar.hpp"

namespace palpate::bench {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix3Xd;
using elasticity::kFar;
using elasticity::kNear;
using elasticity::Tangent;

/// Derivatives of the shape functions by the barycentric coordinates, 4 x N, at one place.
Eigen::MatrixXd shape_derivatives(int nodes, const Eigen::Vector4d& b) {
  Eigen::MatrixXd d = Eigen::MatrixXd::Zero(4, nodes);
  if (nodes == 4) {
    d.setIdentity();
    return d;
  }
  for (int a = 0; a < 4; ++a) d(a, a) = 4 * b(a) - 1;
  for (int m = 0; m < 6; ++m) {
    const auto [i, j] = mesh::kTetrahedronEdges[m];
    d(i, 4 + m) = 4 * b(j);
    d(j, 4 + m) = 4 * b(i);
  }
  return d;
}

}  // namespace

CandidateElements::CandidateElements(const elasticity::Body& body, Volumetric volumetric)
    : elements_(body.mesh.elements) {
  add_points(body);
  if (volumetric == Volumetric::kAveraged) {
    group_by_node();
  } else {
    group_by_point();
  }
}

void CandidateElements::add_points(const elasticity::Body& body) {
  const auto nodes = static_cast<int>(elements_.rows());
  const int count = nodes == 4 ? 1 : 4;
  for (int e = 0; e < elements_.cols(); ++e) {
    const Matrix3Xd rest = body.mesh.nodes(Eigen::all, elements_.col(e));
    for (int p = 0; p < count; ++p) {
      Eigen::Vector4d place = Eigen::Vector4d::Constant(count == 1 ? 0.25 : kFar);
      if (count == 4) place(p) = kNear;
      const Eigen::MatrixXd d = shape_derivatives(nodes, place);
      // The first coordinate is 1 minus the others.
      const Eigen::MatrixXd local = d.bottomRows<3>().rowwise() - d.row(0);
      const Matrix3d jacobian = rest * local.transpose();
      Point point{};
      point.element = e;
      point.weight = jacobian.determinant() / (6 * count);
      if (!(point.weight > 0)) {
        throw std::invalid_argument("element " + std::to_string(e) + " has no positive volume");
      }
      point.gradients = jacobian.inverse().transpose() * local;
      point.lame = elasticity::lame(body.material_of(e));
      points_.push_back(point);
    }
  }
}

void CandidateElements::group_by_point() {
  stencils_ = elements_;
  for (std::size_t p = 0; p < points_.size(); ++p) {
    Point& point = points_[p];
    point.stencil = point.element;
    groups_.push_back(
        {{{static_cast<int>(p), point.weight}}, point.weight, point.lame.lambda, 0, point.stencil});
  }
}

void CandidateElements::group_by_node() {
  std::map<std::pair<int, double>, Group> groups;
  for (std::size_t p = 0; p < points_.size(); ++p) {
    const Point& point = points_[p];
    for (int a = 0; a < 4; ++a) {  // corners
      Group& group = groups[{elements_(a, point.element), point.lame.lambda}];
      group.members.push_back({static_cast<int>(p), point.weight / 4});
      group.volume += point.weight / 4;
      group.lambda = point.lame.lambda;
    }
  }
  std::vector<std::set<int>> stencils;
  for (auto& [key, group] : groups) {
    group.stencil = static_cast<int>(stencils.size());
    stencils.emplace_back();
    for (const Member& member : group.members) {
      points_[member.point].stencil = group.stencil;
      for (const int node : elements_.col(points_[member.point].element)) {
        stencils.back().insert(node);
      }
    }
    groups_.push_back(std::move(group));
  }
  std::size_t largest = 0;
  for (const auto& nodes : stencils) largest = std::max(largest, nodes.size());
  stencils_.resize(static_cast<int>(largest), static_cast<int>(stencils.size()));
  for (int s = 0; s < stencils_.cols(); ++s) {
    stencils_.col(s).setConstant(*stencils[s].begin());
    std::copy(stencils[s].begin(), stencils[s].end(), stencils_.col(s).begin());
  }
}

double CandidateElements::volume() const {
  double sum = 0;
  for (const Point& point : points_) sum += point.weight;
  return sum;
}

double CandidateElements::evaluate(const Matrix3Xd& x, Matrix3Xd& forces) {
  double energy = 0;
  std::vector<Matrix3d> deviatoric;  // stress 2 mu (F - R)
  for (Point& point : points_) {
    point.F.setZero();
    for (int a = 0; a < elements_.rows(); ++a) {
      point.F += (x.col(elements_(a, point.element)) - x.col(elements_(0, point.element))) *
                 point.gradients.col(a).transpose();
    }
    const Matrix3d R = math::polar_rotation(point.F);
    point.h = R * point.gradients;
    point.trace = (R.transpose() * point.F).trace() - 3;
    point.pressure = 0;
    energy += point.weight * point.lame.mu * (point.F - R).squaredNorm();
    deviatoric.emplace_back(2 * point.lame.mu * (point.F - R));
  }
  for (Group& group : groups_) {
    group.trace = 0;
    for (const Member& m : group.members) group.trace += m.share * points_[m.point].trace;
    group.trace /= group.volume;
    energy += group.volume * group.lambda / 2 * group.trace * group.trace;
    for (const Member& m : group.members) {
      points_[m.point].pressure += m.share / points_[m.point].weight * group.lambda * group.trace;
    }
  }
  forces.setZero(3, x.cols());
  for (std::size_t p = 0; p < points_.size(); ++p) {
    const Point& point = points_[p];
    const Matrix3Xd f = point.weight * (deviatoric[p] * point.gradients + point.pressure * point.h);
    for (int a = 0; a < elements_.rows(); ++a) {
      forces.col(elements_(a, point.element)) += f.col(a);
    }
  }
  return energy;
}

void CandidateElements::add_tangent(bool exact, factor::BlockMatrix& matrix) const {
  std::vector<Eigen::MatrixXd> local(
      stencils_.cols(), Eigen::MatrixXd::Zero(3 * stencils_.rows(), 3 * stencils_.rows()));
  const auto place = [this](int stencil, int node) {
    const auto column = stencils_.col(stencil);
    return static_cast<int>(std::find(column.begin(), column.end(), node) - column.begin());
  };
  for (const Point& point : points_) {
    // Without lambda, whose part in the rotation of R is the pressure's.
    elasticity::PointTangent t = elasticity::point_tangent(
        point.F, {point.lame.mu, 0}, exact ? Tangent::kExact : Tangent::kSemidefinite);
    if (exact) t.twist *= 1 - point.pressure / (2 * point.lame.mu);
    for (int a = 0; a < elements_.rows(); ++a) {
      const Matrix3d left = point.weight * math::cross_matrix(point.h.col(a)) * t.twist;
      const int i = place(point.stencil, elements_(a, point.element));
      for (int b = 0; b < elements_.rows(); ++b) {
        const int k = place(point.stencil, elements_(b, point.element));
        Matrix3d block = left * math::cross_matrix(point.h.col(b));
        block.diagonal().array() += point.weight * t.s * point.h.col(a).dot(point.h.col(b));
        local[point.stencil].block<3, 3>(3 * i, 3 * k) += block;
      }
    }
  }
  for (const Group& group : groups_) {
    Eigen::VectorXd slope = Eigen::VectorXd::Zero(3 * stencils_.rows());
    for (const Member& m : group.members) {
      const Point& point = points_[m.point];
      for (int a = 0; a < elements_.rows(); ++a) {
        slope.segment<3>(3 * place(group.stencil, elements_(a, point.element))) +=
            m.share / group.volume * point.h.col(a);
      }
    }
    local[group.stencil] += group.volume * group.lambda * slope * slope.transpose();
  }
  for (int s = 0; s < stencils_.cols(); ++s) matrix.add(s, local[s]);
}

}  // namespace palpate::bench
