#pragma once

#include <cstdint>
#include <palpate/shape_target_t.hpp>
#include <vector>

#include "core/shape/point_features.hpp"

namespace palpate::daemon {

/// Assembles a target from its chunks, in any order and with repetitions: a lost chunk comes with
/// the next repetition of the target. Every chunk but the last is full; a target without points has
/// none in any chunk. Nothing allocates after construction.
class TargetAssembly {
 public:
  static constexpr int kPointsPerChunk = 64, kValuesPerChunk = 192;
  static constexpr int kMostChunks = shape::PointsFeature::kMostPoints / kPointsPerChunk;

  TargetAssembly();

  enum class Taken {
    kWaits,    // further chunks are missing
    kKnown,    // older than, or part of, a target that is complete or rejected
    kWhole,    // complete
    kRejected  // the complete target is rejected, see `reason`
  };
  Taken take(const shape_target_t& chunk, const char*& reason) noexcept;

  // Revision of the target that take() reported as complete.
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

  shape_target_t begun_{};  // first received chunk of the present target
  bool any_ = false;
  bool known_ = false;  // the present target is complete or rejected
  std::uint32_t here_ = 0;
  std::vector<double> rest_points_, values_;
  int point_count_ = 0, value_count_ = 0;
};

}  // namespace palpate::daemon
