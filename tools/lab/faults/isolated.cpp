#include "tools/lab/faults/isolated.hpp"

#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstring>
#include <stdexcept>
#include <string>
#include <utility>

namespace palpate::faults {
namespace {

constexpr unsigned kPatience = 60;  // s, of one task

struct Record {
  int index;
  RunResult result;
};

/// A process that processes every `stride`th task from `next` on.
struct Worker {
  pid_t process = -1;
  int pipe = -1;
  int next = 0;  // the task whose result is pending
};

[[noreturn]] void work(int first, int count, int stride, int pipe,
                       const std::function<RunResult(int)>& task) {
  for (int index = first; index < count; index += stride) {
    alarm(kPatience);
    Record record{index, {}};
    try {
      record.result = task(index);
    } catch (const std::exception& error) {
      record.result.fail(std::string("exception: ") + error.what());
    }
    // Below PIPE_BUF: the write is atomic.
    if (write(pipe, &record, sizeof record) != sizeof record) break;
  }
  _exit(0);
}

void start(Worker& worker, int count, int stride, const std::function<RunResult(int)>& task) {
  int ends[2];
  if (pipe(ends) != 0) throw std::runtime_error("cannot make a pipe");
  worker.process = fork();
  if (worker.process < 0) throw std::runtime_error("cannot make a process");
  if (worker.process == 0) {
    close(ends[0]);
    work(worker.next, count, stride, ends[1], task);
  }
  close(ends[1]);
  worker.pipe = ends[0];
}

/// Handles the remaining tasks of a process that has ended: its current task has crashed.
RunResult crashed(int status) {
  RunResult result;
  result.crashed = true;
  const bool hung = WIFSIGNALED(status) && WTERMSIG(status) == SIGALRM;
  result.fail(hung                  ? "hangs"
              : WIFSIGNALED(status) ? std::string("crash: ") + strsignal(WTERMSIG(status))
                                    : std::string("the process ended"));
  return result;
}

}  // namespace

std::vector<RunResult> run_isolated(int count, int jobs, const std::function<RunResult(int)>& task,
                                    const std::function<void(int)>& done) {
  std::vector<RunResult> results(count);
  std::vector<Worker> workers(std::min(jobs, count));
  const int stride = static_cast<int>(workers.size());
  for (int i = 0; i < stride; ++i) {
    workers[i].next = i;
    start(workers[i], count, stride, task);
  }
  for (int finished = 0; finished < count;) {
    std::vector<pollfd> polled;
    for (const Worker& worker : workers) polled.push_back({worker.pipe, POLLIN, 0});
    if (poll(polled.data(), polled.size(), -1) < 0) continue;
    for (int i = 0; i < stride; ++i) {
      Worker& worker = workers[i];
      if (worker.pipe < 0 || polled[i].revents == 0) continue;
      Record record;
      if (read(worker.pipe, &record, sizeof record) == sizeof record) {
        results[record.index] = record.result;
      } else {
        int status = 0;
        close(std::exchange(worker.pipe, -1));
        waitpid(worker.process, &status, 0);
        if (worker.next >= count) continue;
        results[worker.next] = crashed(status);
      }
      worker.next += stride;
      ++finished;
      if (done) done(finished);
      if (worker.pipe < 0 && worker.next < count) start(worker, count, stride, task);
    }
  }
  for (Worker& worker : workers) {
    if (worker.pipe < 0) continue;
    close(worker.pipe);
    waitpid(worker.process, nullptr, 0);
  }
  return results;
}

}  // namespace palpate::faults
