#pragma once

#include "core/estimation/contact_search.hpp"
#include "core/estimation/hand_follower.hpp"
#include "core/estimation/step_watch.hpp"
#include "core/estimation/surface_fit.hpp"
#include "core/estimation/wrench_filter.hpp"

namespace palpate::estimation {

/// Estimator E3: the pose of the hand drives the mesh; a Kalman filter uses the wrench at the wrist
/// to estimate Young's modulus, the offset of the grasp, the bias of the sensor and, if these do
/// not explain the wrench, an unmodelled external contact (docs/theory.md, section 4). The
/// covariances weigh pose against wrench in each direction: the pose prevails where its deviation
/// is below that of the wrench divided by the stiffness of the grasp. Shape, deviations of the
/// shape and predicted wrench follow.
///
/// An external contact is searched for only while the hands rest, in the change of the wrenches
/// since the hands came to rest, because the errors of the model itself, which vary with the hand's
/// pose, are then constant. While the hands move, a contact found earlier is kept unchanged.
///
/// Estimator E4: observed surface points, whenever available, correct the same states and also
/// virtual loads, which absorb errors of the model's shape, so that a continuously observed shape
/// is tracked without steady-state error (docs/theory.md, section 5). Loads rather than an offset
/// of the feature keep shape, features and their Jacobian consistent with one mechanical state, and
/// the correction remains valid when observations stop. The wrench prediction excludes the virtual
/// loads. Corrections from observations are faded into the shape, which therefore never jumps.
///
/// Young's modulus changes without a new factorisation: an object k times as stiff has the shape of
/// the nominal one under 1 / k of its weight and loads, and k times its wrenches.
class PoseWrenchFilter : public Estimator {
 public:
  struct Options {
    HandFollower::Options hand;
    StepWatch::Options step;
    WrenchFilter::Options filter;
    ContactSearch::Options search;
    SurfaceFit::Options sight;
    /// m, prior standard deviation of the displacement by each virtual load. A smaller value gives
    /// a smaller error if the camera's own errors are uniform, but intervals that are too narrow:
    /// at 1 mm the 95 % intervals contain 83 % of the true positions.
    double shape = 5e-3;
    /// s, time over which corrections from observations are faded into the shape
    double fade = 0.15;
    double period = 0.01;   // s, between two wrench updates of the filter
    double force = 0.03;    // N, standard deviation of one wrench update, and of the model error
    double torque = 0.003;  // N m
    /// Relative model error of the predicted wrench and of the moment of its force about the
    /// object's centre. It stays constant until the hand has moved, regardless of the number of
    /// updates.
    double relative = 0.15;
    double way = 0.2;         // m, hand displacement over which the model error decorrelates
    double turn = 1;          // rad, hand rotation over which the model error decorrelates
    double correlation = 60;  // s, decorrelation time of the model error while the hand rests
    double lag = 0.01;        // s, delay of the wrench relative to the pose
    /// s, standard deviation of that delay: reduces the weight of wrenches of a moving hand
    double lag_deviation = 0.005;
    /// kg, error of the hand's mass or its delay in the sensor model: reduces the weight of the
    /// wrench while the hand accelerates. One fifth of a hand of 5 kg.
    double payload_error = 1;
    /// Chi-square gate on the innovation of a hand: larger ones are rejected.
    double gate = 40;
    /// Consecutive rejected innovations before an external contact is searched for.
    int suspicions = 3;
    bool contacts = true;  // whether external contacts are searched for
    /// m (rad: ten times as much), maximum distance of a resting hand from its rest pose
    double rest_distance = 3e-4;
    /// m (rad: ten times as much), maximum distance of a resting hand from its pose 0.1 s earlier
    double rest_recently = 5e-5;
    double rest = 0.3;  // s, rest time before a wrench change is attributed to an external contact
  };

