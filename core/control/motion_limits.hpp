#pragma once

#include <array>
#include <optional>
#include <vector>

#include "core/control/control_law.hpp"
#include "core/control/obstacle_gaps.hpp"
#include "core/control/obstacle_limit.hpp"
#include "core/elasticity/worst_elements.hpp"
#include "core/math/quadratic_program.hpp"

namespace palpate::control {

/// Model of a pinch grasp: two soft fingers, `width` apart, press against each other along
/// `normal_G` with force `pinch` each. A finger bears tangential force and torque about the normal
/// within the ellipsoid (t / (friction N))^2 + (m / (friction N lever))^2 <= 1 (limit surface: Howe
/// and Cutkosky 1996). Each finger carries half of the hand's wrench; a pull along the normal
/// reduces its normal force N by half of that pull, and a torque across the normal acts as a couple
/// of tangential forces, one per finger.
///
/// A soft object starts to slip at the rim of the patch, long before the whole patch slides,
/// because it strains along the patch. If a finger bears the fraction q of the load at which the
/// whole patch slides, at least 1 - q of the patch still sticks: (1 - q)^(2/3) under round
/// fingertips (Mindlin 1949), 1 - q under a flat fingertip much stiffer than the object, whose
/// slipping strip bears the whole load.
struct SlipCone {
  double pinch = 0;  // N; 0: slip is not modelled
  double friction = 0.5;
  double lever = 0.02;  // m, lever arm of friction against rotation about the normal
  double width = 0.06;  // m
  /// Fraction of the patch that must not slip, in [0, 1); 0: at least some of it.
  double sticking = 0.5;
  Eigen::Vector3d normal_G = Eigen::Vector3d::UnitY();
};

/// Box in the workcell that contains the origin of the flange E carrying a grasp G.
struct FlangeBox {
  Eigen::Vector3d lower, upper;  // m, of the origin of E in W
  math::Pose X_WO = math::Pose::Identity();
  Eigen::Vector3d p_G_E = Eigen::Vector3d::Zero();  // m
};

/// The limits of the hand are those of the grasp frame G in O; force and torque limit each
/// component of a grasp's wrench.
struct MotionLimitOptions : HandLimits {
  SlipCone slip;
  /// Pa, von Mises stress limit of the object's most loaded elements; 0: no limit
  double stress = 0;
  double stretch = 0;  // limit of their largest principal stretch, above 1; 0: no limit
  /// Margin for estimation errors, as a fraction of the limit of stress and of the limit of stretch
  /// minus 1, in [0, 1).
  double strain_margin = 0;
  /// Workspace of the flange, by grasp, as the gate enforces it; the gate would stop the hand
  /// there, whereas these rows deflect its motion.
  std::array<std::optional<FlangeBox>, 2> flange;
  /// Obstacles of the configuration, in its order.
  std::vector<LimitedObstacle> obstacles;
  /// Number of standard deviations of the estimated position added to the clearance from obstacles:
  /// 2 cover 95 % of the true positions.
  double clearance_deviations = 2;
  /// m, fallback standard deviation when the estimator provides none: shapes from the hand's pose
  /// alone have a mean error of 0.8 mm under the mismatch "all", 2.7 mm at most.
  double fallback_deviation = 1e-3;
  /// Limits of commanded joints, for a single grasp; empty if twists are commanded.
  JointLimits joints;
  /// Damper rate, 1/s: a limit is approached no faster than by this fraction of the remaining
  /// distance per second, so that it is not passed between two evaluations (velocity damper:
  /// Faverjon and Tournassoud 1987).
  double damper = 5;
  /// The object is considered near buckling if the smallest pivot of its stiffness matrix falls
  /// below this fraction of the first one observed; motion is scaled down to zero at a quarter of
  /// it.
  double pivot = 0.2;
};

/// Kind of limit that a row of the program enforces.
enum class Limit {
  kHandRate,
  kJointRate,
  kWrench,
  kStress,
  kStretch,
  kObstacle,
  kContactForce,
  kWorkspace,
  kJoint
};

/// Rows of a quadratic program that enforce the limits. Its variables y move one or two grasps, u =
/// map y with u = (v, w) of each in O, m/s and rad/s. Hard limits: speed, acceleration and, if
/// joints are commanded, joint speed, acceleration and position. Soft limits, relaxed in the
/// reverse order of this list: wrench and slip, then forces on obstacles, then stress and stretch
/// (level 1), clearance from obstacles (level 2), workspace of the hand (level 3). If joints are
/// commanded, the hand's speed and acceleration limits are relaxed after all others. Reference:
/// docs/theory.md, section 6. Nothing allocates after construction.
class MotionLimits {
 public:
  using Motion = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 12, 1>;
  using Variables = math::ColumnFactor::Vector;
  using Map = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 12, 16>;

