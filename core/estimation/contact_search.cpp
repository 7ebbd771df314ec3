#include "core/estimation/contact_search.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "core/math/option_check.hpp"

namespace palpate::estimation {
namespace {

/// Visits the barycentric coordinates of the centres of the cells of a triangle whose sides are
/// divided into `parts`.
template <class Visit>
void for_each_cell(int parts, Visit&& visit) {
  const double h = 1.0 / (3 * parts);
  for (int i = 0; i < parts; ++i) {
    for (int j = 0; j < parts - i; ++j) {
      visit((3 * i + 1) * h, (3 * j + 1) * h);
      if (j < parts - i - 1) visit((3 * i + 2) * h, (3 * j + 2) * h);
    }
  }
}

constexpr double kLeastSideways = 0.02;  // N

}  // namespace

std::vector<ContactSearch::Place> contact_places(const elasticity::Body& body,
                                                 const mesh::Surface& surface, double spacing) {
  std::vector<bool> bound(static_cast<std::size_t>(body.mesh.node_count()), false);
  for (const int node : body.fixed_nodes) bound[node] = true;
  for (const elasticity::GraspRegion& grasp : body.grasps)
    for (const int node : grasp.nodes) bound[node] = true;
  std::vector<ContactSearch::Place> places;
  const mesh::PointLocator locator(body.mesh);
  const Eigen::Matrix3Xd& rest = body.mesh.nodes;
  for (int t = 0; t < surface.triangles.cols(); ++t) {
    const Eigen::Vector3i corners = surface.triangles.col(t);
    if (bound[corners[0]] && bound[corners[1]] && bound[corners[2]]) continue;
    const Eigen::Vector3d a = rest.col(corners[0]);
    const Eigen::Vector3d ab = rest.col(corners[1]) - a;
    const Eigen::Vector3d ac = rest.col(corners[2]) - a;
    const double side = std::max({ab.norm(), ac.norm(), (ab - ac).norm()});
    const int parts = std::max(1, static_cast<int>(std::ceil(side / spacing)));
    for_each_cell(parts, [&](double u, double v) {
      places.push_back({locator.locate(a + u * ab + v * ac), corners});
    });
  }
  return places;
}

ContactSearch::ContactSearch(const elasticity::Body& body, const mesh::Surface& surface,
                             const Options& options)
    : options_(options) {
  math::check_positive(options.spacing, "spacing");
  math::check_positive(options.friction, "friction");
  math::check_positive(options.usual, "usual");
  math::check_positive(options.deviation, "deviation");
  math::check_positive(options.observable, "observable");
  places_ = contact_places(body, surface, options.spacing);
  math::check_option(!places_.empty(), "surface", places_.size(),
                     "at least one triangle that is neither fixed nor held");
  next_ = place_count();
}

Eigen::Matrix<double, 6, 3> ContactSearch::response(const mesh::PointWeights& point,
                                                    const elasticity::Sensitivity& sensitivity,
                                                    const PatchMotion& motion, int grasp) noexcept {
  Eigen::Matrix<double, 6, 3> dw_df = Eigen::Matrix<double, 6, 3>::Zero();
  for (int other = 0; other < 2; ++other) {
    const auto felt = motion.felt().block<6, 6>(6 * grasp, 6 * other);
    if (felt.isZero(0)) continue;
    Eigen::Matrix<double, 6, 3> held = Eigen::Matrix<double, 6, 3>::Zero();
    for (int i = 0; i < point.count; ++i)
      held.noalias() -= point.weights[i] *
                        sensitivity.dx_dxi[other].middleRows<3>(3 * point.nodes[i]).transpose();
    dw_df.noalias() += felt * held;
  }
  return dw_df;
}

void ContactSearch::begin(const WrenchFilter::Wrenches& y, const WrenchFilter::Noise& S,
                          const std::array<bool, 2>& held) noexcept {
  held_ = held;
  best_ = Found();
  next_ = 0;
  weight_ = squared_ = 0;
  weighted_.setZero();
  const Eigen::LLT<WrenchFilter::Noise> factor(S);
  whiten_ = WrenchFilter::Noise::Identity(S.rows(), S.cols());
  factor.matrixL().solveInPlace(whiten_);
  whitened_ = whiten_ * y;
  if (factor.info() != Eigen::Success || !whitened_.allFinite()) next_ = place_count();
}

ContactSearch::Found ContactSearch::judge(int index, const elasticity::DeformationModel& model,
                                          const PatchMotion& motion) const noexcept {
  const Place& place = places_[index];
  Eigen::Matrix<double, Eigen::Dynamic, 3, 0, WrenchFilter::kMostRows, 3> H(whitened_.size(), 3);
  for (int g = 0, row = 0; g < 2; ++g) {
    if (!held_[g]) continue;
    H.middleRows<6>(row) = response(place.point, model.sensitivity(), motion, g);
    row += 6;
  }
  H = (whiten_ * H).eval();

  const double weight = 1 / (options_.deviation * options_.deviation);
  Eigen::Matrix3d A = H.transpose() * H;
  A.diagonal().array() += weight;
  const Eigen::Vector3d b = H.transpose() * whitened_;
  const Eigen::Matrix3Xd& x = model.positions();
  const Eigen::Vector3d corner = x.col(place.corners[0]);
  const Eigen::Vector3d inward =
      -(x.col(place.corners[1]) - corner).cross(x.col(place.corners[2]) - corner).normalized();
  const double before = whitened_.squaredNorm();
  const auto explained_by = [&](const Eigen::Vector3d& force, double improbability) {
    const double after = (whitened_ - H * force).squaredNorm();
    Found found;
    found.place = index;
    found.force_O = force;
    const Eigen::Matrix3d along = inward * inward.transpose();
    const double sideways = std::max(kLeastSideways, options_.usual * force.norm());
    found.covariance = options_.deviation * options_.deviation * along +
                       sideways * sideways * (Eigen::Matrix3d::Identity() - along);
    found.cost = after + weight * force.squaredNorm() + improbability;
    found.share = before > 0 ? 1 - found.cost / before : 0;
    return found;
  };
  const double straight = std::max(0.0, inward.dot(b) / inward.dot(A * inward));
  const Found pressed = explained_by(straight * inward, 0);
  const Eigen::Vector3d force = A.ldlt().solve(b);
  const double normal = inward.dot(force);
  const double across = (force - normal * inward).norm();
  if (!(across <= options_.friction * normal)) return pressed;  // outside the friction cone
  const double slope = across / (options_.usual * normal);
  const Found rubbed = explained_by(force, slope * slope);
  return rubbed.cost < pressed.cost ? rubbed : pressed;
}

double ContactSearch::cost_of_setting_off(int grasp,
                                          const Eigen::Vector3d& outward_O) const noexcept {
  constexpr double kLevers[] = {0.1, 0.15, 0.2, 0.25};  // m, of hands with their payload
  // N, prior standard deviation: acceleration that is not yet seen times the mass of a hand.
  constexpr double kForce = 0.4;
  double least = HUGE_VAL;
  if (!held_[grasp]) return least;
  for (const double lever : kLevers) {
    Eigen::Matrix<double, Eigen::Dynamic, 3, 0, WrenchFilter::kMostRows, 3> H(whitened_.size(), 3);
    H.setZero();
    const int row = grasp == 1 && held_[0] ? 6 : 0;
    H.middleRows<3>(row).setIdentity();
    H.middleRows<3>(row + 3) = math::cross_matrix(lever * outward_O);
    H = (whiten_ * H).eval();
    Eigen::Matrix3d A = H.transpose() * H;
    A.diagonal().array() += 1 / (kForce * kForce);
    const Eigen::Vector3d b = H.transpose() * whitened_;
    least = std::min(least, whitened_.squaredNorm() - b.dot(A.ldlt().solve(b)));
  }
  return least;
}

bool ContactSearch::advance(const elasticity::DeformationModel& model, const PatchMotion& motion,
                            int places) noexcept {
  const int end = std::min(place_count(), next_ + places);
  for (; next_ < end; ++next_) {
    const Found found = judge(next_, model, motion);
    if (best_.place < 0 || found.cost < best_.cost) {
      const double kept = best_.place < 0 ? 0 : std::exp((found.cost - best_.cost) / 2);
      weight_ *= kept;
      weighted_ *= kept;
      squared_ *= kept;
      best_ = found;
    }
    const double weight = std::exp((best_.cost - found.cost) / 2);
    const Eigen::Vector3d p = places_[next_].point.interpolate(model.positions());
    weight_ += weight;
    weighted_ += weight * p;
    squared_ += weight * p.squaredNorm();
  }
  return !is_searching();
}

double ContactSearch::spread(int place, const elasticity::DeformationModel& model) const noexcept {
  if (!(weight_ > 0)) return 0;
  const Eigen::Vector3d p = places_[place].point.interpolate(model.positions());
  const Eigen::Vector3d mean = weighted_ / weight_;
  return std::sqrt(std::max(0.0, squared_ / weight_ - mean.squaredNorm()) +
                   (mean - p).squaredNorm());
}

}  // namespace palpate::estimation
