#pragma once

#include <array>
#include <optional>
#include <vector>

#include "core/control/control_law.hpp"
#include "core/control/obstacle_gaps.hpp"
#include "core/elasticity/worst_elements.hpp"
#include "core/math/quadratic_program.hpp"

namespace palpate::control {

/// How a pinch holds: two soft fingers, `width` apart, press against each other along `normal_G`
/// with `pinch` each. A finger bears the force across and the torque about the normal within the
/// ellipsoid (t / (friction N))^2 + (m / (friction N lever))^2 <= 1 (limit surface: Howe and
/// Cutkosky 1996). Of the hand's wrench it takes half, with a pull along the normal its press N is
/// less by half of that, and a torque across the normal is a couple of forces across, one a finger.
///
/// A soft object slips from the rim of a patch inwards, long before the whole patch slides, since
/// it strains along the patch. Where a finger bears the share q of what the whole patch can, at
/// least 1 - q of the patch still sticks: (1 - q)^(2/3) under round fingertips (Mindlin 1949), 1 -
/// q under a flat one much stiffer than the object, whose strip that slips bears all of the load.
struct SlipCone {
  double pinch = 0;  // N; 0: it cannot slip
  double friction = 0.5;
  double lever = 0.02;    // m, of friction against turning about the normal
  double width = 0.06;    // m
  double sticking = 0.5;  // share of the patch that must not slip, in [0, 1); 0: some of it
  Eigen::Vector3d normal_G = Eigen::Vector3d::UnitY();
};

/// The box of a cell that the flange E which carries a grasp G is to stay in.
struct FlangeBox {
  Eigen::Vector3d lower, upper;  // m, of the origin of E in W
  math::Pose X_WO = math::Pose::Identity();
  Eigen::Vector3d p_G_E = Eigen::Vector3d::Zero();  // m
};

struct MotionLimitOptions {
  double linear_speed = 1.0;          // m/s
  double angular_speed = 0.5;         // rad/s
  double linear_acceleration = 0.5;   // m/s^2
  double angular_acceleration = 2.0;  // rad/s^2
  double force = 1e3;                 // N, of each component of a grasp's wrench
  double torque = 1e3;                // N m
  SlipCone slip;
  double stress = 0;   // Pa, von Mises, of the object's worst elements; 0: no limit
  double stretch = 0;  // largest principal stretch of these, above 1; 0: no limit
  /// Share of the limits of stress and of stretch beyond 1 that is left free for what the estimate
  /// does not know, in [0, 1).
  double strain_margin = 0;
  Eigen::Vector3d workspace_lower{-1e3, -1e3, -1e3};  // m, of the origin of G, in O
  Eigen::Vector3d workspace_upper{1e3, 1e3, 1e3};
  /// By grasp: what the gate would stop the hand at, which would turn it aside from other limits.
  std::array<std::optional<FlangeBox>, 2> flange;
  std::vector<Obstacle> obstacles;  // at most kMostObstacles
  double clearance = 0.005;         // m, kept from obstacles
  /// Deviations of the estimated place that are kept beside the clearance: 2 hold 95 % of the
  /// truth.
  double clearance_deviations = 2;
  /// m, what this deviation is taken to be where the estimator tells none: by the hand's pose alone
  /// shapes are wrong by 0.8 mm in the mean under the mismatch "all", by 2.7 mm at most.
  double untold_deviation = 1e-3;
  JointLimits joints;  // where these are commanded, of the only grasp; else empty
  /// A limit is approached no faster than by this share of what is left, 1/s, so that it is not
  /// passed between two looks at it (a velocity damper: Faverjon and Tournassoud 1987).
  double damper = 5;
  /// The object nears buckling where the smallest pivot of its stiffness falls below this share of
  /// the first one seen; motion fades to rest at a quarter of it.
  double pivot = 0.2;
};

/// What a row of the program keeps.
enum class Limit {
  kHandRate,
  kJointRate,
  kWrench,
  kStress,
  kStretch,
  kObstacle,
  kWorkspace,
  kJoint
};

/// The rows of a quadratic program that keep these limits. Its variables y move one or two grasps,
/// u = map y with u = (v, w) of each in O, m/s and rad/s. Hard: speed, acceleration and, where
/// joints are commanded, these and their positions. Giving way, the last one first: wrench and
/// slip, then stress and stretch (level 1), obstacles (level 2), workspace of the hand (level 3).
/// For joints that must keep their own limits the hand's speed and acceleration give way after all
/// others. Reference: control.md 6.6. Nothing allocates after construction.
class MotionLimits {
 public:
  static constexpr int kMostObstacles = 4;
  using Motion = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 12, 1>;
  using Variables = math::ColumnFactor::Vector;
  using Map = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 12, 16>;

  /// `grasps`: which of the body's move, one or two. `body`: whose stress and stretch are limited
  /// or that keeps away from obstacles; needed for these alone. Throws std::invalid_argument where
  /// an option is out of range.
  MotionLimits(const MotionLimitOptions& options, std::vector<int> grasps,
               const elasticity::Body* body = nullptr);

  /// How many variables the program has: joints, or six a grasp.
  int variables() const noexcept;

  /// Once a tick, before rows are added: finds the worst elements and what is near obstacles.
  void look(const LawInputs& inputs) noexcept;

  /// How fast hands and joints may move after `before` (the motion and the variables of the tick
  /// before).
  void add_rates(math::QuadraticProgram& program, const LawInputs& inputs, const Map& map,
                 const Motion& before, const Variables& variables_before) noexcept;

  /// Where the object and the hand may be, approached at the damper's rate.
  void add_places(math::QuadraticProgram& program, const LawInputs& inputs, const Map& map,
                  const Variables& variables_before) noexcept;

  /// The same of a program over displacements: how far away these places are.
  void add_gaps(math::QuadraticProgram& program, const LawInputs& inputs, const Map& map) noexcept;

  /// What a row that was added last keeps; both programs' rows of places come in the same order.
  Limit limit_of(int row) const noexcept { return limit_of_[row]; }

  double peak_stress() const noexcept { return stress_ ? stress_->peak() : 0; }  // Pa

  /// 1 far from buckling, 0 at it.
  double ease(const elasticity::DeformationModel& model) noexcept;
  void reset() noexcept { first_pivot_ = 0; }

 private:
  using Row = Eigen::Matrix<double, 1, Eigen::Dynamic, Eigen::RowMajor, 1, 12>;
  using WrenchRows = Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, 12>;
  struct Rows;  // that are being added

  void add_all_places(Rows& rows, const LawInputs& inputs) noexcept;
  void add_wrench(Rows& rows, const LawInputs& inputs, int moving) noexcept;
  void add_slip(Rows& rows, const Eigen::Matrix3d& R_OG, const math::Vector6d& w,
                const WrenchRows& K) noexcept;
  void add_workspace(Rows& rows, const LawInputs& inputs, int moving) noexcept;
  void add_strain(Rows& rows, const elasticity::DeformationModel& model,
                  const elasticity::WorstElements& worst, double limit, Limit kind) noexcept;
  void add_near_point(Rows& rows, const elasticity::DeformationModel& model,
                      const ObstacleGaps::Point& point) noexcept;
  int size() const noexcept { return 6 * static_cast<int>(grasps_.size()); }

  MotionLimitOptions options_;
  std::vector<int> grasps_;
  std::optional<elasticity::WorstElements> stress_, stretch_;
  std::optional<ObstacleGaps> obstacles_;
  std::array<Limit, math::QuadraticProgram::kMostRows> limit_of_{};
  double first_pivot_ = 0;
};

}  // namespace palpate::control
