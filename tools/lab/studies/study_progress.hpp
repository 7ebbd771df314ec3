#pragma once

#include "tools/lab/studies/study_scheduler.hpp"

namespace palpate::studies {

/// Jobs done, running and pending on standard error: a status line on a terminal, otherwise one
/// line per finished job.
class ScheduleDisplay {
 public:
  ScheduleDisplay();
  ~ScheduleDisplay();
  void show(const ScheduleStatus& status);

 private:
  bool terminal_;
};

/// "[ 5/36] 2 running, about 3 min left".
std::string progress_line(const ScheduleStatus& status);

}  // namespace palpate::studies
