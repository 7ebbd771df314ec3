#pragma once

#include "core/math/update_result.hpp"
#include "core/sensing/sensor_model.hpp"

namespace palpate::sensing {

/// External forces applied to the object by a person or a program (Sanchez 2019, Fig. 4.4). A force
/// expires unless it is repeated, so that a lost release message does not leave it active.
class Manual : public SensorModel {
 public:
  struct Options {
    double expires_after = 0.1;  // s since the last message
    double max_force = 100;      // N, limit of the norm; larger forces are scaled down
  };

  /// Throws std::invalid_argument naming the invalid option.
  explicit Manual(const Options& options);
  Manual() : Manual(Options{}) {}

  UpdateResult update(const Signals& signals, ContactSet& contacts) noexcept override;

 private:
  Options options_;
};

}  // namespace palpate::sensing
