// Estimation of unmeasured external contacts, over many random ones, in worlds of the estimator's
// own model and mesh with another modulus and hand's pose and the noise of the sensors' table; and
// the false alarm rate. Contacts in palpate-sim, another model and mesh, are scored by
// palpate-evaluate estimate --only pokes. PALPATE_POKES: number of contacts (40);
// PALPATE_REST_HOURS: of rest (0.05), both in simulated time.
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <random>

#include "core/elasticity/corotational_model.hpp"
#include "core/estimation/pose_wrench_filter.hpp"
#include "tests/support/refactor.hpp"
#include "tests/unit/core/estimation/rigid_model.hpp"

namespace palpate::estimation {
namespace {

using Eigen::Vector3d;
using elasticity::CorotationalQuasistatic;
using math::Vector6d;

// Of sim/sensors/sensors.yaml.
constexpr double kForceNoise = 0.025, kForceStep = 0.0125;    // N
constexpr double kTorqueNoise = 0.001, kTorqueStep = 0.0005;  // N m

double setting(const char* name, double usual) {
  const char* text = std::getenv(name);
  return text != nullptr ? std::atof(text) : usual;
}

double median(std::vector<double> values, double share = 0.5) {
  if (values.empty()) return std::nan("");
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(
      std::lround(share * static_cast<double>(values.size() - 1)))];
}

elasticity::Body unknown_push_bar() {
  return support::held_bar({8, 1, 1}, mesh::ElementOrder::kQuadratic);
}

/// The wrench of the hand as measured by its sensor: noise, quantisation, and drift, which is a
/// warm-up to 0.3 N within ten minutes and a random walk.
class Sensor {
 public:
  explicit Sensor(std::uint64_t seed) : random_(seed) {
    for (int i = 0; i < 6; ++i) {
      warm_[i] = (i < 3 ? 0.17 : 0.017) * normal_(random_);
      bias_[i] = (i < 3 ? 0.05 : 0.005) * normal_(random_);
    }
  }
  Vector6d read(const Vector6d& wrench, double dt = 1e-3) {
    time_ += dt;
    Vector6d reading;
    for (int i = 0; i < 6; ++i) {
      bias_[i] += (i < 3 ? 1e-3 : 5e-5) * std::sqrt(dt) * normal_(random_);
      const double value = wrench[i] + bias_[i] + warm_[i] * (1 - std::exp(-time_ / 600)) +
                           (i < 3 ? kForceNoise : kTorqueNoise) * normal_(random_);
      const double step = i < 3 ? kForceStep : kTorqueStep;
      reading[i] = step * std::round(value / step);
    }
    return reading;
  }

 private:
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
  Vector6d warm_, bias_;
  double time_ = 0;
};

struct Outcome {
  bool felt = false;  // the wrench has changed by more than five standard deviations of the noise
  bool found = false;
  bool contradicted = false;         // the wrench contradicts the model meanwhile
  bool observable = false;           // the contact point is identifiable from the wrench, to 25 mm
  bool reported_observable = false;  // as reported by the filter
  double after = 0;                  // s, from measurable to detected
  double location = 0, location_first = 0;  // m, error; half a second after detection, and at once
  double force = 0;                         // N, error
  double mean = 0, worst = 0;               // m, shape error half a second after detection
  double gone_after = -1;                   // s, from the end of the contact
};

/// One bar in a hand, moved somewhere and then at rest, and external contacts.
class Scene {
 public:
  explicit Scene(std::uint64_t seed, double mismatch)
      : random_(seed),
        sensor_(seed),
        nominal_(unknown_push_bar()),
        surface_(mesh::extract_surface(nominal_.mesh)),
        locator_(nominal_.mesh) {
    elasticity::Body truth = nominal_;
    truth.material.young_modulus *= std::exp(mismatch * normal());
    world_ = std::make_unique<CorotationalQuasistatic>(truth);
    model_ = std::make_unique<CorotationalQuasistatic>(nominal_);
    world_->prepare();
    model_->prepare();
    PoseWrenchFilter::Options options;
    options.contacts = true;
    filter_ = std::make_unique<PoseWrenchFilter>(nominal_, surface_, options);
    filter_->activate(*model_);
    inputs_.grasp_count = 1;
    hand_ = nominal_.grasps[0].X_OG_rest;
    for (int i = 0; i < 3; ++i) shift_.translation()[i] = 5e-4 * mismatch * normal();
    // In braces, which fix the order of evaluation.
    const Vector3d way = 0.02 * Vector3d{-std::abs(normal()), normal(), normal()};
    const Vector3d turn = 0.15 * Vector3d{normal(), normal(), normal()};
    for (int i = 0; i < 1000; ++i) {
      hand_.translation() += 1e-3 * way;
      hand_.linear() = math::exp_rotation(1e-3 * turn) * hand_.linear();
      tick();
    }
    for (int i = 0; i < 1300; ++i) tick();
  }

