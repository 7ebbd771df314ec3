#pragma once

#include "core/sensing/sensor_model.hpp"

namespace palpate::sensing {

/// Whether a fingertip that feels a force, and has no active electrode to place it, has lost
/// something: what one reading's noise does is no contact, a force that lasts must be somewhere.
class PlacelessForce {
 public:
  static constexpr int kMost = 10;  // readings in a row, 0.1 s of a BioTac's 100 Hz

  void reset() noexcept { readings_ = 0; }
  /// Of `readings` more.
  UpdateResult judge(int readings) noexcept {
    readings_ = readings_ > kMost ? readings_ : readings_ + readings;
    if (readings_ <= kMost) return {};
    return {Status::kDegraded, "a force, but no active electrode to place it"};
  }

 private:
  int readings_ = 0;
};

}  // namespace palpate::sensing
