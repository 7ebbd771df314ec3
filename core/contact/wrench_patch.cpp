#include "core/contact/wrench_patch.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>

#include "core/math/option_check.hpp"

namespace palpate::contact {
namespace {

constexpr int kWidenings = 24;  // each of them doubles the radius
// Smallest ratio of moments of inertia of a patch that is not a line.
constexpr double kFlatness = 1e-3;
constexpr int kLeastNodes = 3;

/// Load of each node under uniform pressure on the triangles whose nodes are all in `members`: one
/// third of each triangle per corner, or per midside node if it is quadratic (whose corner
/// functions have zero mean).
Eigen::VectorXd pressure_shares(const mesh::ElementMesh& mesh, const mesh::Surface& surface,
                                const std::vector<bool>& members) {
  Eigen::VectorXd shares = Eigen::VectorXd::Zero(mesh.node_count());
  for (int t = 0; t < surface.triangles.cols(); ++t) {
    const std::vector<int>& nodes = surface.triangle_nodes[t];
    if (!std::all_of(nodes.begin(), nodes.end(), [&](int node) { return members[node]; })) continue;
    const Eigen::Vector3d a = mesh.nodes.col(surface.triangles(0, t));
    const Eigen::Vector3d b = mesh.nodes.col(surface.triangles(1, t));
    const Eigen::Vector3d c = mesh.nodes.col(surface.triangles(2, t));
    const double third = (b - a).cross(c - a).norm() / 6;
    const std::size_t first = nodes.size() == 6 ? 3 : 0;
    for (std::size_t i = first; i < first + 3; ++i) shares[nodes[i]] += third;
  }
  return shares;
}

}  // namespace

WrenchPatch::WrenchPatch(const mesh::ElementMesh& mesh, const mesh::Surface& surface,
                         const Options& options)
    : options_(options),
      fixed_(!options.fixed_nodes.empty()),
      rest_positions_(mesh.nodes),
      triangles_(surface.triangles) {
  math::check_positive(options.radius, "radius");
  math::check_positive(options.collision_distance, "collision_distance");
  math::check_option(triangles_.cols() > 0, "surface", triangles_.cols(), "at least one triangle");

  if (fixed_) reference_ = mesh::PointLocator(mesh).locate(options.fixed_reference);

  std::vector<bool> members(mesh.node_count(), !fixed_);
  for (const int node : options.fixed_nodes) {
    math::check_option(node >= 0 && node < mesh.node_count(), "fixed_nodes", node,
                       "the nodes of the mesh");
    members[node] = true;
  }
  Eigen::VectorXd shares = pressure_shares(mesh, surface, members);
  if ((shares.array() > 0).count() < kLeastNodes) {
    // no complete triangle: equal weights for all nodes of the set
    for (int node = 0; node < mesh.node_count(); ++node) shares[node] = members[node];
  }
  const double total = shares.sum();
  for (int node = 0; node < mesh.node_count(); ++node)
    if (shares[node] > 0) candidates_.push_back({node, shares[node] / total, shares[node] / total});
  math::check_option(static_cast<int>(candidates_.size()) >= kLeastNodes, "fixed_nodes",
                     candidates_.size(), "three or more on the surface");
  patch_.reserve(candidates_.size());
}

void WrenchPatch::gather(const Eigen::Vector3d& centre, double radius,
                         const Eigen::Matrix3Xd& positions) noexcept {
  patch_.clear();
  double total = 0;
  for (Member member : candidates_) {
    const double ratio_squared =
        (positions.col(member.node) - centre).squaredNorm() / (radius * radius);
    if (!(ratio_squared < 1)) continue;
    const double kernel = 1 - ratio_squared;
    member.weight = member.share * kernel * kernel;
    total += member.weight;
    patch_.push_back(member);
  }
  for (Member& member : patch_) member.weight /= total;
}

bool WrenchPatch::spread(const math::Wrench& wrench, const Eigen::Vector3d& location,
                         const Eigen::Matrix3Xd& positions, ContactLoads& out) const noexcept {
  // All quantities relative to the location, for accuracy far from the origin of O.
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();
  for (const Member& member : patch_) {
    centroid += member.weight * (positions.col(member.node) - location);
  }
  // J b is the moment about the centroid of the loads w_i (b x y_i)
  Eigen::Matrix3d moment = Eigen::Matrix3d::Zero();
  for (const Member& member : patch_) {
    const Eigen::Vector3d y = positions.col(member.node) - location - centroid;
    moment += member.weight * (y.squaredNorm() * Eigen::Matrix3d::Identity() - y * y.transpose());
  }
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(moment);
  const Eigen::Vector3d& eigenvalues = solver.eigenvalues();
  if (!(eigenvalues[0] > kFlatness * eigenvalues[2])) return false;

  out.loads.clear();
  for (const Member& member : patch_) {
    if (!out.push(member.node, Eigen::Vector3d::Zero())) return false;
  }
  // The second pass corrects rounding errors of the first: a torque on an almost collinear patch
  // causes loads far larger than the force that they sum to.
  math::Wrench left = wrench;
  for (int pass = 0; pass < 2; ++pass) {
    const Eigen::Vector3d b = solver.eigenvectors() * (solver.eigenvectors().transpose() *
                                                       (left.torque - centroid.cross(left.force)))
                                                          .cwiseQuotient(eigenvalues);
    const Eigen::Vector3d force = left.force;
    left = wrench;
    for (std::size_t i = 0; i < patch_.size(); ++i) {
      const Eigen::Vector3d r = positions.col(patch_[i].node) - location;
      out.loads[i].force += patch_[i].weight * (force + b.cross(r - centroid));
      left.force -= out.loads[i].force;
      left.torque -= r.cross(out.loads[i].force);
    }
  }
  return true;
}

void WrenchPatch::distribute(const sensing::Contact& contact, const Eigen::Matrix3Xd& positions,
                             ContactLoads& out) noexcept {
  out.source = contact.source;
  out.location = contact.location;
  out.accepted = false;
  out.loads.clear();
  if (!contact.wrench.force.allFinite() || !contact.wrench.torque.allFinite() ||
      !contact.location.allFinite())
    return;

  const bool at_rest_point = contact.source == sensing::Source::kManual;
  Eigen::Vector3d location = contact.location;
  mesh::SurfacePoint touched;
  if (at_rest_point || !fixed_) {
    touched = mesh::closest_point_on_surface(location, triangles_,
                                             at_rest_point ? rest_positions_ : positions);
    if (touched.triangle < 0 || !(touched.distance <= options_.collision_distance)) return;
  }
  if (at_rest_point) {
    // present position of the same material point
    location.setZero();
    for (int i = 0; i < 3; ++i)
      location += touched.weights[i] * positions.col(triangles_(i, touched.triangle));
  }

  if (fixed_) {
    location = reference_.interpolate(positions);
    patch_.assign(candidates_.begin(), candidates_.end());
    out.accepted = spread(contact.wrench, location, positions, out);
  } else {
    const Eigen::Vector3d centre = at_rest_point ? location : touched.position;
    double radius = options_.radius;
    for (int widening = 0; widening <= kWidenings && !out.accepted; ++widening) {
      gather(centre, radius, positions);
      out.accepted = static_cast<int>(patch_.size()) >= kLeastNodes &&
                     spread(contact.wrench, location, positions, out);
      radius *= 2;
    }
  }
  if (!out.accepted) out.loads.clear();
}

}  // namespace palpate::contact
