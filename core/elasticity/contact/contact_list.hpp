#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/collision/candidate_search.hpp"
#include "core/elasticity/contact/contact_options.hpp"
#include "core/elasticity/incremental/boundary_conditions.hpp"

namespace palpate::elasticity {

/// Sample of the surface that touches an obstacle, or may soon. In O.
struct SurfaceContact {
  int sample = 0;
  int obstacle = 0;
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  // N, on the object
  bool slips = false;     // under force, and at the limit of friction, after the last step
  bool pressed = false;   // under force after the last step
  bool at_limit = false;  // of friction, with the normal at which the force was computed
  // As last evaluated; a point that could not touch since is not evaluated again:
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // m
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();   // unit vector out of the obstacle
  double gap = 0;                                      // m, negative inside
  double gap_when_listed = 0;  // m, at the positions from which ContactList counts motion
  /// m, where the point has stuck last, or was before it touched: slip counts from there, so that
  /// sticking points do not creep
  Eigen::Vector3d anchor = Eigen::Vector3d::Zero();
  Eigen::Vector3d force_before = Eigen::Vector3d::Zero();  // N, when the step began
  Eigen::Vector3d last_change = Eigen::Vector3d::Zero();   // N, of the force by the last step

  bool presses() const noexcept { return !force.isZero(0); }
  Eigen::Vector3d slip() const noexcept {
    const Eigen::Vector3d way = position - anchor;
    return way - normal.dot(way) * normal;
  }
};

/// Points of the surface within reach of obstacles, and those of them that can touch one in a step.
/// Distances change by no more than points move, so that a point whose gap exceeds the largest
/// motion since it was listed is neither evaluated nor considered; the list is renewed after a
/// motion of a fraction of the reach. Nothing allocates after construction.
class ContactList {
 public:
  /// All must outlive this object. `samples`: in the solver's numbering.
  ContactList(const NumberedBody& body, const BoundaryConditions& boundary,
              const ContactOptions& options, const std::vector<mesh::PointWeights>& samples);

  /// Lists the points at `x`, where a step begins, and evaluates those that may touch in it.
  void begin_step(const NodalField& x) noexcept;
  /// Adds to close() the points that can touch if the nodes move by up to `ahead` m from `x`.
  void look_ahead(const NodalField& x, double ahead) noexcept;
  /// Evaluates position, normal and gap at `x`.
  void evaluate(SurfaceContact& contact, const NodalField& x) const noexcept;

  /// Ordered by sample and obstacle.
  const std::vector<SurfaceContact>& contacts() const noexcept { return contacts_; }
  SurfaceContact& contact(int c) noexcept { return contacts_[c]; }
  /// Indices of contacts under force or near enough to touch in this step, ascending.
  const std::vector<int>& close() const noexcept { return close_; }
  bool contains(int sample) const noexcept;
  /// Number of points beyond the largest number, omitted when the list was made.
  int omitted() const noexcept { return omitted_; }
  void clear() noexcept;
  /// Takes over contacts, ordered by sample and obstacle, at most ContactOptions::most, from which
  /// the next step begins.
  void restore(const std::vector<SurfaceContact>& contacts) noexcept;

 private:
  void collect(const NodalField& x) noexcept;
  void select(double ahead) noexcept;
  double travel(const NodalField& x, const NodalField& from) const noexcept;

  const NumberedBody& body_;
  const BoundaryConditions& boundary_;
  const ContactOptions& options_;
  const std::vector<mesh::PointWeights>& samples_;
  std::vector<int> patch_;  // per sample: grasp all of whose nodes it has, or -1
  double weight_sum_ = 1;   // largest sum of the absolute weights of a sample
  collision::CandidateSearch search_;
  std::vector<SurfaceContact> contacts_, found_;
  std::vector<int> close_;
  NodalField x_listed_, x_begin_;  // m, when the points were listed; at the beginning of the step
  factor::Held held_listed_{false, false};
  bool listed_ = false;
  double ahead_ = 0;  // m, motion for which close_ is complete
  int omitted_ = 0;
};

}  // namespace palpate::elasticity
