#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace palpate::studies {

/// A program that leaves a result: `folder`/result.json, an object whose `inputs_hash` is that of
/// the task once it is complete. Its output goes to `folder`/log.txt.
struct Task {
  std::string name;
  std::vector<std::string> command;
  std::filesystem::path folder;
  std::string inputs_hash;
};

struct TaskOutcome {
  enum class State { kDone, kKept, kFailed };  // reused: the result already existed
  std::string name;
  State state = State::kFailed;
  std::string failure;
  double seconds = 0;
};

struct ScheduleStatus {
  int total = 0;
  int kept = 0;
  int done = 0;  // in this call, successful or not
  int failed = 0;
  std::vector<std::string> running;
  double elapsed = 0;                     // s
  double left = -1;                       // s, estimated from those done; negative: not known yet
  const TaskOutcome* finished = nullptr;  // the last task that ended
};

struct SchedulerOptions {
  int workers = 1;
  double patience = 1800;  // s, time-out of a task
  double grace = 20;       // s, grace period in which an interrupted task ends its children
  std::function<void(const ScheduleStatus&)> show;  // at 10 Hz, and as each task ends
};

/// True if the folder of the task holds the result of these inputs.
bool has_result(const Task& task);

/// Runs the tasks that have no result yet, `workers` of them at a time, in order; a failure does
/// not stop the others. One outcome per task. If interrupted, it ends all running tasks and throws
/// Interrupted.
std::vector<TaskOutcome> run_tasks(const std::vector<Task>& tasks, const SchedulerOptions& options);

}  // namespace palpate::studies