  /// `grasps`: indices of the moving grasps, one or two. `body`: object, required only for limits
  /// of stress and stretch and for clearance from obstacles. Throws std::invalid_argument if an
  /// option is out of range.
  MotionLimits(const MotionLimitOptions& options, std::vector<int> grasps,
               const elasticity::Body* body = nullptr);

  /// Number of variables of the program: joints, or six per grasp.
  int variables() const noexcept;

  /// Called once per tick, before rows are added: determines the most loaded elements and the
  /// points near obstacles.
  void look(const LawInputs& inputs) noexcept;

  /// Adds limits of speed and acceleration after `before` (motion and variables of the previous
  /// tick).
  void add_rates(math::QuadraticProgram& program, const LawInputs& inputs, const Map& map,
                 const Motion& before, const Variables& variables_before) noexcept;

  /// Adds limits of positions of object and hand, approached at the damper's rate.
  void add_places(math::QuadraticProgram& program, const LawInputs& inputs, const Map& map,
                  const Variables& variables_before) noexcept;

  /// Adds the same limits for a program over displacements: the distances to these limits.
  void add_gaps(math::QuadraticProgram& program, const LawInputs& inputs, const Map& map) noexcept;

  /// Limit enforced by a row of the last program; both programs' position rows have the same order.
  Limit limit_of(int row) const noexcept { return limit_of_[row]; }

  double peak_stress() const noexcept { return stress_ ? stress_->peak() : 0; }  // Pa

  /// Scale factor of the motion: 1 far from buckling, 0 at buckling.
  double buckling_scale(const elasticity::DeformationModel& model) noexcept;
  void reset() noexcept { first_pivot_ = 0; }

 private:
  using Row = Eigen::Matrix<double, 1, Eigen::Dynamic, Eigen::RowMajor, 1, 12>;
  using WrenchRows = Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, 12>;
  struct Rows;  // rows being added

  void add_all_places(Rows& rows, const LawInputs& inputs) noexcept;
  void add_wrench(Rows& rows, const LawInputs& inputs, int moving) noexcept;
  void add_slip(Rows& rows, const Eigen::Matrix3d& R_OG, const math::Vector6d& w,
                const WrenchRows& K) noexcept;
  void add_workspace(Rows& rows, const LawInputs& inputs, int moving) noexcept;
  void add_strain(Rows& rows, const elasticity::DeformationModel& model,
                  const elasticity::WorstElements& worst, double limit, Limit kind) noexcept;
  void add_obstacles(Rows& rows, const LawInputs& inputs) noexcept;
  void add_near_point(Rows& rows, const LawInputs& inputs, const collision::Obstacle& obstacle,
                      const ObstacleGaps::Point& point, const LimitedObstacle& limited) noexcept;
  void add_contact_force(Rows& rows, const elasticity::DeformationModel& model, int obstacle,
                         double limit) noexcept;
  int size() const noexcept { return 6 * static_cast<int>(grasps_.size()); }

  MotionLimitOptions options_;
  std::vector<int> grasps_;
  std::optional<elasticity::WorstElements> stress_, stretch_;
  /// Indices of the obstacles whose distance matters: those that the object may not touch, or may
  /// only touch slowly.
  std::vector<int> watched_;
  std::optional<ObstacleGaps> gaps_;  // to these
  std::array<Limit, math::QuadraticProgram::kMostRows> limit_of_{};
  double first_pivot_ = 0;
};

}  // namespace palpate::control
