#pragma once

#include <random>
#include <thread>

namespace palpate::stress {

/// Now runs, now pauses, at random, so that of two threads each comes to wait for the other; by
/// seed, as far as scheduling allows.
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
