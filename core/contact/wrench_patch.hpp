#pragma once

#include <vector>

#include "core/contact/force_transformer.hpp"
#include "core/mesh/closest_point.hpp"
#include "core/mesh/point_locator.hpp"

namespace palpate::contact {

/// Distributes a wrench over the surface nodes of a patch such that the nodal forces sum exactly to
/// its force and their moments about the contact's location to its torque. The weight of each node
/// is its load under uniform pressure (on quadratic meshes that of the midside nodes) times a
/// smooth kernel of its distance. Of all loads with that force and torque the one with the smallest
/// weighted norm is chosen: f_i = w_i (F + b x (x_i - c)) with the weighted centroid c. The loads
/// may contain both pressure and tension where the torque requires it.
class WrenchPatch : public ForceTransformer {
 public:
  struct Options {
    /// m, radius of the patch; increased if it contains too few nodes
    double radius = 0.03;
    double collision_distance = 0.01;  // m: contacts farther from the surface are rejected
    /// Nodes that always carry the load: a grasp without slip. Empty: the patch follows the
    /// contact.
    std::vector<int> fixed_nodes;
    /// With fixed nodes: rest point (m, in O) about which the wrench acts. It moves with the mesh;
    /// the reported location of the contact is ignored, because a distance between mesh and hand
    /// would otherwise produce a torque.
    Eigen::Vector3d fixed_reference = Eigen::Vector3d::Zero();
  };

  /// Throws std::invalid_argument naming the invalid option, or for a mesh without a surface.
  WrenchPatch(const mesh::ElementMesh& mesh, const mesh::Surface& surface, const Options& options);

  int max_nodes() const noexcept override { return static_cast<int>(patch_.capacity()); }
  void distribute(const sensing::Contact& contact, const Eigen::Matrix3Xd& positions,
                  ContactLoads& out) noexcept override;

 private:
  struct Member {
    int node = 0;
    double share = 0;   // share of a uniform pressure
    double weight = 0;  // weight in the patch, sum 1
  };

  /// Fills patch_ with the candidate nodes within `radius` of `centre`.
  void gather(const Eigen::Vector3d& centre, double radius,
              const Eigen::Matrix3Xd& positions) noexcept;
  /// Distributes F and T about `location` over patch_. False if its nodes are collinear and cannot
  /// carry the torque.
  bool spread(const math::Wrench& wrench, const Eigen::Vector3d& location,
              const Eigen::Matrix3Xd& positions, ContactLoads& out) const noexcept;

  Options options_;
  bool fixed_;
  mesh::PointWeights reference_;  // reference point of a fixed patch
  Eigen::Matrix3Xd rest_positions_;
  Eigen::Matrix3Xi triangles_;
  std::vector<Member> candidates_;  // nodes that may carry load
  std::vector<Member> patch_;       // nodes of this tick; capacity for all
};

}  // namespace palpate::contact
