#pragma once

#include <vector>

#include "core/elasticity/deformation_model.hpp"
#include "core/estimation/patch_motion.hpp"
#include "core/mesh/surface.hpp"

namespace palpate::estimation {

/// Looks on the surface for one force that would explain why the wrenches of the hands differ from
/// what is predicted. By reciprocity (Betti) the wrench of a hand follows a force at a point as the
/// point follows the motion of the hand: dw / df = -(dx / dxi)^T, so that the columns which the
/// controller has anyway answer for every point at once. A hand whose grasp gives way feels that
/// much less. One hand gives six numbers for five
/// unknowns. Reference: control.md 6.4, 6.9. Nothing allocates after construction.
class ContactSearch {
 public:
  struct Options {
    double spacing = 0.02;  // m, at most, of the places looked at
    double friction = 1;    // the force lies within this cone about the inward normal,
    double usual = 0.2;     // and most often within this one: one hand's wrench alone tells place
                            // and direction apart only poorly
    double deviation = 5;   // N, prior of each axis of the force
    double observable = 0.025;  // m: a place that is known less exactly is not observable
  };
  /// A place on the surface, with the corners of its triangle, outward.
  struct Place {
    mesh::PointWeights point;
    Eigen::Vector3i corners = Eigen::Vector3i::Zero();
  };
  struct Found {
    int place = -1;                                        // -1: none
    Eigen::Vector3d force_O = Eigen::Vector3d::Zero();     // N
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  // N^2, prior of the force at that place
    double share = 0;  // of the normalised square of the innovation: what the force explains
    double cost = 0;   // what remains of it, the force's own improbability included
  };

  /// Places on the surface that are neither fixed nor held. Throws std::invalid_argument where an
  /// option is not positive or no place is left.
  ContactSearch(const elasticity::Body& body, const mesh::Surface& surface, const Options& options);

  /// `y`, `S`: innovation and its covariance without any unknown force, six rows a held grasp in
  /// order; `held`: which grasps these are.
  void begin(const WrenchFilter::Wrenches& y, const WrenchFilter::Noise& S,
             const std::array<bool, 2>& held) noexcept;
  /// Looks at the next `places`, so that a search can be spread over ticks. True when all have been
  /// looked at; found() is then the best. The model's sensitivity must be valid.
  bool advance(const elasticity::DeformationModel& model, const PatchMotion& motion,
               int places) noexcept;
  bool is_searching() const noexcept { return next_ < static_cast<int>(places_.size()); }
  const Found& found() const noexcept { return best_; }
  /// Deviation of the force's place from `place`, m: over all places, each as probable as it
  /// explains what the search began with. Of a search that has ended.
  double spread(int place, const elasticity::DeformationModel& model) const noexcept;
  const Options& options() const noexcept { return options_; }
  /// How well another place explains what the search began with.
  Found judge(int place, const elasticity::DeformationModel& model,
              const PatchMotion& motion) const noexcept;

  /// dw / df at a place, 6 x 3, of a hand.
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
  // Of the places looked at, each weighted by exp((best cost - its cost) / 2): sums of 1, p, p p.
  double weight_ = 0, squared_ = 0;
  Eigen::Vector3d weighted_ = Eigen::Vector3d::Zero();
  // The innovation, whitened by the inverse of the Cholesky factor of its covariance.
  WrenchFilter::Noise whiten_;
  WrenchFilter::Wrenches whitened_;
  std::array<bool, 2> held_{};
};

}  // namespace palpate::estimation
