#include "tools/lab/studies/study_scheduler.hpp"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <fstream>
#include <list>
#include <nlohmann/json.hpp>

#include "tools/common/interruption.hpp"
#include "tools/common/process.hpp"

namespace palpate::studies {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kPoll = 0.02;  // s
constexpr int kPollsAShow = 5;
constexpr int kTail = 12;  // lines of a failed task's output

double since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

struct Running {
  std::size_t task;
  common::Process process;
  Clock::time_point begin = Clock::now();
};

class Schedule {
 public:
  Schedule(const std::vector<Task>& tasks, const SchedulerOptions& options)
      : tasks_(tasks), options_(options), outcomes_(tasks.size()) {
    for (std::size_t i = 0; i < tasks.size(); ++i) {
      outcomes_[i].name = tasks[i].name;
      if (has_result(tasks[i]))
        outcomes_[i].state = TaskOutcome::State::kKept;
      else
        waiting_.push_back(i);
    }
    status_.total = static_cast<int>(tasks.size());
    status_.kept = status_.total - static_cast<int>(waiting_.size());
  }

  std::vector<TaskOutcome> run() {
    try {
      for (int polls = 0; !waiting_.empty() || !running_.empty(); ++polls) {
        start_some();
        collect();
        if (polls % kPollsAShow == 0) show(nullptr);
        if (!running_.empty()) common::sleep_for(kPoll);
      }
    } catch (...) {
      end_all();
      throw;
    }
    return outcomes_;
  }

 private:
  void start_some() {
    while (!waiting_.empty() && static_cast<int>(running_.size()) < options_.workers) {
      const std::size_t i = waiting_.front();
      waiting_.pop_front();
      const Task& task = tasks_[i];
      try {
        std::filesystem::create_directories(task.folder);
        std::filesystem::remove(task.folder / "result.json");
        running_.push_back({i, common::Process(task.name, task.command, task.folder / "log.txt")});
      } catch (const std::exception& error) {
        end(i, 0, error.what());
      }
    }
  }

  void collect() {
    for (auto at = running_.begin(); at != running_.end();) {
      const auto code = at->process.wait(0);
      const bool late = !code && since(at->begin) > options_.patience;
      if (!code && !late) {
        ++at;
        continue;
      }
      if (late) at->process.stop(options_.grace);
      const std::size_t task = at->task;
      const double seconds = since(at->begin);
      running_.erase(at++);
      end(task, seconds, late ? "took too long" : failure_of(tasks_[task], *code));
    }
  }

  static std::string failure_of(const Task& task, int code) {
    if (code == 0 && has_result(task)) return "";
    const std::string what = code == 0 ? "left no result" : "exit code " + std::to_string(code);
    return what + ":\n" + common::tail(task.folder / "log.txt", kTail);
  }

  void end(std::size_t task, double seconds, const std::string& failure) {
    TaskOutcome& outcome = outcomes_[task];
    outcome.state = failure.empty() ? TaskOutcome::State::kDone : TaskOutcome::State::kFailed;
    outcome.failure = failure;
    outcome.seconds = seconds;
    busy_ += seconds;
    ++status_.done;
    if (!failure.empty()) ++status_.failed;
    show(&outcome);
  }

  void show(const TaskOutcome* finished) {
    if (!options_.show) return;
    status_.finished = finished;
    status_.elapsed = since(begin_);
    status_.running.clear();
    double under_way = 0;
    for (const Running& running : running_) {
      status_.running.push_back(tasks_[running.task].name);
      under_way += since(running.begin);
    }
    if (status_.done > 0) {
      const int open = status_.total - status_.kept - status_.done;
      const double work = open * busy_ / status_.done - under_way;
      status_.left = std::max(0.0, work / std::max(1, std::min(options_.workers, open)));
    }
    options_.show(status_);
  }

  /// All at once: each has child processes to end.
  void end_all() {
    for (const Running& running : running_) kill(running.process.pid(), SIGTERM);
    for (Running& running : running_) running.process.stop(options_.grace);
  }

  const std::vector<Task>& tasks_;
  const SchedulerOptions& options_;
  std::vector<TaskOutcome> outcomes_;
  std::list<std::size_t> waiting_;
  std::list<Running> running_;
  ScheduleStatus status_;
  double busy_ = 0;  // s, of all that have ended
  Clock::time_point begin_ = Clock::now();
};

}  // namespace

bool has_result(const Task& task) {
  std::ifstream in(task.folder / "result.json");
  const nlohmann::json result = nlohmann::json::parse(in, nullptr, false);
  return result.is_object() && result.value("inputs_hash", "") == task.inputs_hash;
}

std::vector<TaskOutcome> run_tasks(const std::vector<Task>& tasks,
                                   const SchedulerOptions& options) {
  return Schedule(tasks, options).run();
}

}  // namespace palpate::studies