  Outcome poke() {
    for (int i = 0; i < 600; ++i) tick();
    Outcome outcome;
    if (estimate_.unknown_contact.found) ++imagined_;
    draw();
    const Vector6d before = lagged_;
    judge_observability(outcome);
    for (int i = 0; i < place_.count; ++i)
      world_->loads().col(place_.nodes[i]) += place_.weights[i] * force_;
    int felt_at = -1, found_at = -1;
    for (int i = 0; i < 1200 && (found_at < 0 || i <= found_at + 500); ++i) {
      tick();
      const Vector6d change = (lagged_ - before).cwiseAbs();
      const bool is_felt = change.head<3>().maxCoeff() > 5 * kForceNoise ||
                           change.tail<3>().maxCoeff() > 5 * kTorqueNoise;
      if (is_felt && felt_at < 0) felt_at = i;
      outcome.contradicted |= !status_.is_ok();
      if (!estimate_.unknown_contact.found) continue;
      if (found_at < 0) {
        found_at = i;
        outcome.location_first = distance();
      }
      outcome.location = distance();
    }
    outcome.reported_observable = estimate_.unknown_contact.location_deviation >= 0;
    outcome.felt = felt_at >= 0;
    outcome.found = found_at >= 0;
    outcome.after = 1e-3 * (found_at - felt_at);
    outcome.force = (estimate_.unknown_contact.force_O - force_).norm();
    const Eigen::VectorXd error = (model_->positions() - world_->positions()).colwise().norm();
    outcome.mean = error.mean();
    outcome.worst = error.maxCoeff();
    world_->loads().setZero();
    for (int i = 0; i < 1500; ++i) {
      tick();
      if (!estimate_.unknown_contact.found && outcome.gone_after < 0) outcome.gone_after = 1e-3 * i;
    }
    return outcome;
  }
  int imagined() const { return imagined_; }

  Vector3d rest_point_ = Vector3d::Zero(), force_ = Vector3d::Zero();

 private:
  double normal() { return normal_(random_); }

  void draw() {
    std::uniform_real_distribution<double> uniform;
    std::uniform_int_distribution<int> some(0, static_cast<int>(surface_.triangles.cols()) - 1);
    const auto is_bound = [&](double x) { return x < 0.03 || x > 0.47; };
    Eigen::Vector3i corners;
    do {
      const int t = some(random_);
      corners = surface_.triangles.col(t);
      const std::vector<int>& nodes = surface_.triangle_nodes[static_cast<std::size_t>(t)];
      const auto which =
          static_cast<std::size_t>(uniform(random_) * static_cast<double>(nodes.size()));
      rest_point_ = nominal_.mesh.nodes.col(nodes[std::min(which, nodes.size() - 1)]);
    } while (is_bound(rest_point_.x()));
    place_ = locator_.locate(rest_point_);
    const Eigen::Matrix3Xd& x = world_->positions();
    const Vector3d corner = x.col(corners[0]);
    along_ = (x.col(corners[1]) - corner).normalized();
    const Vector3d inward = -along_.cross(Vector3d(x.col(corners[2]) - corner)).normalized();
    across_ = inward.cross(along_);
    force_ = inward + 0.1 * normal() * along_;
    force_ += 0.1 * normal() * across_;
    force_ *= (0.2 + 0.8 * uniform(random_)) / force_.norm();
  }

