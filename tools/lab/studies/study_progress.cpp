#include "tools/lab/studies/study_progress.hpp"

#include <unistd.h>

#include <cstdio>

#include "tools/common/table.hpp"

namespace palpate::studies {
namespace {

std::string duration(double seconds) {
  return seconds < 100 ? common::number(seconds, 0) + " s"
                       : common::number(seconds / 60, 0) + " min";
}

}  // namespace

std::string progress_line(const ScheduleStatus& status) {
  std::string line = "[" + std::to_string(status.kept + status.done) + "/" +
                     std::to_string(status.total) + "] " + std::to_string(status.running.size()) +
                     " running";
  if (status.failed > 0) line += ", " + std::to_string(status.failed) + " failed";
  if (status.left >= 0) line += ", about " + duration(status.left) + " left";
  return line;
}

ScheduleDisplay::ScheduleDisplay() : terminal_(isatty(STDERR_FILENO) == 1) {}

ScheduleDisplay::~ScheduleDisplay() {
  if (terminal_) std::fprintf(stderr, "\r\033[K");
}

void ScheduleDisplay::show(const ScheduleStatus& status) {
  const char* clear = terminal_ ? "\r\033[K" : "";
  if (status.finished != nullptr) {
    const bool failed = status.finished->state == TaskOutcome::State::kFailed;
    std::fprintf(stderr, "%s%s %s %s, %.1f s%s\n", clear, progress_line(status).c_str(),
                 failed ? "FAILED" : "done", status.finished->name.c_str(),
                 status.finished->seconds, failed ? (": " + status.finished->failure).c_str() : "");
  } else if (terminal_) {
    std::fprintf(stderr, "%s%s", clear, progress_line(status).c_str());
    std::fflush(stderr);
  }
}

}  // namespace palpate::studies