  /// Throws std::invalid_argument if an option is out of range.
  PoseWrenchFilter(const elasticity::Body& body, const mesh::Surface& surface,
                   const Options& options);

  void activate(elasticity::DeformationModel& model) noexcept override;
  /// Degraded under the conditions of the pose-driven estimator, and while the wrench cannot be
  /// explained. Without a wrench the pose alone determines the shape.
  sensing::UpdateResult update(const EstimationInputs& inputs, elasticity::DeformationModel& model,
                               Estimate& estimate) noexcept override;
  void reset() noexcept override;
  void take_over(const Estimate& last, elasticity::DeformationModel& model) noexcept override;

  const WrenchFilter& filter() const noexcept { return filter_; }

 private:
  struct Hand {
    /// Predicted wrench, delayed as the measured one.
    math::Vector6d lagged = math::Vector6d::Zero();
    /// Sum of measured minus predicted wrenches since the last update of the filter.
    math::Vector6d sum = math::Vector6d::Zero();
    math::Vector6d sum_measured = math::Vector6d::Zero();  // sum of the measured wrenches
    int count = 0;
    math::Pose X_OG_before = math::Pose::Identity();
    math::Vector6d speed = math::Vector6d::Zero();         // m/s, rad/s, delayed as the wrench
    math::Vector6d acceleration = math::Vector6d::Zero();  // m/s^2, rad/s^2, mean over 50 ms
    /// Pose of the hand at which it came to rest.
    math::Pose X_OG_rest = math::Pose::Identity();
    /// Recent displacement from there (m, rad).
    math::Vector6d off_rest = math::Vector6d::Zero();
    math::Vector6d reaction_deviation = math::Vector6d::Constant(-1);
    bool known = false;
    /// Information of the next wrenches: 1 for independent ones, 0 for fully correlated ones.
    double information_gain = 1;
  };
  /// Innovation of all held hands with a wrench, and its dependence on the states.
  struct Innovation {
    std::array<bool, 2> held{};
    WrenchFilter::Rows H;
    WrenchFilter::Wrenches y;
    WrenchFilter::Noise R;
    WrenchFilter::Wrenches measured;
  };

  static constexpr double kPatience = 2;           // s, maximum duration of an unexplained change
  static constexpr double kLongAgo = 1e3;          // s
  static constexpr double kInformationTime = 0.2;  // s, time over which new information is absorbed

  WrenchFilter::ShapeState applied() const noexcept;  // state that the shape currently follows
  /// Young's modulus divided by its nominal value
  double stiffness() const noexcept;
  math::Pose correction(int grasp) const noexcept;
  void load_with_unknown(elasticity::DeformationModel& model) const noexcept;
  bool has_moved(int grasp, const GraspInput& input, double dt) noexcept;
  WrenchFilter::Rows wrench_rows(const std::array<bool, 2>& held,
                                 const elasticity::DeformationModel& model) const noexcept;
  SurfaceFit::Basis basis(const elasticity::DeformationModel& model) const noexcept;
  void update_observation(const ObservationInput& seen, elasticity::DeformationModel& model,
                          double dt) noexcept;
  void apply_observation(const elasticity::DeformationModel& model) noexcept;
  math::Vector6d wrench_of_shift(int grasp,
                                 const elasticity::DeformationModel& model) const noexcept;
  void predict_wrench(int grasp, const GraspInput& input, const elasticity::DeformationModel& model,
                      double dt) noexcept;
  Eigen::Vector2d inertial_error(const Hand& hand) const noexcept;
  math::Vector6d wrench_variance(int grasp, WrenchFilter::Rows H) const noexcept;
  Eigen::Vector2d size_of_wrench(int grasp, const WrenchFilter::Rows& H,
                                 const math::Vector6d& y) const noexcept;
  Innovation innovation(const elasticity::DeformationModel& model) noexcept;
  void update_wrench(const elasticity::DeformationModel& model) noexcept;
  void find_reaction_deviation(const Innovation& innovation) noexcept;
  void correct(const Innovation& innovation) noexcept;
  void follow(const std::array<bool, 2>& held, const WrenchFilter::Rows& H,
              WrenchFilter::Vector change) noexcept;
  int wrenches_in(double seconds) const noexcept;  // at least one
  bool is_settled(const Innovation& innovation) const noexcept;
  void accumulate_innovation(const Innovation& innovation) noexcept;
  void update_rest_baseline(const Innovation& now) noexcept;
  Innovation change(const Innovation& innovation) const noexcept;
  void detect_contact(const Innovation& innovation) noexcept;
  void follow_contact(Innovation innovation) noexcept;
  void add_unexplained(const WrenchFilter::Wrenches& change) noexcept;
  WrenchFilter::Noise noise(const WrenchFilter::Wrenches& pushed, int count) const noexcept;
  void place_contact(const ContactSearch::Found& found,
                     const elasticity::DeformationModel& model) noexcept;
  void judge_search(const elasticity::DeformationModel& model) noexcept;
  void judge_contact(const elasticity::DeformationModel& model, double dt) noexcept;
  void load_contact(const Eigen::Vector3d& force_O,
                    const elasticity::DeformationModel& model) noexcept;
  void drop_contact(const elasticity::DeformationModel& model) noexcept;
  void write_estimate(const elasticity::DeformationModel& model, int grasps,
                      Estimate& estimate) noexcept;
  void write_node_deviations(const elasticity::DeformationModel& model) noexcept;