  /// From the derivatives of the wrench by force and position with the noise of a tenth of a second
  /// and a twentieth of the change for the model error, and the force within its usual cone.
  void judge_observability(Outcome& outcome) const {
    const elasticity::Sensitivity& sensitivity = world_->sensitivity();
    Eigen::Matrix<double, 6, 5> J;
    const PatchMotion firm(0);
    J.leftCols<3>() = ContactSearch::response(place_, sensitivity, firm, 0);
    const Vector6d change = J.leftCols<3>() * force_;
    const Eigen::Matrix3Xd& rest = nominal_.mesh.nodes;
    constexpr double kStep = 4e-3;
    const Vector3d low = rest.rowwise().minCoeff(), high = rest.rowwise().maxCoeff();
    int column = 3;
    for (int axis = 0; axis < 3; ++axis) {  // the sides of the bar are those of the axes
      const bool is_normal = std::abs(rest_point_[axis] - low[axis]) < 1e-9 ||
                             std::abs(rest_point_[axis] - high[axis]) < 1e-9;
      if (is_normal || column == 5) continue;
      const Vector3d step = kStep * Vector3d::Unit(axis);
      const Vector6d there =
          ContactSearch::response(locator_.locate(rest_point_ + step), sensitivity, firm, 0) *
          force_;
      const Vector6d here =
          ContactSearch::response(locator_.locate(rest_point_ - step), sensitivity, firm, 0) *
          force_;
      J.col(column++) = (there - here) / (2 * kStep);
    }
    Vector6d weight;
    for (int i = 0; i < 6; ++i) {
      const double noise = i < 3 ? kForceNoise : kTorqueNoise;
      const double error = 0.05 * (i < 3 ? change.head<3>() : change.tail<3>()).norm();
      weight[i] = 1 / (noise * noise / 100 + error * error);
    }
    Eigen::Matrix<double, 5, 5> information = Eigen::Matrix<double, 5, 5>::Zero();
    information.topLeftCorner<5, 5>() = J.transpose() * weight.asDiagonal() * J;
    if (column < 5) information(4, 4) += 1e12;  // on an edge: only along it
    for (const Vector3d& tangent : {along_, across_})
      information.topLeftCorner<3, 3>() +=
          tangent * tangent.transpose() / std::pow(0.2 * force_.norm(), 2);
    const Eigen::Matrix<double, 5, 5> P = information.inverse();
    outcome.observable = P.bottomRightCorner<2, 2>().trace() < 0.025 * 0.025;
  }

  void tick() {
    world_->hold(0, hand_ * shift_);
    support::refactor(*world_);
    world_->step(1e-3);
    const Vector6d reaction = world_->reaction(0).vector();
    if (ticks_++ == 0) lagged_ = reaction;
    lagged_ += (1 - std::exp(-0.1)) * (reaction - lagged_);  // with the delay assumed by the filter
    GraspInput& grasp = inputs_.grasps[0];
    grasp.pose_freshness = Freshness::kNew;
    grasp.holding = grasp.wrench_valid = true;
    grasp.X_OG = hand_;
    grasp.F_G_O = math::Wrench::from(sensor_.read(lagged_));
    support::refactor(*model_);
    status_ = filter_->update(inputs_, *model_, estimate_);
  }

  double distance() const {
    return (estimate_.unknown_contact.location_O - place_.interpolate(world_->positions())).norm();
  }

