#pragma once

#include <array>

namespace palpate::contact {

/// Force against the travel of a tip that approaches a surface, averaged over steps of equal
/// travel, so that its size does not depend on the speed. Keeps the latest steps. Nothing
/// allocates.
class ApproachRecord {
 public:
  static constexpr int kMostSteps = 512;

  struct Step {
    double travel = 0;  // m, mean of the samples
    double force = 0;   // N, mean of the samples
    int samples = 0;
  };

  /// `resolution`: m, length of a step. Throws std::invalid_argument unless positive and finite.
  explicit ApproachRecord(double resolution);

  void clear() noexcept;
  /// A sample whose travel (m) lies behind the present step, because of noise or because the tip
  /// rests, belongs to that step. Samples that are not finite are left out.
  void add(double travel, double force) noexcept;

  int count() const noexcept { return count_; }
  /// 0: the oldest step.
  const Step& operator[](int i) const noexcept {
    return steps_[static_cast<std::size_t>((first_ + i) % kMostSteps)];
  }
  double resolution() const noexcept { return resolution_; }

 private:
  double resolution_;
  std::array<Step, kMostSteps> steps_{};
  int first_ = 0, count_ = 0;
  double end_ = 0;  // m, travel at which the present step ends
};

}  // namespace palpate::contact
