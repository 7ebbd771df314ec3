#pragma once

#include <vector>

#include "core/estimation/estimator.hpp"
#include "core/estimation/step_watch.hpp"
#include "core/math/filter.hpp"

namespace palpate::estimation {

/// The measured forces drive the mesh, which no hand holds (Sanchez 2019).
///
/// Repaired: every accepted contact's nodal loads act, force and torque, with gravity, while they
/// come; the loads of one that no longer comes fade to zero.
/// As released: the force of each source is averaged and delayed, spread over the nodes of its last
/// contact and held for ever; torque is dropped and there is no gravity.
class ForceDriven : public Estimator {
 public:
  enum class Variant { kAsReleased, kRepaired };

  struct Options {
    Variant variant = Variant::kRepaired;
    double fade = 0.1;     // s, repaired: from a contact's last load to none
    double period = 1e-3;  // s, of the updates; as released: sizes the filter
    double average = 0.1;  // s, as released: 50 samples at 500 Hz, launch file for control
    double delay = 0.012;  // s, as released: 6 samples at 500 Hz
    StepWatch::Options step;

    /// As released with the filters of the launch file for sensing: 300 and 80 samples at 500 Hz.
    static Options sensing_launch() noexcept;
  };

  /// Throws std::invalid_argument where an option is out of range. Allocates for `body`.
  ForceDriven(const elasticity::Body& body, const Options& options);

  /// Releases every grasp and sets gravity.
  void activate(elasticity::DeformationModel& model) noexcept override;

  /// Repaired: degraded where a wrench at the wrist came and does so no longer. estimate.X_OG fits
  /// the mesh; estimate.reaction is what has been applied for the wrist.
  sensing::UpdateResult update(const EstimationInputs& inputs, elasticity::DeformationModel& model,
                               Estimate& estimate) noexcept override;
  void reset() noexcept override;

 private:
  static constexpr int kSources = 8;

  struct SourceLoads {
    std::vector<contact::NodalLoad> loads;  // what acts, before `factor`
    double factor = 0;                      // 1 while fresh, 0 once faded
    bool seen = false;
    bool present = false;  // in this tick
    math::DelayLine<3> delay;
    math::MovingAverage<3> average;
  };

  const char* gather(const EstimationInputs& inputs, int node_count) noexcept;
  void fade(SourceLoads& source, double dt) const noexcept;
  void refilter(SourceLoads& source) noexcept;
  math::Wrench wrist_wrench(int grasp, const Eigen::Matrix3Xd& positions,
                            const Eigen::Vector3d& p_OG) const noexcept;

  Options options_;
  std::vector<SourceLoads> sources_;  // by sensing::Source
  StepGuard step_guard_;
  StepWatch step_watch_;
};

}  // namespace palpate::estimation
