#pragma once

#include <vector>

#include "core/estimation/estimator.hpp"
#include "core/estimation/step_watch.hpp"
#include "core/math/filter.hpp"
#include "core/math/update_result.hpp"

namespace palpate::estimation {

/// Estimator driven by measured forces; no grasp is held (Sanchez 2019).
///
/// Repaired variant: the nodal loads of every accepted contact act on the mesh, force and torque,
/// together with gravity; the loads of a contact that is no longer reported fade to zero. Variant
/// as released by the author: the force of each source is averaged and delayed, distributed over
/// the nodes of its last contact and held indefinitely; torque and gravity are omitted.
class ForceDriven : public Estimator {
 public:
  enum class Variant { kAsReleased, kRepaired };

  struct Options {
    Variant variant = Variant::kRepaired;
    double fade = 0.1;     // s, repaired variant: fade time from the last load of a contact to zero
    double period = 1e-3;  // s, update period; sizes the filter of the released variant
    double average = 0.1;  // s, released variant: 50 samples at 500 Hz, launch file for control
    double delay = 0.012;  // s, released variant: 6 samples at 500 Hz
    StepWatch::Options step;

    /// Released variant with the filters of the launch file for sensing: 300 and 80 samples at 500
    /// Hz.
    static Options sensing_launch() noexcept;
  };

  /// Throws std::invalid_argument if an option is out of range. Allocates for `body`.
  ForceDriven(const elasticity::Body& body, const Options& options);

  /// Releases every grasp and sets gravity.
  void activate(elasticity::DeformationModel& model) noexcept override;

  /// Repaired variant: degraded if the wrench at the wrist was received earlier and is now missing.
  /// estimate.X_OG is fitted to the mesh; estimate.reaction is the load applied for the wrist.
  UpdateResult update(const EstimationInputs& inputs, elasticity::DeformationModel& model,
                      Estimate& estimate) noexcept override;
  void reset() noexcept override;

 private:
  static constexpr int kSources = 8;

  struct SourceLoads {
    std::vector<contact::NodalLoad> loads;  // applied loads, before multiplication by `factor`
    double factor = 0;                      // 1 while fresh, 0 once faded
    bool seen = false;
    bool present = false;  // received in this tick
    math::DelayLine<3> delay;
    math::MovingAverage<3> average;
  };

  UpdateResult gather(const EstimationInputs& inputs, int node_count) noexcept;
  void fade(SourceLoads& source, double dt) const noexcept;
  void refilter(SourceLoads& source) noexcept;
  math::Wrench wrist_wrench(int grasp, const Eigen::Matrix3Xd& positions,
                            const Eigen::Vector3d& p_OG) const noexcept;

  Options options_;
  std::vector<SourceLoads> sources_;  // indexed by sensing::Source
  StepGuard step_guard_;
  StepWatch step_watch_;
};

}  // namespace palpate::estimation
