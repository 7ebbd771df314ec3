// Tactile shape sensing on a real recording, played in real time.

#include "tools/evaluate/demo.hpp"

namespace palpate::evaluate {

int count_recording(const Demo&) { return 1; }

void run_recording(Demo&) {}

}  // namespace palpate::evaluate
