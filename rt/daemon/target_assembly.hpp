#pragma once

#include <cstdint>
#include <palpate/shape_target_t.hpp>
#include <vector>

#include "core/shape/points_feature.hpp"

namespace palpate::daemon {

/// Puts a target together from its chunks, in whatever order they come, however often each does:
/// one that is lost comes with the target's next repetition. Every chunk but the last is full; a
/// target without points has none in any. Nothing allocates after construction.
class TargetAssembly {
 public:
  static constexpr int kPointsPerChunk = 64, kValuesPerChunk = 192;
  static constexpr int kMostChunks = shape::PointsFeature::kMostPoints / kPointsPerChunk;

  TargetAssembly();

  enum class Taken {
    kWaits,   // for chunks that have not come yet
    kKnown,   // older than, or of, a target that is whole or refused
    kWhole,   // and now known
    kRefused  // the whole target, for `reason`; now known
  };
  Taken take(const shape_target_t& chunk, const char*& reason) noexcept;

  // Of the target that take() said is whole.
  std::int32_t revision() const noexcept { return begun_.revision; }
  const char* kind() const noexcept;
  const double (*rest_points() const noexcept)[3] {
    return reinterpret_cast<const double(*)[3]>(rest_points_.data());
  }
  int point_count() const noexcept { return point_count_; }
  const double* values() const noexcept { return values_.data(); }
  int value_count() const noexcept { return value_count_; }

 private:
  const char* wrong(const shape_target_t& chunk) const noexcept;

  shape_target_t begun_{};  // the first chunk that came of the present target
  bool any_ = false;
  bool known_ = false;  // the present target is whole or refused
  std::uint32_t here_ = 0;
  std::vector<double> rest_points_, values_;
  int point_count_ = 0, value_count_ = 0;
};

}  // namespace palpate::daemon
