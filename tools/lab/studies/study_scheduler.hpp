#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace palpate::studies {

/// A program that leaves a result: `folder`/result.json, an object whose `inputs_hash` is that of
/// the task once it has come to its end. What it prints goes to `folder`/log.txt.
struct Task {
  std::string name;
  std::vector<std::string> command;
  std::filesystem::path folder;
  std::string inputs_hash;
};

struct TaskOutcome {
  enum class State { kDone, kKept, kFailed };  // kept: the result was there already
  std::string name;
  State state = State::kFailed;
  std::string failure;
  double seconds = 0;
};

struct ScheduleStatus {
  int total = 0;
  int kept = 0;
  int done = 0;  // in this call, well or not
  int failed = 0;
  std::vector<std::string> running;
  double elapsed = 0;                     // s
  double left = -1;                       // s, guessed from those done; below 0: not known yet
  const TaskOutcome* finished = nullptr;  // what has just ended
};

struct SchedulerOptions {
  int workers = 1;
  double patience = 1800;  // s that a task may take
  double grace = 20;       // s that an interrupted task has to end what it has started
  std::function<void(const ScheduleStatus&)> show;  // ten times a second, and as each task ends
};

/// True where the folder of the task holds the result of these very inputs.
bool has_result(const Task& task);

/// Runs the tasks that have no result yet, `workers` of them at a time, in their order; a failure
/// does not stop the others. One outcome a task. Once interrupted it ends all that run and throws
/// Interrupted.
std::vector<TaskOutcome> run_tasks(const std::vector<Task>& tasks, const SchedulerOptions& options);

}  // namespace palpate::studies
