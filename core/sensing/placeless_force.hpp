#pragma once

#include "core/sensing/sensor_model.hpp"

namespace palpate::sensing {

/// Judges a fingertip force without an active electrode to locate it: for a single reading it is
/// noise, not a contact; a lasting one indicates a lost location.
class PlacelessForce {
 public:
  static constexpr int kMost = 10;  // consecutive readings, 0.1 s at the BioTac's 100 Hz

  void reset() noexcept { readings_ = 0; }
  /// Adds `readings` more.
  UpdateResult judge(int readings) noexcept {
    readings_ = readings_ > kMost ? readings_ : readings_ + readings;
    if (readings_ <= kMost) return {};
    return {Status::kDegraded, "a force, but no active electrode to place it"};
  }

 private:
  int readings_ = 0;
};

}  // namespace palpate::sensing
