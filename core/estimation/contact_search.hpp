#pragma once

#include <vector>

#include "core/elasticity/deformation_model.hpp"
#include "core/estimation/patch_motion.hpp"
#include "core/mesh/surface.hpp"

namespace palpate::estimation {

/// Searches the surface for a single external force that explains the difference between measured
/// and predicted wrenches of the hands. By Betti's reciprocity the change of a hand's wrench under
/// a force at a point is the negative transpose of the point's motion under the hand's motion: dw /
/// df = -(dx / dxi)^T. The sensitivity columns that the controller needs anyway therefore evaluate
/// every candidate point at once. The compliance of a grasp attenuates what its hand measures. One
/// hand provides six measurements for five unknowns. Reference: docs/theory.md, sections 4, 8 and
/// 9. Nothing allocates after construction.
class ContactSearch {
 public:
  struct Options {
    double spacing = 0.02;  // m, maximum distance between candidate points
    /// Tangent of the half angle of the cone about the inward normal that contains the force.
    double friction = 1;
    /// Tangent of the half angle of the cone that usually contains the force (prior): the wrench of
    /// one hand separates location and direction only poorly.
    double usual = 0.2;
    double deviation = 5;  // N, prior standard deviation of each component of the force
    /// m, largest standard deviation of a location that counts as observable
    double observable = 0.025;
  };
  /// Candidate point on the surface, with the corners of its triangle, oriented outward.
  struct Place {
    mesh::PointWeights point;
    Eigen::Vector3i corners = Eigen::Vector3i::Zero();
  };
  struct Found {
    int place = -1;                                     // index of the candidate; -1: none
    Eigen::Vector3d force_O = Eigen::Vector3d::Zero();  // N
    /// N^2, prior covariance of the force at that candidate
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    double cost = 0;   // remaining squared normalised innovation plus the prior cost of the force
    double share = 0;  // fraction of the squared normalised innovation by which that is less
  };

  /// Creates candidates on those parts of the surface that are neither fixed nor held. Throws
  /// std::invalid_argument if an option is not positive or no candidate remains.
  ContactSearch(const elasticity::Body& body, const mesh::Surface& surface, const Options& options);

  /// Starts a search. `y`, `S`: innovation without any unknown force and its covariance, six rows
  /// per held grasp, in order of the grasps; `held`: the grasps concerned.
  void begin(const WrenchFilter::Wrenches& y, const WrenchFilter::Noise& S,
             const std::array<bool, 2>& held) noexcept;
  /// Evaluates the next `places` candidates, so that a search can be spread over several ticks.
  /// Returns true when all candidates have been evaluated; found() is then the best. The model's
  /// sensitivity must be valid.
  bool advance(const elasticity::DeformationModel& model, const PatchMotion& motion,
               int places) noexcept;
  bool is_searching() const noexcept { return next_ < static_cast<int>(places_.size()); }
  const Found& found() const noexcept { return best_; }
  /// Standard deviation of the location about candidate `place`, m, over all candidates weighted by
  /// their likelihood. Call after a search has ended.
  double spread(int place, const elasticity::DeformationModel& model) const noexcept;
  const Options& options() const noexcept { return options_; }
  /// Evaluates how well candidate `place` explains the innovation passed to begin().
  Found judge(int place, const elasticity::DeformationModel& model,
              const PatchMotion& motion) const noexcept;

  /// Cost of the explanation that hand `grasp` has begun to move: a force at its centre of mass, at
  /// the origin of G plus a multiple of `outward_O` (unit vector), comparable with Found::cost.
  double cost_of_setting_off(int grasp, const Eigen::Vector3d& outward_O) const noexcept;

  /// dw / df of one hand for a force at a point, 6 x 3.
  static Eigen::Matrix<double, 6, 3> response(const mesh::PointWeights& point,
                                              const elasticity::Sensitivity& sensitivity,
                                              const PatchMotion& motion, int grasp) noexcept;

  const Place& place(int index) const noexcept { return places_[index]; }
  int place_count() const noexcept { return static_cast<int>(places_.size()); }

 private:
  Options options_;
  std::vector<Place> places_;
  int next_ = 0;
  Found best_;
  // Sums of 1, p and p p^T over the candidates, each weighted by exp((best cost - cost) / 2).
  double weight_ = 0, squared_ = 0;
  Eigen::Vector3d weighted_ = Eigen::Vector3d::Zero();
  // Inverse Cholesky factor of the innovation covariance, which whitens the innovation.
  WrenchFilter::Noise whiten_;
  WrenchFilter::Wrenches whitened_;
  std::array<bool, 2> held_{};
};

/// Points on those parts of the surface that are neither fixed nor held, at most `spacing` (m)
/// apart. Empty if there is none.
std::vector<ContactSearch::Place> contact_places(const elasticity::Body& body,
                                                 const mesh::Surface& surface, double spacing);

}  // namespace palpate::estimation
