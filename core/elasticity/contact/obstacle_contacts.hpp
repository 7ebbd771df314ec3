#pragma once

#include <array>
#include <vector>

#include "core/elasticity/contact/cone_problem.hpp"
#include "core/elasticity/contact/contact_list.hpp"
#include "core/elasticity/incremental/step_potential.hpp"
#include "core/elasticity/incremental/warped_factor.hpp"
#include "core/elasticity/static_response.hpp"

namespace palpate::elasticity {

/// Contact forces of a step: loads of the quasi-Newton iteration that satisfy Signorini's and
/// Coulomb's laws (ConeProblem) together with each correction. Gaps are those of the exact
/// distances at the present positions, slip is the displacement relative to the obstacle, which may
/// move, and the residual is that of the exact element forces, so that the solution does not depend
/// on the age of the factor whose compliances are used. Surfaces are sampled (surface_samples).
/// Nothing allocates after construction.
class ObstacleContacts {
 public:
  /// All must outlive this object. `samples`: in the solver's numbering. Throws
  /// std::invalid_argument if an option is out of range.
  ObstacleContacts(const NumberedBody& body, const BoundaryConditions& boundary,
                   WarpedFactor& factor, const ContactOptions& options,
                   const std::vector<mesh::PointWeights>& samples);

  /// Samples of the surface of `body` in the solver's numbering; none without obstacles.
  static std::vector<mesh::PointWeights> numbered_samples(const NumberedBody& body,
                                                          const ContactOptions& options);

  /// Moves an obstacle; to be called between steps.
  void place(int obstacle, const collision::Placement& placement) noexcept {
    list_.place(obstacle, placement);
  }

  /// Finds the contact points at `x`, where the step begins, and adds their forces, as of the last
  /// step, to the external forces. Computes missing compliances of points about to touch.
  void begin_step(const NodalField& x, StepPotential& potential) noexcept;
  /// Adds to `correction` of positions `x`, the response to the unbalanced forces, that to the
  /// changes of contact forces which it requires, and those to the external forces. Returns the
  /// change of the potential at `x`, J.
  double correct(const NodalField& x, Eigen::VectorXf& correction,
                 StepPotential& potential) noexcept;
  /// Largest violation of the contact laws at `x`, m: penetration, gap under force, motion of a
  /// sticking point, motion of a slipping one other than against its friction force.
  double violation(const NodalField& x) noexcept;
  /// Largest motion of a node, m, that carries no point past the obstacles that are listed for it;
  /// infinite while nothing touches.
  double farthest() const noexcept;
  double tolerance() const noexcept { return options_.tolerance; }
  /// Notes at the positions reached which points slip and from where.
  void finish_step(const NodalField& x) noexcept;

  /// Contact points, ordered by sample and obstacle.
  const std::vector<SurfaceContact>& contacts() const noexcept { return list_.contacts(); }
  bool is_touching() const noexcept;
  /// Sets, for a new factor, the samples whose compliances are wanted, the points under force, in
  /// mesh numbering, and the poses of obstacles. Both lists have room for ContactOptions::most.
  void describe(std::vector<int>& samples, Snapshot& snapshot) const noexcept;
  /// Number of points beyond the largest number, omitted in the last step.
  int omitted() const noexcept { return list_.omitted(); }
  /// Removes all contacts.
  void reset() noexcept;
  /// Takes over contacts, as contacts() returns them, with their forces and anchors.
  void restore(const std::vector<SurfaceContact>& contacts) noexcept { list_.restore(contacts); }
  /// To be called when the factor's table of compliances has been replaced or cleared.
  void forget_compliances() noexcept { problem_.forget_compliances(); }

 private:
  void complete_table() noexcept;
  double expected_share() noexcept;
  int free_place() const noexcept;
  void pose_problem(const NodalField& x, const Eigen::VectorXf& correction) noexcept;
  double friction_of(const SurfaceContact& contact) const noexcept {
    return list_.obstacle_of(contact).friction;
  }
  Eigen::Matrix3d rotation(int sample) const noexcept;

  const NumberedBody& body_;
  const BoundaryConditions& boundary_;
  WarpedFactor& factor_;
  const ContactOptions& options_;
  const std::vector<mesh::PointWeights>& samples_;
  std::vector<int> leading_;  // per sample: its node of the largest weight
  ContactList list_;
  ConeProblem problem_;
  std::vector<ConePoint> points_;  // of the cone problem
  std::vector<int> contact_of_;    // per point
  double size_;                    // m, of the body: lever of the hands' rotations
  Eigen::VectorXf forward_;        // workspace, three per unknown node
  std::array<math::Vector6d, 2> last_motion_{math::Vector6d::Zero(), math::Vector6d::Zero()};
  /// Fraction of a step's changes of force that recurs in the next one, 0 to 1.
  double persistence_ = 0;
};

}  // namespace palpate::elasticity
