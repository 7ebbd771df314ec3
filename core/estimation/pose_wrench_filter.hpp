#pragma once

#include "core/estimation/contact_search.hpp"
#include "core/estimation/hand_follower.hpp"
#include "core/estimation/step_watch.hpp"
#include "core/estimation/surface_fit.hpp"
#include "core/estimation/wrench_filter.hpp"

namespace palpate::estimation {

/// E3: the pose of the hand drives the mesh, and the wrench at the wrist says in a Kalman filter
/// how stiff the object is, how the grasp is shifted, what the sensor's bias is and, where nothing
/// of these explains it, where something else pushes (control.md 6.4). Trust goes to the pose where
/// its deviation is below that of the wrench over the stiffness of the grasp, direction by
/// direction, as the covariances have it. Shape, deviations of the shape and wrench follow.
///
/// A push is looked for only while the hands rest, in how the wrenches have changed since they came
/// to rest: then the model's own errors, which move with the hand, stand still. While they move,
/// what has been found stays as it is.
///
/// E4: points that are seen on the surface, whenever such come, correct the same states, and
/// besides virtual loads, which take up what the model does not know of its own shape, so that a
/// shape that is seen steadily is met without a steady error (control.md 6.5). Loads and not an
/// offset of the feature: shape, every feature and its Jacobian stay those of one mechanical state,
/// and what is learnt still holds when nothing is seen any more. The wrench is not asked to follow
/// them. What is learnt from what is seen fades into the shape, which therefore never jumps.
///
/// Young's modulus is changed without a new factor: an object k times as stiff has the shape of the
/// nominal one under 1 / k of weight and loads, and k times its wrenches.
class PoseWrenchFilter : public Estimator {
 public:
  struct Options {
    HandFollower::Options hand;
    StepWatch::Options step;
    WrenchFilter::Options filter;
    ContactSearch::Options search;
    SurfaceFit::Options sight;
    /// m, prior of what each virtual load moves the shape by. A narrower one is nearer where the
    /// camera's own errors are alike all over, but then its 95 % intervals hold too little: 83 % of
    /// the truth at 1 mm.
    double shape = 5e-3;
    double fade = 0.15;     // s, in which what was seen comes into the shape
    double period = 0.01;   // s, between two wrenches that the filter takes
    double force = 0.03;    // N, deviation of a wrench taken; of the model's error, too
    double torque = 0.003;  // N m
    /// Of the predicted wrench, and of its force at the object's middle: what the model itself may
    /// be wrong by. It is the same until the hand is elsewhere, however many wrenches are taken.
    double relative = 0.15;
    double way = 0.2;              // m, or
    double turn = 1;               // rad, that a hand goes until that error is another one;
    double correlation = 60;       // s, until it is where a hand rests
    double lag = 0.01;             // s, of the wrench behind the pose
    double lag_deviation = 0.005;  // s, uncertainty of that: a moving hand's wrench counts less
    /// kg of the hand that the sensor's model may have wrong, or late: while a hand accelerates its
    /// wrench counts less. A fifth of a hand of 5 kg.
    double payload_error = 1;
    double gate = 40;             // normalised square of a hand's innovation that is not believed
    int suspicions = 3;           // in a row, before a contact is looked for
    bool contacts = true;         // whether pushes are looked for
    double rest_distance = 3e-4;  // m, and ten times it in rad: within it a hand rests,
    double rest_recently = 5e-5;  // m, and so on: and within this of where it was 0.1 s before
    double rest = 0.3;  // s of rest, after which a change of the wrench is somebody else's
  };

  /// Throws std::invalid_argument where an option is out of range.
  PoseWrenchFilter(const elasticity::Body& body, const mesh::Surface& surface,
                   const Options& options);

  void activate(elasticity::DeformationModel& model) noexcept override;
  /// Degraded as the pose-driven estimator is, and while the wrench cannot be explained. Without a
  /// wrench the pose alone drives.
  sensing::UpdateResult update(const EstimationInputs& inputs, elasticity::DeformationModel& model,
                               Estimate& estimate) noexcept override;
  void reset() noexcept override;
  void take_over(const Estimate& last, elasticity::DeformationModel& model) noexcept override;

  const WrenchFilter& filter() const noexcept { return filter_; }

 private:
  struct Hand {
    math::Vector6d lagged = math::Vector6d::Zero();  // predicted wrench, as late as the measured
    /// Measured less predicted, of the wrenches since the last one taken.
    math::Vector6d sum = math::Vector6d::Zero();
    math::Vector6d sum_measured = math::Vector6d::Zero();  // and of themselves
    int count = 0;
    math::Pose X_OG_before = math::Pose::Identity();
    math::Vector6d speed = math::Vector6d::Zero();         // m/s, rad/s, as late as the wrench
    math::Vector6d acceleration = math::Vector6d::Zero();  // m/s^2, rad/s^2, of the last 50 ms
    math::Pose X_OG_rest = math::Pose::Identity();         // of the hand, where it came to rest
    math::Vector6d off_rest = math::Vector6d::Zero();      // from there, of late (m, rad)
    math::Vector6d reaction_deviation = math::Vector6d::Constant(-1);
    bool known = false;
    /// What the next wrenches can tell: 1 a whole one's worth, 0 nothing that is not told already.
    double news = 1;
  };
  /// Innovation of all held hands that told of a wrench, with what it follows.
  struct Innovation {
    std::array<bool, 2> held{};
    WrenchFilter::Rows H;
    WrenchFilter::Wrenches y;
    WrenchFilter::Noise R;
    WrenchFilter::Wrenches measured;
  };

