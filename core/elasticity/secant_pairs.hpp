#pragma once

#include <Eigen/Core>
#include <array>

namespace palpate::elasticity {

/// Limited-memory quasi-Newton update: pairs of a correction and the resulting change of force
/// improve a slightly outdated factor (L-BFGS, Nocedal 1980, with that factor as initial matrix).
/// The length of the vectors is the number of unknown coordinates.
class SecantPairs {
 public:
  explicit SecantPairs(int size);

  void clear() noexcept { count_ = 0; }

  /// Stores the pair in place of the oldest; rejects one without positive curvature.
  void add(const Eigen::VectorXf& step, const Eigen::VectorXf& change) noexcept;

  /// Overwrites b with an improved solution of A x = b; `solve(b)` applies the factor.
  template <class Solve>
  void apply(Eigen::VectorXf& b, const Solve& solve) noexcept {
    std::array<float, kPairs> a;
    for (int k = 0; k < count_; ++k) {
      const Pair& pair = newest(k);
      a[k] = pair.scale * dot(pair.step, b);
      b -= a[k] * pair.change;
    }
    solve(b);
    for (int k = count_ - 1; k >= 0; --k) {
      const Pair& pair = newest(k);
      b += (a[k] - pair.scale * dot(pair.change, b)) * pair.step;
    }
  }

 private:
  static constexpr int kPairs = 6;
  struct Pair {
    Eigen::VectorXf step, change;
    float scale = 0;  // 1 / step . change
  };
  static float dot(const Eigen::VectorXf& a, const Eigen::VectorXf& b) noexcept { return a.dot(b); }
  const Pair& newest(int k) const noexcept { return pairs_[(next_ + kPairs - 1 - k) % kPairs]; }

  std::array<Pair, kPairs> pairs_;
  int next_ = 0;
  int count_ = 0;
};

}  // namespace palpate::elasticity
