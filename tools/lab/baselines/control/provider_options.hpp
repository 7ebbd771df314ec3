#pragma once

#include "core/math/constants.hpp"
#include "rt/config/option.hpp"
#include "tools/lab/baselines/control/diminishing_rigidity.hpp"
#include "tools/lab/baselines/control/gaussian_process.hpp"
#include "tools/lab/baselines/control/gradient_update.hpp"
#include "tools/lab/baselines/control/learning_jacobian.hpp"
#include "tools/lab/baselines/control/open_loop.hpp"
#include "tools/lab/baselines/control/weighted_least_squares_update.hpp"

namespace palpate::baselines {

// Keys that several providers share.

/// Any options with members probes, period, least_motion and length.
template <class Options>
config::OptionTable<Options> learning_table() {
  return config::OptionTable<Options>()
      .number(
          "probes.distance_mm", "mm", "of a probe", {0.1, 100},
          [](auto& o) -> auto& { return o.probes.distance; }, 1e-3)
      .number(
          "probes.angle_deg", "degrees", "of a probe", {0.1, 45},
          [](auto& o) -> auto& { return o.probes.angle; }, math::kDegree)
      .number(
          "probes.move", "s", "of a probe, each way", {0.05, 10},
          [](auto& o) -> auto& { return o.probes.move; })
      .number(
          "probes.settle", "s", "of rest after a probe", {0, 10},
          [](auto& o) -> auto& { return o.probes.settle; })
      .number("period_ms", "ms", "between two updates", {0, 1e4}, &Options::period, 1e-3)
      .number("least_motion_mm", "mm", "of the hand, that an update takes", {1e-3, 100},
              &Options::least_motion, 1e-3)
      .number("rotation_length", "m", "a rotation by 1 rad weighs as much as this displacement",
              {1e-3, 10}, &Options::length);
}

inline config::OptionTable<GradientUpdate::Options> gradient_table() {
  using Options = GradientUpdate::Options;
  return config::OptionTable<Options>()
      .number("update_gain", "", "of the adaptation", {1e-4, 1.999}, &Options::gain)
      .number("softness_mm", "mm", "motion that counts as half a motion", {0, 100},
              &Options::softness, 1e-3);
}

struct UpdateGain {
  double value = 0.5;
};
inline config::OptionTable<UpdateGain> update_gain_table() {
  return config::OptionTable<UpdateGain>().number("update_gain", "", "of the adaptation", {1e-4, 1},
                                                  &UpdateGain::value);
}

inline config::OptionTable<WeightedLeastSquaresUpdate::Options> window_table() {
  using Options = WeightedLeastSquaresUpdate::Options;
  return config::OptionTable<Options>()
      .integer("window", "samples that the Jacobian is fitted to", {6, 500}, &Options::window)
      .number("forgetting", "", "weight of a sample against the next", {0.1, 1},
              &Options::forgetting)
      .number("confidence", "", "least eigenvalue of the samples, relative", {1e-6, 0.999},
              &Options::confidence);
}

inline config::OptionTable<DiminishingRigidityOptions> rigidity_table(bool directional) {
  using Options = DiminishingRigidityOptions;
  Options defaults;
  if (directional) defaults.push = 8;
  config::OptionTable<Options> table(defaults);
  table
      .number("rigidity", "", "how soon influence fades with distance, or how stiff a match is",
              {0, 1e3}, &Options::translation)
      .number("rotation_rigidity", "1/m",
              "how soon the influence of a rotation fades with distance", {0, 1e3},
              &Options::rotation);
  if (directional)
    table.number("push_rigidity", "1/m", "how soon the influence of a push fades with distance",
                 {1e-3, 1e3}, &Options::push);
  return table;
}

inline config::OptionTable<GaussianProcess::Options> gaussian_process_table() {
  using Options = GaussianProcess::Options;
  return learning_table<Options>()
      .number("reach", "m", "over which motions are alike", {1e-2, 100}, &Options::reach)
      .number("process_noise", "", "of the regression", {1e-4, 10}, &Options::noise)
      .integer("samples", "that are kept", {6, 80}, &Options::samples)
      .number("gain", "1/s", "share of the error that is made up for in a second", {1e-3, 50},
              &Options::gain)
      .number("linear_speed", "m/s", "largest of the origin of G", {1e-4, 10},
              &Options::linear_speed)
      .number("angular_speed", "rad/s", "largest of G", {1e-4, 10}, &Options::angular_speed)
      .number("dead_band_mm", "mm", "error of positions within which the hand rests", {0, 1000},
              &Options::dead_band, 1e-3);
}

/// Where the feature is moved to by a plan that is made at the start.
struct Goal {
  std::vector<double> displacement, values;  // m; of the feature itself
};
inline config::OptionTable<Goal> goal_table() {
  return config::OptionTable<Goal>()
      .numbers("goal.displacement", "m",
               "of every point of the feature from rest, in O: three; or its values", {-1, 1}, -1,
               &Goal::displacement)
      .numbers("goal.values", "", "of the feature itself, where it is to be", {-100, 100}, -1,
               &Goal::values);
}

inline config::OptionTable<OpenLoop::Options> open_loop_table() {
  using Options = OpenLoop::Options;
  return config::OptionTable<Options>()
      .number("gain", "1/s", "share of the error that is made up for in a second", {1e-3, 50},
              &Options::gain)
      .number("linear_speed", "m/s", "largest of the origin of G", {1e-4, 10},
              &Options::linear_speed)
      .number("angular_speed", "rad/s", "largest of G", {1e-4, 10}, &Options::angular_speed)
      .number("filter", "s", "time constant of the plan", {1e-3, 100}, &Options::filter);
}

}  // namespace palpate::baselines
