#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <vector>

namespace palpate::plugin {

/// Guard words before and after an output, whose change reveals a write out of bounds.
inline constexpr std::size_t kGuardWords = 8;
inline constexpr std::uint64_t kGuardWord = 0x7ff4c0dea11f5a5aULL;  // as a double not a number

inline bool is_intact(const void* words) noexcept {
  for (std::size_t i = 0; i < kGuardWords; ++i)
    if (std::memcmp(static_cast<const char*>(words) + 8 * i, &kGuardWord, 8) != 0) return false;
  return true;
}

inline void put_guard_words(void* words) noexcept {
  for (std::size_t i = 0; i < kGuardWords; ++i)
    std::memcpy(static_cast<char*>(words) + 8 * i, &kGuardWord, 8);
}

/// A structure between guard words.
template <class T>
struct Fenced {
  Fenced() { repair(); }
  bool is_intact() const noexcept {
    return plugin::is_intact(before.data()) && plugin::is_intact(after.data());
  }
  void repair() noexcept {
    put_guard_words(before.data());
    put_guard_words(after.data());
  }

  std::array<std::uint64_t, kGuardWords> before;
  T value{};
  std::array<std::uint64_t, kGuardWords> after;
};

/// Numbers between guard words; zero at first.
class FencedNumbers {
 public:
  explicit FencedNumbers(Eigen::Index count = 0)
      : count_(count), memory_(static_cast<std::size_t>(count) + 2 * kGuardWords) {
    repair();
  }
  double* data() noexcept { return memory_.data() + kGuardWords; }
  Eigen::Map<Eigen::VectorXd> vector() noexcept { return {data(), count_}; }
  Eigen::Map<Eigen::MatrixXd> matrix(Eigen::Index rows) noexcept {
    return {data(), rows, rows == 0 ? 0 : count_ / rows};
  }
  Eigen::Map<Eigen::Matrix3Xd> nodes() noexcept { return {data(), 3, count_ / 3}; }
  Eigen::Index size() const noexcept { return count_; }
  bool is_intact() const noexcept {
    return plugin::is_intact(memory_.data()) &&
           plugin::is_intact(memory_.data() + memory_.size() - kGuardWords);
  }
  void repair() noexcept {
    put_guard_words(memory_.data());
    put_guard_words(memory_.data() + memory_.size() - kGuardWords);
  }

 private:
  Eigen::Index count_;
  std::vector<double> memory_;
};

}  // namespace palpate::plugin
