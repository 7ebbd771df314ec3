#pragma once

#include "rt/pipeline/pipeline.hpp"

namespace palpate::support {

/// Signals of an arm whose hand holds the object at its rest pose, with no force at the wrist.
inline sensing::Signals at_rest(const pipeline::Pipeline& pipeline, int arm = 0) {
  const registry::Frames& frames = pipeline.frames(arm);
  sensing::Signals signals;
  signals.robot.freshness = Freshness::kNew;
  signals.robot.age = 0;
  signals.robot.latest.X_WE =
      frames.X_WO * pipeline.object().body.grasps[arm].X_OG_rest * frames.X_EG.inverse();
  signals.hand.freshness = Freshness::kNew;
  signals.hand.age = 0;
  signals.hand.latest.grasp = sensing::Grasp::kHolding;
  signals.force_torque.freshness = Freshness::kNew;
  signals.force_torque.age = 0;
  signals.force_torque.fresh_count = 1;
  return signals;
}

/// Cycles of 1 ms as run by the daemon, with each new factorisation available immediately.
/// `second`: signals of the second arm.
inline void run(pipeline::Pipeline& pipeline, const sensing::Signals& signals,
                const sensing::Signals& second, int cycles) {
  constexpr double kPeriod = 1e-3;  // s
  for (int i = 0; i < cycles; ++i) {
    pipeline.sense(signals, second);
    pipeline.distribute();
    while (elasticity::Refactorisation* job = pipeline.model().wanted_refactorisation()) {
      job->run();
      pipeline.model().install(*job);
    }
    pipeline.estimate(kPeriod);
    pipeline.evaluate_feature();
    pipeline.control(kPeriod);
    pipeline.gate(kPeriod);
  }
}

inline void run(pipeline::Pipeline& pipeline, const sensing::Signals& signals, int cycles) {
  run(pipeline, signals, signals, cycles);
}

}  // namespace palpate::support