  Options options_;
  std::array<double, 2> lever_{};  // m, from each grasp to the centre of the object, at rest
  HandFollower follower_;
  StepGuard step_guard_;
  StepWatch step_watch_;
  WrenchFilter filter_;
  PatchMotion motion_;
  ContactSearch search_;
  VirtualLoads loads_;
  SurfaceFit observation_fit_;
  ShapeHistory history_;
  /// Observations were received; the model has the virtual loads configured.
  bool is_seen_ = false;
  /// Difference between the state that the shape follows and the filter's mean.
  WrenchFilter::ShapeState shift_;
  std::array<Hand, 2> hands_;
  double since_taken_ = 0;                 // s
  double innovation_test_ = -1;            // per degree of freedom
  int rejected_innovations_ = 0;           // consecutive rejected innovations
  double rest_for_ = 0;                    // s
  WrenchFilter::Wrenches at_rest_;         // mean innovation since the hands came to rest
  WrenchFilter::Wrenches at_rest_spread_;  // mean square deviation of recent_ from it
  WrenchFilter::Wrenches at_rest_noise_;   // mean square deviation of latest_ from it
  /// Mean measured wrench while no external contact was present.
  WrenchFilter::Wrenches at_rest_measured_;
  WrenchFilter::Wrenches recent_;  // short-term mean innovation
  WrenchFilter::Wrenches latest_;
  std::array<bool, 2> at_rest_held_{};  // hands that these rows belong to
  int at_rest_count_ = 0;
  int place_ = -1;              // candidate index of the contact
  double place_deviation_ = 0;  // m, standard deviation of its location
  int sudden_ = 0;              // consecutive changes far beyond the noise
  /// The contact's contribution to the wrenches is barely above the noise.
  bool contact_below_noise_ = false;
  /// The wrenches have returned to their values at rest: the contact has ended.
  bool contact_released_ = false;
  double since_contact_ = kLongAgo;  // s since the last contact ended
  double weak_for_ = 0;              // s for which the contact's force has not been significant
  double unbelieved_for_ = 0;        // s for which the contact has not explained the wrench
  /// Mean change without the contact's contribution, since it began.
  WrenchFilter::Wrenches unexplained_;
  int unexplained_count_ = 0;
  int next_node_ = 0;
  std::vector<float> node_deviation_;
};

}  // namespace palpate::estimation
