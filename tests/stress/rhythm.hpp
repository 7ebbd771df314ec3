#pragma once

#include <random>
#include <thread>

namespace palpate::stress {

/// Alternates runs and pauses at random, so that each of two threads has to wait for the other;
/// determined by the seed, as far as scheduling allows.
class Rhythm {
 public:
  explicit Rhythm(unsigned seed) : random_(seed) {}

  void beat() {
    if (left_-- > 0) return;
    left_ = static_cast<int>(random_() % 200);
    switch (random_() % 4) {
      case 0:
        std::this_thread::yield();
        break;
      case 1:
        std::this_thread::sleep_for(std::chrono::microseconds(random_() % 100));
        break;
      default:
        for (volatile unsigned spin = random_() % 2000; spin > 0; spin = spin - 1) {
        }
    }
  }

 private:
  std::minstd_rand random_;
  int left_ = 0;
};

}  // namespace palpate::stress
