#pragma once

#include "core/sensing/signals.hpp"

namespace palpate::sensing {

/// Makes `sample` the only message of a stream in this tick.
template <class T, int kCapacity>
void feed(Stream<T, kCapacity>& stream, const T& sample) {
  stream.freshness = Freshness::kNew;
  stream.age = 0;
  stream.latest = sample;
  stream.fresh_count = 1;
  stream.fresh[0] = sample;
}

inline void feed_wrench(Signals& signals, const math::Wrench& wrench) {
  ForceTorque sample;
  sample.F_S = wrench;
  feed(signals.force_torque, sample);
}

}  // namespace palpate::sensing
