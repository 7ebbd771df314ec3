#include "tools/common/progress.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdio>

#include "tools/common/interruption.hpp"
#include "tools/common/table.hpp"

namespace palpate::common {
namespace {

constexpr int kBar = 24;
constexpr int kTitle = 44;

}  // namespace

Progress::Progress(int position, int count, std::string title)
    : terminal_(isatty(STDERR_FILENO) == 1), start_(std::chrono::steady_clock::now()) {
  title.resize(std::max<std::size_t>(title.size(), kTitle), ' ');
  prefix_ = formatted("[%2d/%d] ", position, count) + title;
}

Progress::~Progress() {
  if (!finished_) finish(false, "");
}

double Progress::elapsed() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
}

void Progress::show(double fraction, const std::string& note) {
  if (!terminal_) return;
  const double part = std::clamp(fraction, 0.0, 1.0);
  const int full = static_cast<int>(part * kBar);
  const std::string bar = std::string(full, '#') + std::string(kBar - full, '.');
  std::fprintf(stderr, "\r\033[K%s [%s] %3.0f %% %s", prefix_.c_str(), bar.c_str(), 100 * part,
               note.c_str());
  std::fflush(stderr);
}

void Progress::finish(bool good, const std::string& note) {
  finished_ = true;
  std::fprintf(stderr, "%s%s %s %5.1f s  %s\n", terminal_ ? "\r\033[K" : "", prefix_.c_str(),
               good               ? "done   "
               : is_interrupted() ? "stopped"
                                  : "FAILED ",
               elapsed(), note.c_str());
}

}  // namespace palpate::common