  static constexpr double kPatience = 2;   // s, with a change that nothing explains
  static constexpr double kLongAgo = 1e3;  // s
  static constexpr double kTelling = 0.2;  // s, in which what is new is told

  WrenchFilter::ShapeState applied() const noexcept;  // what the shape follows at present
  double stiffness() const noexcept;                  // Young's modulus over its nominal value
  math::Pose correction(int grasp) const noexcept;
  void load_with_unknown(elasticity::DeformationModel& model) const noexcept;
  bool has_moved(int grasp, const GraspInput& input, double dt) noexcept;
  WrenchFilter::Rows wrench_rows(const std::array<bool, 2>& held,
                                 const elasticity::DeformationModel& model) const noexcept;
  SurfaceFit::Basis basis(const elasticity::DeformationModel& model) const noexcept;
  void see(const ObservationInput& seen, elasticity::DeformationModel& model, double dt) noexcept;
  void take_sight(const elasticity::DeformationModel& model) noexcept;
  math::Vector6d wrench_of_shift(int grasp,
                                 const elasticity::DeformationModel& model) const noexcept;
  void predict_wrench(int grasp, const GraspInput& input, const elasticity::DeformationModel& model,
                      double dt) noexcept;
  Eigen::Vector2d inertial_error(const Hand& hand) const noexcept;
  math::Vector6d wrench_variance(int grasp, WrenchFilter::Rows H) const noexcept;
  Eigen::Vector2d size_of_wrench(int grasp, const WrenchFilter::Rows& H,
                                 const math::Vector6d& y) const noexcept;
  Innovation innovation(const elasticity::DeformationModel& model) noexcept;
  void take(const elasticity::DeformationModel& model) noexcept;
  void find_reaction_deviation(const Innovation& innovation) noexcept;
  void correct(const Innovation& innovation) noexcept;
  void follow(const std::array<bool, 2>& held, const WrenchFilter::Rows& H,
              WrenchFilter::Vector change) noexcept;
  int wrenches_in(double seconds) const noexcept;  // at least one
  bool is_settled(const Innovation& innovation) const noexcept;
  void remember(const Innovation& innovation) noexcept;
  void settle(const Innovation& now) noexcept;
  Innovation change(const Innovation& innovation) const noexcept;
  void watch(const Innovation& innovation) noexcept;
  void follow_contact(Innovation innovation) noexcept;
  void add_unexplained(const WrenchFilter::Wrenches& change) noexcept;
  WrenchFilter::Noise noise(const WrenchFilter::Wrenches& pushed, int count) const noexcept;
  void place_contact(const ContactSearch::Found& found,
                     const elasticity::DeformationModel& model) noexcept;
  void judge_search(const elasticity::DeformationModel& model) noexcept;
  void judge_contact(const elasticity::DeformationModel& model, double dt) noexcept;
  void push(const Eigen::Vector3d& force_O, const elasticity::DeformationModel& model) noexcept;
  void drop_contact(const elasticity::DeformationModel& model) noexcept;
  void tell(const elasticity::DeformationModel& model, int grasps, Estimate& estimate) noexcept;
  void tell_nodes(const elasticity::DeformationModel& model) noexcept;

  Options options_;
  std::array<double, 2> lever_{};  // m, from each grasp to the object's middle, at rest
  HandFollower follower_;
  StepGuard step_guard_;
  StepWatch step_watch_;
  WrenchFilter filter_;
  PatchMotion motion_;
  ContactSearch search_;
  VirtualLoads loads_;
  SurfaceFit sight_;
  ShapeHistory history_;
  bool is_seen_ = false;            // or was: the model has been told of the virtual loads
  WrenchFilter::ShapeState shift_;  // of what the shape follows, from the filter's mean
  std::array<Hand, 2> hands_;
  double since_taken_ = 0;                   // s
  double innovation_test_ = -1;              // over its degrees of freedom
  int suspicions_ = 0;                       // innovations in a row that were not believed
  double rest_for_ = 0;                      // s
  WrenchFilter::Wrenches at_rest_;           // mean innovation since the hands came to rest
  WrenchFilter::Wrenches at_rest_spread_;    // mean square about it, of recent ones
  WrenchFilter::Wrenches at_rest_noise_;     // and of each
  WrenchFilter::Wrenches at_rest_measured_;  // mean wrench itself, while nobody pushed
  WrenchFilter::Wrenches recent_;            // mean innovation of late
  WrenchFilter::Wrenches latest_;
  std::array<bool, 2> at_rest_held_{};  // whose rows these are
  int at_rest_count_ = 0;
  int place_ = -1;                      // of the contact
  double place_deviation_ = 0;          // m, of where it is
  int sudden_ = 0;                      // changes in a row that are far beyond the noise
  bool faint_ = false;                  // the contact: its share of the wrenches hardly stands out
  bool gone_ = false;                   // the contact: the wrenches are as at rest
  double since_contact_ = kLongAgo;     // s since one has gone
  double weak_for_ = 0;                 // s that the contact's force has not stood out
  double unbelieved_for_ = 0;           // s that the contact has not explained the wrench
  WrenchFilter::Wrenches unexplained_;  // change without the contact, mean since it began
  int unexplained_count_ = 0;
  int next_node_ = 0;
  std::vector<float> node_deviation_;
};

}  // namespace palpate::estimation
