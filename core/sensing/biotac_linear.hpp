#pragma once

#include "core/math/update_result.hpp"
#include "core/sensing/fingertip_model.hpp"

namespace palpate::sensing {

/// Contact of one fingertip: force by a linear map of its counts; location from its electrodes, or
/// by the map if it includes one. A contact is reported while the force exceeds a threshold with
/// hysteresis; it has no torque about its location.
class BiotacLinear : public FingertipModel {
 public:
  struct Options : FingertipOptions {
    LinearTactileModel model;  // predicts the force on the object, in T
  };

  /// Throws std::invalid_argument naming the invalid option.
  explicit BiotacLinear(const Options& options);

  UpdateResult update(const Signals& signals, ContactSet& contacts) noexcept override;
  void reset() noexcept override;

 private:
  Options options_;
  bool has_inputs_ = false;
};

}  // namespace palpate::sensing
