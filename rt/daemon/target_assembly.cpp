#include "rt/daemon/target_assembly.hpp"

#include <algorithm>
#include <cstring>

#include "rt/bus/text.hpp"

namespace palpate::daemon {

static_assert(TargetAssembly::kMostChunks <= 32, "a bit each");

TargetAssembly::TargetAssembly()
    : rest_points_(3 * kPointsPerChunk * kMostChunks), values_(kValuesPerChunk * kMostChunks) {}

const char* TargetAssembly::kind() const noexcept { return bus::get_text(begun_.kind); }

/// Reason why a chunk does not belong to the present target; "" if it does.
const char* TargetAssembly::wrong(const shape_target_t& chunk) const noexcept {
  if (chunk.point_count < 0 || chunk.point_count > kPointsPerChunk || chunk.value_count < 0 ||
      chunk.value_count > kValuesPerChunk || chunk.revision < 0)
    return "target with counts out of range";
  if (chunk.chunks < 1 || chunk.chunks > kMostChunks || chunk.chunk < 0 ||
      chunk.chunk >= chunk.chunks)
    return "target of too many chunks, or a chunk that is none of them";
  if (chunk.chunks != begun_.chunks ||
      std::memcmp(chunk.kind, begun_.kind, sizeof chunk.kind) != 0 ||
      (chunk.point_count == 0) != (begun_.point_count == 0))
    return "chunks of one target that do not belong together";
  const bool last = chunk.chunk == chunk.chunks - 1;
  const bool full = chunk.value_count == kValuesPerChunk &&
                    (chunk.point_count == kPointsPerChunk || chunk.point_count == 0);
  if (!last && !full) return "a chunk before the last that is not full";
  return "";
}

TargetAssembly::Taken TargetAssembly::take(const shape_target_t& chunk,
                                           const char*& reason) noexcept {
  const bool same_sender = any_ && chunk.session == begun_.session;
  if (same_sender && chunk.revision < begun_.revision) return Taken::kKnown;
  if (!same_sender || chunk.revision != begun_.revision) {
    begun_ = chunk;
    any_ = true;
    known_ = false;
    here_ = 0;
    point_count_ = value_count_ = 0;
  }
  if (known_) return Taken::kKnown;
  reason = wrong(chunk);
  if (*reason != '\0') {
    known_ = true;
    return Taken::kRejected;
  }
  const std::uint32_t bit = 1U << static_cast<unsigned>(chunk.chunk);
  if ((here_ & bit) != 0) return Taken::kWaits;
  here_ |= bit;
  std::copy_n(&chunk.rest_points[0][0], 3 * chunk.point_count,
              rest_points_.data() + 3 * kPointsPerChunk * chunk.chunk);
  std::copy_n(chunk.values, chunk.value_count, values_.data() + kValuesPerChunk * chunk.chunk);
  point_count_ += chunk.point_count;
  value_count_ += chunk.value_count;
  const std::uint32_t all = 0xFFFFFFFFU >> static_cast<unsigned>(32 - chunk.chunks);
  if (here_ != all) return Taken::kWaits;
  known_ = true;
  return Taken::kWhole;
}

}  // namespace palpate::daemon
