#pragma once

#include <vector>

#include "core/collision/candidate_search.hpp"
#include "core/elasticity/contact/contact_options.hpp"
#include "core/elasticity/contact/surface_contact.hpp"
#include "core/elasticity/incremental/boundary_conditions.hpp"

namespace palpate::elasticity {

/// Points of the surface within reach of obstacles, and those of them that can touch one in a step.
/// Distances change by no more than points move, so that a point whose gap exceeds the largest
/// motion since it was listed is neither evaluated nor considered; the list is renewed after a
/// motion of a fraction of the reach, when an obstacle has moved, and when the speed has changed.
/// Nothing allocates after construction.
class ContactList {
 public:
  /// All must outlive this object. `samples`: in the solver's numbering.
  ContactList(const NumberedBody& body, const BoundaryConditions& boundary,
              const ContactOptions& options, const std::vector<mesh::PointWeights>& samples);

  /// Moves an obstacle; to be called between steps.
  void place(int obstacle, const collision::Placement& placement) noexcept;
  const collision::Obstacle& obstacle_of(const SurfaceContact& contact) const noexcept {
    return obstacles_[contact.obstacle];
  }

  /// Lists the points at `x`, where a step begins, and evaluates those that may touch in it.
  void begin_step(const NodalField& x) noexcept;
  /// Adds to close() the points that can touch if the nodes move by up to `ahead` m from `x`.
  void look_ahead(const NodalField& x, double ahead) noexcept;
  /// Evaluates position, normal, gap and slip at `x`.
  void evaluate(SurfaceContact& contact, const NodalField& x) const noexcept;
  /// Slip counts from the present position on.
  void anchor(SurfaceContact& contact) const noexcept;

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
  void collect(const NodalField& x, double reach) noexcept;
  double reach_at(double step) const noexcept;
  void select(double ahead) noexcept;
  double travel(const NodalField& x, const NodalField& from) const noexcept;

  const NumberedBody& body_;
  const BoundaryConditions& boundary_;
  const ContactOptions& options_;
  std::vector<collision::Obstacle> obstacles_;
  const std::vector<mesh::PointWeights>& samples_;
  std::vector<int> patch_;  // per sample: grasp all of whose nodes it has, or -1
  double weight_sum_ = 1;   // largest sum of the absolute weights of a sample
  collision::CandidateSearch search_;
  std::vector<SurfaceContact> contacts_, found_;
  std::vector<int> close_;
  NodalField x_listed_, x_begin_;  // m, when the points were listed; at the beginning of the step
  factor::Held held_listed_{false, false};
  bool listed_ = false;
  double reach_ = 0;  // m, distance below which points were listed
  double ahead_ = 0;  // m, motion for which close_ is complete
  int omitted_ = 0;
};

}  // namespace palpate::elasticity
