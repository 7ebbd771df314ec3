#pragma once

#include "core/sensing/sensor_model.hpp"

namespace palpate::sensing {

/// Forces that a person or a program applies to the object (thesis, Fig. 4.4). A force ends by
/// itself unless it is renewed, so that a lost "release" does not push for ever.
class Manual : public SensorModel {
 public:
  struct Options {
    double expires_after = 0.1;  // s since the last message
    double max_force = 100;      // N, of the norm; longer forces are shortened
  };

  /// Throws std::invalid_argument naming the option that is wrong.
  explicit Manual(const Options& options);
  Manual() : Manual(Options{}) {}

  UpdateResult update(const Signals& signals, ContactSet& contacts) noexcept override;

 private:
  Options options_;
};

}  // namespace palpate::sensing
