#include "core/control/motion_limits.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "core/math/option_check.hpp"

namespace palpate::control {
namespace {

using math::QuadraticProgram;
constexpr math::RowPriority kHard{}, kHandOfJoints{1, 10.0}, kGrasp{1, 1.0}, kContactForce{1, 0.6},
    kStrain{1, 0.3}, kObstacle{2, 1.0}, kWorkspace{3, 1.0};
// Relative motion below this fraction of a point's own is that of an aged sensitivity.
constexpr double kNoMotion = 0.05;
// At which an obstacle with a limit of force is touched: at an acceleration of 0.5 m/s^2 the hand
// rests after 25 um.
constexpr double kTouchSpeed = 5e-3;  // m/s
// Derivative of a contact force by a hand's motion beyond which it is that of a contact that the
// nodes of a grasp determine alone.
constexpr double kStiffest = 1e6;  // N/m
}  // namespace

/// Converts rows over the motion of the grasps into rows over the program's variables.
struct MotionLimits::Rows {
  QuadraticProgram& program;
  const Map& map;
  std::array<Limit, QuadraticProgram::kMostRows>& limit_of;
  double rate;       // of a position row: 1/s, or 1 for displacements
  bool is_velocity;  // variables are velocities, not displacements

  void add(const Row& row, double lower, double upper, Limit kind, math::RowPriority priority) {
    const Eigen::Matrix<double, 1, Eigen::Dynamic, Eigen::RowMajor, 1, 16> mapped =
        row.lazyProduct(map);
    note(program.add_row(mapped, lower, upper, priority), kind);
  }
  void note(int row, Limit kind) {
    if (row >= 0) limit_of[row] = kind;
  }
};

void HandLimits::check(const std::string& prefix, double bound) const {
  const std::pair<const char*, double> limits[] = {{"linear_speed", linear_speed},
                                                   {"angular_speed", angular_speed},
                                                   {"linear_acceleration", linear_acceleration},
                                                   {"angular_acceleration", angular_acceleration},
                                                   {"force", force},
                                                   {"torque", torque}};
  for (const auto& [name, value] : limits)
    math::check_option(value > 0 && value < bound, prefix + name, value,
                       "above 0 to below " + std::to_string(bound));
  math::check_box(workspace_lower, workspace_upper, prefix + "workspace");
}

void JointLimits::check() const {
  const auto n = speed.size();
  const std::string count = std::to_string(n) + ", as speed limits";
  math::check_option(lower.size() == n, "lower limits of joints", lower.size(), count);
  math::check_option(upper.size() == n, "upper limits of joints", upper.size(), count);
  math::check_option(acceleration.size() == n, "acceleration limits of joints", acceleration.size(),
                     count);
  for (Eigen::Index i = 0; i < n; ++i) {
    const std::string joint = "joint " + std::to_string(i) + ": ";
    math::check_option(upper[i] - lower[i] > 0 && std::isfinite(upper[i] - lower[i]),
                       joint + "lower limit", lower[i],
                       "below the upper limit, " + std::to_string(upper[i]) + ", both finite");
    math::check_positive(speed[i], joint + "speed limit");
    math::check_positive(acceleration[i], joint + "acceleration limit");
  }
}

MotionLimits::MotionLimits(const MotionLimitOptions& options, std::vector<int> grasps,
                           const elasticity::Body* body)
    : options_(options), grasps_(std::move(grasps)) {
  using math::check_not_negative;
  using math::check_positive;
  using math::check_positive_finite;
  const auto fraction = [](double value, const char* name) {
    math::check_option(value >= 0 && value < 1, name, value, "0 to below 1");
  };
  options.check("", std::numeric_limits<double>::infinity());
  check_positive_finite(options.damper, "damper");
  check_positive_finite(options.slip.friction, "slip.friction");
  check_positive_finite(options.slip.lever, "slip.lever");
  check_positive_finite(options.slip.width, "slip.width");
  check_not_negative(options.slip.pinch, "slip.pinch");
  check_not_negative(options.clearance_deviations, "clearance_deviations");
  check_not_negative(options.fallback_deviation, "fallback_deviation");
  check_not_negative(options.pivot, "pivot");
  fraction(options.slip.sticking, "slip.sticking");
  math::check_option(options.slip.normal_G.norm() > 1e-6, "slip.normal",
                     options.slip.normal_G.transpose(), "a vector longer than 1e-6");
  options_.slip.normal_G.normalize();
  math::check_option(options.obstacles.size() <= collision::kMostObstacles, "obstacles",
                     options.obstacles.size(),
                     "at most " + std::to_string(collision::kMostObstacles));
  std::vector<collision::Obstacle> watched;
  for (const LimitedObstacle& obstacle : options.obstacles) {
    obstacle.body.check();
    check_not_negative(obstacle.clearance, "clearance of " + obstacle.body.name);
    check_positive(obstacle.force, "force on " + obstacle.body.name);
    if (obstacle.may_touch && !std::isfinite(obstacle.force)) continue;
    watched_.push_back(static_cast<int>(&obstacle - options.obstacles.data()));
    watched.push_back(obstacle.body);
  }
  math::check_option(!grasps_.empty() && grasps_.size() <= 2, "grasps", grasps_.size(), "1 or 2");
  options.joints.check();
  math::check_option(options.joints.empty() || grasps_.size() == 1, "grasps", grasps_.size(),
                     "1, where joints are commanded");
  math::check_option(options.stress >= 0 && std::isfinite(options.stress), "stress", options.stress,
                     "at least 0");
  math::check_option(
      options.stretch == 0 || (options.stretch > 1 && std::isfinite(options.stretch)), "stretch",
      options.stretch, "above 1, or 0 for no limit");
  const bool strains = options.stress > 0 || options.stretch > 0;
  if ((strains || !watched.empty()) && body == nullptr)
    throw std::invalid_argument(
        "body: null; allowed: an object, where stress, stretch or a clearance is limited");
  fraction(options.strain_margin, "strain_margin");
  options_.stress *= 1 - options.strain_margin;
  if (options.stretch != 0)
    options_.stretch = 1 + (options.stretch - 1) * (1 - options.strain_margin);
  for (const std::optional<FlangeBox>& box : options.flange)
    if (box) math::check_box(box->lower, box->upper, "workspace of a flange");
  if (options.stress > 0) stress_.emplace(*body, elasticity::Strain::kStress);
  if (options.stretch > 0) stretch_.emplace(*body, elasticity::Strain::kStretch);
  if (!watched.empty()) gaps_.emplace(body->mesh, std::move(watched), options.fallback_deviation);
}

double MotionLimits::buckling_scale(const elasticity::DeformationModel& model) noexcept {
  const elasticity::Sensitivity& sensitivity = model.sensitivity();
  if (!sensitivity.valid || options_.pivot == 0) return 1;
  if (first_pivot_ == 0) first_pivot_ = sensitivity.smallest_pivot;
  if (!(first_pivot_ > 0)) return 1;
  const double share = sensitivity.smallest_pivot / first_pivot_;
  return std::clamp((share / options_.pivot - 0.25) / 0.75, 0.0, 1.0);
}

int MotionLimits::variables() const noexcept {
  return options_.joints.empty() ? size() : options_.joints.count();
}

void MotionLimits::look(const LawInputs& inputs) noexcept {
  if (inputs.model == nullptr) return;
  if (stress_) stress_->look(inputs.model->positions());
  if (stretch_) stretch_->look(inputs.model->positions());
  if (!gaps_) return;
  for (std::size_t i = 0; inputs.obstacles != nullptr && i < watched_.size(); ++i)
    gaps_->place(static_cast<int>(i), (*inputs.obstacles)[watched_[i]]);
  gaps_->look(inputs.model->positions(), inputs.node_deviation);
}

/// Limits each component of the hands' motion, and the speed along the present direction of motion,
/// which for a slowly turning motion is almost all of it. An excessive speed decreases at the
/// maximum deceleration.
void MotionLimits::add_rates(QuadraticProgram& program, const LawInputs& inputs, const Map& map,
                             const Motion& before, const Variables& variables_before) noexcept {
  Rows rows{program, map, limit_of_, 1, true};
  const double scale = inputs.model == nullptr ? 1 : this->buckling_scale(*inputs.model);
  const math::RowPriority priority = options_.joints.empty() ? kHard : kHandOfJoints;
  for (int i = 0; i < size(); ++i) {
    const bool linear = i % 6 < 3;
    const double speed = scale * (linear ? options_.linear_speed : options_.angular_speed);
    const double change =
        inputs.dt * (linear ? options_.linear_acceleration : options_.angular_acceleration);
    rows.add(Row::Unit(size(), i),
             std::min(std::max(-speed, before[i] - change), before[i] + change),
             std::max(std::min(speed, before[i] + change), before[i] - change), Limit::kHandRate,
             priority);
    if (i % 3 != 0) continue;
    const Eigen::Vector3d way = before.segment<3>(i);
    const double now = way.norm();
    Row row = Row::Zero(1, size());
    if (now > 0) row.segment<3>(i) = way.transpose() / now;
    rows.add(row, -QuadraticProgram::kNoBound, std::max(speed, now - change), Limit::kHandRate,
             priority);
  }
  const JointLimits& joints = options_.joints;
  for (int i = 0; i < joints.count(); ++i) {
    const double now = variables_before[i], change = inputs.dt * joints.acceleration[i];
    const double lower = std::min(std::max(-joints.speed[i], now - change), now + change);
    const double upper = std::max(std::min(joints.speed[i], now + change), now - change);
    rows.note(program.add_bound(i, lower, upper), Limit::kJointRate);
  }
}

void MotionLimits::add_places(QuadraticProgram& program, const LawInputs& inputs, const Map& map,
                              const Variables& variables_before) noexcept {
  Rows rows{program, map, limit_of_, options_.damper, true};
  const JointLimits& joints = options_.joints;
  for (int i = 0; i < joints.count(); ++i) {
    // Within the bounds of add_rates(), so that the two never contradict each other.
    const double now = variables_before[i], change = inputs.dt * joints.acceleration[i];
    const double down = std::min(0.0, joints.lower[i] - inputs.joints->q[i]) * options_.damper;
    const double up = std::max(0.0, joints.upper[i] - inputs.joints->q[i]) * options_.damper;
    rows.note(program.add_bound(i, std::min(down, now + change), std::max(up, now - change)),
              Limit::kJoint);
  }
  add_all_places(rows, inputs);
}

void MotionLimits::add_gaps(QuadraticProgram& program, const LawInputs& inputs,
                            const Map& map) noexcept {
  Rows rows{program, map, limit_of_, 1, false};
  const JointLimits& joints = options_.joints;
  for (int i = 0; i < joints.count(); ++i) {
    const double q = inputs.joints->q[i];
    rows.note(program.add_bound(i, std::min(0.0, joints.lower[i] - q),
                                std::max(0.0, joints.upper[i] - q)),
              Limit::kJoint);
  }
  add_all_places(rows, inputs);
}

void MotionLimits::add_all_places(Rows& rows, const LawInputs& inputs) noexcept {
  if (inputs.model == nullptr || !inputs.model->sensitivity().valid) return;
  const elasticity::DeformationModel& model = *inputs.model;
  const int moving = static_cast<int>(grasps_.size());
  for (int g = 0; g < moving; ++g) add_wrench(rows, inputs, g);
  if (stress_) add_strain(rows, model, *stress_, options_.stress, Limit::kStress);
  if (stretch_) add_strain(rows, model, *stretch_, options_.stretch, Limit::kStretch);
  add_obstacles(rows, inputs);
  for (int g = 0; g < moving; ++g) add_workspace(rows, inputs, g);
}

void MotionLimits::add_workspace(Rows& rows, const LawInputs& inputs, int moving) noexcept {
  const math::Pose& X_OG = inputs.X_OG[grasps_[moving]];
  const auto add = [&](const Row& row, double lower, double upper, double now) {
    rows.add(row, rows.rate * (lower - now), rows.rate * (upper - now), Limit::kWorkspace,
             kWorkspace);
  };
  for (int axis = 0; axis < 3; ++axis)
    add(Row::Unit(size(), 6 * moving + axis), options_.workspace_lower[axis],
        options_.workspace_upper[axis], X_OG.translation()[axis]);

  const std::optional<FlangeBox>& box = options_.flange[grasps_[moving]];
  if (!box) return;
  const Eigen::Vector3d arm_O = X_OG.linear() * box->p_G_E;
  const Eigen::Vector3d p_WE = box->X_WO * (X_OG.translation() + arm_O);
  for (int axis = 0; axis < 3; ++axis) {
    // v_E = v_G + w x arm, so that its component along n is n . v_G + (arm x n) . w.
    const Eigen::Vector3d n_O = box->X_WO.linear().row(axis).transpose();
    Row row = Row::Zero(1, size());
    row.segment<3>(6 * moving) = n_O.transpose();
    row.segment<3>(6 * moving + 3) = arm_O.cross(n_O).transpose();
    add(row, box->lower[axis], box->upper[axis], p_WE[axis]);
  }
}

void MotionLimits::add_wrench(Rows& rows, const LawInputs& inputs, int moving) noexcept {
  const int grasp = grasps_[moving];
  // d wrench / d motion, of this hand with respect to all moving grasps
  WrenchRows K(6, size());
  for (int other = 0; other < static_cast<int>(grasps_.size()); ++other)
    K.middleCols<6>(6 * other) = inputs.model->sensitivity().dw_dxi[grasp][grasps_[other]];
  const math::Vector6d w = inputs.reaction[grasp].vector();
  for (int i = 0; i < 6; ++i) {
    const double limit = i < 3 ? options_.force : options_.torque;
    rows.add(K.row(i), rows.rate * (-limit - w[i]), rows.rate * (limit - w[i]), Limit::kWrench,
             kGrasp);
  }
  if (options_.slip.pinch > 0) add_slip(rows, inputs.X_OG[grasp].linear(), w, K);
}

/// Tangent planes of each finger's friction ellipsoid: at the present direction of the load, which
/// remains the active one from tick to tick, and along the ellipsoid's axes, for displacements that
/// turn the load.
void MotionLimits::add_slip(Rows& rows, const Eigen::Matrix3d& R_OG, const math::Vector6d& w,
                            const WrenchRows& K) noexcept {
  const SlipCone& slip = options_.slip;
  const Eigen::Vector3d n = R_OG * slip.normal_G;
  const Eigen::Vector3d side = n.unitOrthogonal();
  const Eigen::Vector3d other_side = n.cross(side);
  const Eigen::Vector3d force = w.head<3>(), torque = w.tail<3>();
  const double friction = (1 - slip.sticking) * slip.friction;
  for (const int finger : {1, -1}) {
    // Components of the load: tangential force, divided by its limit on the two sides, and torque
    // over the lever.
    const Eigen::Vector3d across = 0.5 * force + finger / slip.width * torque.cross(n);
    const Eigen::Vector3d load(side.dot(across), other_side.dot(across),
                               0.5 * n.dot(torque) / slip.lever);
    const double size = load.norm();
    for (int plane = 0; plane < 7; ++plane) {
      Eigen::Vector3d d = plane % 2 == 0 ? Eigen::Vector3d(Eigen::Vector3d::Unit(plane / 2 % 3))
                                         : Eigen::Vector3d(-Eigen::Vector3d::Unit(plane / 2));
      if (plane == 6 && size > 0) d = load / size;
      const Eigen::Vector3d d_across = d[0] * side + d[1] * other_side;
      math::Vector6d by_wrench;
      by_wrench << 0.5 * d_across + 0.5 * friction * finger * n,
          finger / slip.width * n.cross(d_across) + 0.5 * d[2] / slip.lever * n;
      const Row row = by_wrench.transpose().lazyProduct(K);
      rows.add(row, -QuadraticProgram::kNoBound,
               rows.rate * (friction * slip.pinch - by_wrench.dot(w)), Limit::kWrench, kGrasp);
    }
  }
}

/// Limits the strain of each of the most loaded elements through the motion of its nodes.
void MotionLimits::add_strain(Rows& rows, const elasticity::DeformationModel& model,
                              const elasticity::WorstElements& worst, double limit,
                              Limit kind) noexcept {
  const Eigen::MatrixXi& elements = worst.mesh().elements;
  for (const elasticity::ElementStrain& one : worst.kept()) {
    Row row = Row::Zero(1, size());
    double upper = QuadraticProgram::kNoBound;
    if (one.element >= 0) {
      for (int moving = 0; moving < static_cast<int>(grasps_.size()); ++moving) {
        const auto& S = model.sensitivity().dx_dxi[grasps_[moving]];
        for (int a = 0; a < one.by_node.cols(); ++a)
          row.segment<6>(6 * moving) += one.by_node.col(a).transpose().lazyProduct(
              S.middleRows<3>(3 * elements(a, one.element)));
      }
      upper = rows.rate * (limit - one.value);
    }
    rows.add(row, -QuadraticProgram::kNoBound, upper, kind, kStrain);
  }
}

void MotionLimits::add_obstacles(Rows& rows, const LawInputs& inputs) noexcept {
  for (std::size_t i = 0; i < watched_.size(); ++i) {
    const LimitedObstacle& limited = options_.obstacles[watched_[i]];
    const ObstacleGaps::Point* points = gaps_->points().data() + ObstacleGaps::kPoints * i;
    for (int k = 0; k < ObstacleGaps::kPoints; ++k)
      add_near_point(rows, inputs, gaps_->obstacle(static_cast<int>(i)), points[k], limited);
  }
  for (std::size_t i = 0; i < options_.obstacles.size(); ++i) {
    const double limit = options_.obstacles[i].force;
    if (std::isfinite(limit)) add_contact_force(rows, *inputs.model, static_cast<int>(i), limit);
  }
}

/// Limits how fast the point approaches the obstacle, which may move, with a hand that moves or by
/// itself.
void MotionLimits::add_near_point(Rows& rows, const LawInputs& inputs,
                                  const collision::Obstacle& obstacle,
                                  const ObstacleGaps::Point& point,
                                  const LimitedObstacle& limited) noexcept {
  if (limited.may_touch && !rows.is_velocity) return;
  Row row = Row::Zero(1, size());
  double own_motion = 0;
  bool is_carried = false;  // by a hand that moves
  for (int moving = 0; moving < static_cast<int>(grasps_.size()); ++moving) {
    const int grasp = grasps_[moving];
    const auto& S = inputs.model->sensitivity().dx_dxi[grasp];
    for (int i = 0; i < point.on.count; ++i)
      row.segment<6>(6 * moving) +=
          point.on.weights[i] *
          point.away_O.transpose().lazyProduct(S.middleRows<3>(3 * point.on.nodes[i]));
    own_motion = std::max(own_motion, row.segment<6>(6 * moving).norm());
    if (obstacle.hand != grasp) continue;
    is_carried = true;
    const Eigen::Vector3d arm = point.on.position - inputs.X_OG[grasp].translation();
    row.segment<3>(6 * moving) -= point.away_O.transpose();
    row.segment<3>(6 * moving + 3) -= arm.cross(point.away_O).transpose();
  }
  const double margin = limited.clearance + options_.clearance_deviations * point.deviation;
  const double fastest = limited.may_touch ? kTouchSpeed + rows.rate * std::max(point.gap, 0.0)
                                           : rows.rate * (point.gap - margin);
  const double approach = rows.is_velocity && !is_carried
                              ? point.away_O.dot(obstacle.velocity_at(point.on.position))
                              : 0;  // m/s
  // a point that moves with the obstacle, or not at all, keeps its distance
  const double lower =
      row.norm() > kNoMotion * own_motion ? approach - fastest : -QuadraticProgram::kNoBound;
  rows.add(row, lower, QuadraticProgram::kNoBound, Limit::kObstacle, kObstacle);
}

/// Limits the sum of the model's normal forces on an obstacle.
void MotionLimits::add_contact_force(Rows& rows, const elasticity::DeformationModel& model,
                                     int obstacle, double limit) noexcept {
  double force = 0;  // N
  for (const elasticity::SurfaceContact& contact : model.contacts()) {
    if (contact.obstacle == obstacle) force += contact.normal_force();
  }
  Row row = Row::Zero(1, size());
  for (int moving = 0; moving < static_cast<int>(grasps_.size()); ++moving)
    row.segment<6>(6 * moving) =
        model.sensitivity().dcontact_dxi[static_cast<std::size_t>(obstacle)][grasps_[moving]];
  // zero until a sensitivity has been computed in contact
  const bool is_known = !row.isZero(0) && row.norm() < kStiffest;
  const double upper = is_known ? rows.rate * (limit - force) : QuadraticProgram::kNoBound;
  if (!is_known) row.setZero();
  rows.add(row, -QuadraticProgram::kNoBound, upper, Limit::kContactForce, kContactForce);
}

}  // namespace palpate::control