  std::mt19937_64 random_;  // of motions and contacts, whatever the estimator makes of them
  Sensor sensor_;
  std::normal_distribution<double> normal_;
  elasticity::Body nominal_;
  mesh::Surface surface_;
  mesh::PointLocator locator_;
  std::unique_ptr<CorotationalQuasistatic> world_, model_;
  std::unique_ptr<PoseWrenchFilter> filter_;
  EstimationInputs inputs_;
  Estimate estimate_;
  UpdateResult status_;
  math::Pose hand_ = math::Pose::Identity(), shift_ = math::Pose::Identity();
  Vector6d lagged_ = Vector6d::Zero();
  mesh::PointWeights place_;
  Vector3d along_ = Vector3d::Zero(), across_ = Vector3d::Zero();
  int ticks_ = 0, imagined_ = 0;
};

class UnknownPush : public ::testing::TestWithParam<double> {};

TEST_P(UnknownPush, IsFoundInTimeAndWhereItIs) {
  const int pokes = static_cast<int>(setting("PALPATE_POKES", 40));
  const bool verbose = std::getenv("PALPATE_VERBOSE") != nullptr;
  constexpr int kPerScene = 4;
  std::vector<double> after, near, first, far, reported, force, mean, worst, gone;
  int felt = 0, felt_and_found = 0, contradicted = 0, found = 0, imagined = 0;
  for (int seed = 0; seed * kPerScene < pokes; ++seed) {
    Scene scene(static_cast<std::uint64_t>(seed + 1), GetParam());
    for (int i = 0; i < kPerScene && seed * kPerScene + i < pokes; ++i) {
      const Outcome outcome = scene.poke();
      felt += outcome.felt;
      found += outcome.found;
      felt_and_found += outcome.felt && outcome.found;
      contradicted += outcome.felt && !outcome.found && outcome.contradicted;
      if (verbose)
        std::printf(
            "%d %d%d%d  %.2f %.2f %.2f  f %.2f %.2f %.2f  %4.0f ms  %4.0f %4.0f mm  %.3f N "
            " shape %.1f %.1f mm  gone %.2f s\n",
            seed, outcome.felt, outcome.found, outcome.observable, scene.rest_point_.x(),
            scene.rest_point_.y(), scene.rest_point_.z(), scene.force_.x(), scene.force_.y(),
            scene.force_.z(), 1e3 * outcome.after, 1e3 * outcome.location_first,
            1e3 * outcome.location, outcome.force, 1e3 * outcome.mean, 1e3 * outcome.worst,
            outcome.gone_after);
      if (!outcome.found) continue;
      if (outcome.felt) after.push_back(outcome.after);
      (outcome.observable ? near : far).push_back(outcome.location);
      if (outcome.observable) first.push_back(outcome.location_first);
      if (outcome.reported_observable) reported.push_back(outcome.location);
      force.push_back(outcome.force);
      mean.push_back(outcome.mean);
      worst.push_back(outcome.worst);
      gone.push_back(outcome.gone_after < 0 ? 9 : outcome.gone_after);
    }
    imagined += scene.imagined();
  }
  std::printf(
      "%d pokes, %d felt, %d found, %d of those felt (%d of the others contradict the model), %d "
      "imagined\n"
      "  after            median %.0f ms, 95 %% %.0f ms\n"
      "  place observable median %.1f mm, 95 %% %.1f mm (%d); at once %.1f mm\n"
      "  place not        median %.1f mm (%d); where reported observable %.1f mm (%d)\n"
      "  force            median %.3f N, 95 %% %.3f N\n"
      "  shape            mean %.2f mm, worst node median %.2f mm, 95 %% %.2f mm\n"
      "  gone after       median %.2f s, 95 %% %.2f s\n",
      pokes, felt, found, felt_and_found, contradicted, imagined, 1e3 * median(after),
      1e3 * median(after, 0.95), 1e3 * median(near), 1e3 * median(near, 0.95),
      static_cast<int>(near.size()), 1e3 * median(first), 1e3 * median(far),
      static_cast<int>(far.size()), 1e3 * median(reported), static_cast<int>(reported.size()),
      median(force), median(force, 0.95), 1e3 * median(mean), 1e3 * median(worst),
      1e3 * median(worst, 0.95), median(gone), median(gone, 0.95));
  EXPECT_EQ(felt_and_found, felt);
  EXPECT_LE(median(after, 0.95), 0.05);
  EXPECT_LE(median(near), 0.025);
  EXPECT_LE(median(reported), 0.025);
  EXPECT_GT(reported.size(), 0u);
  EXPECT_LE(median(mean), 0.005) << "a hundredth of the bar's length";
  EXPECT_LE(median(worst), 0.005);
  EXPECT_EQ(imagined, 0);
}

INSTANTIATE_TEST_SUITE_P(Mismatch, UnknownPush, ::testing::Values(0.0, 0.2),
                         [](const auto& of) { return of.param == 0 ? "none" : "some"; });

/// Stands still under any input, at negligible cost: hours of rest in seconds.
class StillModel : public support::RigidModel {
 public:
  explicit StillModel(const CorotationalQuasistatic& of) : RigidModel(of.body()) {
    mutable_sensitivity() = of.sensitivity();
    reaction_ = of.reaction(0);
  }
  elasticity::StepReport step(double) noexcept override { return report; }
  math::Wrench reaction(int) const noexcept override { return reaction_; }

 private:
  math::Wrench reaction_;
};

TEST(UnknownPushAtRest, IsImaginedLessThanOnceAnHour) {
  const double hours = setting("PALPATE_REST_HOURS", 0.05);
  const elasticity::Body body = unknown_push_bar();
  CorotationalQuasistatic model(body);
  model.prepare();
  math::Pose X_OG = body.grasps[0].X_OG_rest;
  for (int i = 0; i < 400; ++i) {
    X_OG.translation().z() += 1e-4;
    model.hold(0, X_OG);
    support::refactor(model);
    model.step(1e-3);
  }
  StillModel still(model);
  PoseWrenchFilter::Options options;
  options.contacts = true;
  PoseWrenchFilter filter(body, mesh::extract_surface(body.mesh), options);
  filter.activate(still);
  EstimationInputs inputs;
  inputs.grasp_count = 1;
  GraspInput& grasp = inputs.grasps[0];
  grasp.pose_freshness = Freshness::kNew;
  grasp.holding = grasp.wrench_valid = true;
  grasp.X_OG = X_OG;
  const Vector6d wrench = still.reaction(0).vector();
  Estimate estimate;
  int alarms = 0;
  std::int64_t left = std::llround(hours * 3.6e6);
  for (std::uint64_t seed = 1; left > 0; ++seed) {
    Sensor sensor(seed);
    for (std::int64_t i = 0; i < 3'600'000 && left > 0; ++i, --left) {
      grasp.F_G_O = math::Wrench::from(sensor.read(wrench));
      static_cast<void>(filter.update(inputs, still, estimate));
      if (!estimate.unknown_contact.found) continue;
      ++alarms;
      filter.activate(still);
    }
  }
  std::printf("%.2f hours of rest: %d false alarms\n", hours, alarms);
  EXPECT_LE(alarms, hours);
}

}  // namespace
}  // namespace palpate::estimation
