#pragma once

#include <vector>

#include "core/contact/force_transformer.hpp"
#include "core/contact/surface_search.hpp"
#include "core/mesh/point_locator.hpp"

namespace palpate::contact {

/// A wrench on the surface nodes of a patch, so that their forces sum to its force and their
/// moments about the contact's location to its torque, exactly. Each node weighs as much as uniform
/// pressure would load it (on quadratic meshes that is the midside nodes) times a smooth kernel of
/// its distance; of all loads with that force and torque the least in this weighted norm is taken:
/// f_i = w_i (F + b x (x_i - c)) with c the weighted centroid. Pushing and pulling loads may mix,
/// as a torque needs them.
class WrenchPatch : public ForceTransformer {
 public:
  struct Options {
    double radius = 0.03;              // m, of the patch; widened where it holds too few nodes
    double collision_distance = 0.01;  // m: contacts farther from the surface are refused
    /// Nodes that always carry the load: a grasp that does not slide. Empty: the patch follows the
    /// contact.
    std::vector<int> fixed_nodes;
    /// With fixed nodes: the rest point (m, in O) that the wrench is about. It moves with the mesh;
    /// where the contact is said to be does not count, since a mesh that is not where the hand is
    /// would turn their distance into a torque.
    Eigen::Vector3d fixed_reference = Eigen::Vector3d::Zero();
  };

  /// Throws std::invalid_argument naming the option that is wrong, or for a mesh without surface.
  WrenchPatch(const mesh::ElementMesh& mesh, const mesh::Surface& surface, const Options& options);

  int max_nodes() const noexcept override { return static_cast<int>(patch_.capacity()); }
  void distribute(const sensing::Contact& contact, const Eigen::Matrix3Xd& positions,
                  ContactLoads& out) noexcept override;

 private:
  struct Member {
    int node = 0;
    double share = 0;   // of a uniform pressure
    double weight = 0;  // in the patch, sum 1
  };

  /// Fills patch_ with the candidates within `radius` of `centre`.
  void gather(const Eigen::Vector3d& centre, double radius,
              const Eigen::Matrix3Xd& positions) noexcept;
  /// Spreads F and T about `location` over patch_; false where its nodes stand on one line and so
  /// cannot carry the torque.
  bool spread(const math::Wrench& wrench, const Eigen::Vector3d& location,
              const Eigen::Matrix3Xd& positions, ContactLoads& out) const noexcept;

  Options options_;
  bool fixed_;
  mesh::PointWeights reference_;  // of a fixed patch
  Eigen::Matrix3Xd rest_positions_;
  Eigen::Matrix3Xi triangles_;
  std::vector<Member> candidates_;  // nodes that may carry load
  std::vector<Member> patch_;       // those of this tick; capacity for all
};

}  // namespace palpate::contact
