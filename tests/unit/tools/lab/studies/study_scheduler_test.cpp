#include "tools/lab/studies/study_scheduler.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>

#include <algorithm>
#include <chrono>
#include <thread>

#include "tests/unit/tools/lab/studies/study_folder.hpp"
#include "tools/common/interruption.hpp"
#include "tools/lab/studies/study_progress.hpp"

namespace palpate::studies {
namespace {

using State = TaskOutcome::State;

class StudyScheduler : public testing::Test {
 protected:
  /// A task that runs a shell script in its folder, which exists.
  Task task(const std::string& name, const std::string& hash, const std::string& script) const {
    std::filesystem::create_directories(folder_.file(name));
    return {name,
            {"sh", "-c", "cd '" + folder_.file(name).string() + "' && " + script},
            folder_.file(name),
            hash};
  }
  /// A task that counts its runs and leaves a result.
  Task good(const std::string& name, const std::string& hash = "h") const {
    return task(name, hash,
                R"(echo run >> runs; echo '{"inputs_hash": ")" + hash + R"("}' > result.json)");
  }
  long runs(const std::string& name) const {
    const std::string text = folder_.read(name + "/runs");
    return std::count(text.begin(), text.end(), '\n');
  }
  static std::vector<State> states(const std::vector<TaskOutcome>& outcomes) {
    std::vector<State> states;
    for (const TaskOutcome& outcome : outcomes) states.push_back(outcome.state);
    return states;
  }

  StudyFolder folder_;
  SchedulerOptions options_;
};

TEST_F(StudyScheduler, WhatHasAResultIsNotRunAgain) {
  std::vector<Task> tasks{good("a"), good("b")};
  EXPECT_THAT(states(run_tasks(tasks, options_)), testing::Each(State::kDone));
  EXPECT_THAT(states(run_tasks(tasks, options_)), testing::Each(State::kKept));
  EXPECT_EQ(runs("a"), 1);
  tasks[1] = good("b", "other");
  EXPECT_THAT(states(run_tasks(tasks, options_)), testing::ElementsAre(State::kKept, State::kDone));
  EXPECT_EQ(runs("a"), 1);
  EXPECT_EQ(runs("b"), 2);
}

TEST_F(StudyScheduler, AFailureIsReportedAndDoesNotStopTheRest) {
  const std::vector<Task> tasks{task("fails", "h", "echo what happened >&2; exit 7"),
                                good("good"),
                                task("silent", "h", "true"),
                                {"absent", {"/nonexistent/program"}, folder_.file("absent"), "h"}};
  const std::vector<TaskOutcome> outcomes = run_tasks(tasks, options_);
  EXPECT_THAT(states(outcomes),
              testing::ElementsAre(State::kFailed, State::kDone, State::kFailed, State::kFailed));
  EXPECT_THAT(outcomes[0].failure, testing::HasSubstr("exit code 7"));
  EXPECT_THAT(outcomes[0].failure, testing::HasSubstr("what happened"));
  EXPECT_THAT(outcomes[2].failure, testing::HasSubstr("no result"));
  EXPECT_THAT(outcomes[3].failure, testing::HasSubstr("/nonexistent/program"));
}

TEST_F(StudyScheduler, AFailedTaskLeavesNoOldResultBehind) {
  folder_.write("a/result.json", R"({"inputs_hash": "old"})");
  run_tasks({task("a", "new", "exit 1")}, options_);
  EXPECT_FALSE(std::filesystem::exists(folder_.file("a/result.json")));
}

TEST_F(StudyScheduler, ATornResultIsNone) {
  const Task half = task("a", "h", "true");
  folder_.write("a/result.json", R"({"inputs_hash": "h")");
  EXPECT_FALSE(has_result(half));
  folder_.write("a/result.json", R"(["inputs_hash"])");
  EXPECT_FALSE(has_result(half));
  folder_.write("a/result.json", R"({"inputs_hash": "h"})");
  EXPECT_TRUE(has_result(half));
}

TEST_F(StudyScheduler, AsManyRunAtATimeAsThereAreWorkers) {
  // Each waits for the other: sequentially they would never end.
  const auto meet = [&](const std::string& name, const std::string& other) {
    return task(name, "h",
                "touch here; while [ ! -e ../" + other +
                    R"(/here ]; do sleep 0.01; done; echo '{"inputs_hash": "h"}' > result.json)");
  };
  std::size_t most = 0;
  options_.workers = 2;
  options_.patience = 20;
  options_.show = [&most](const ScheduleStatus& s) { most = std::max(most, s.running.size()); };
  const auto outcomes = run_tasks({meet("a", "b"), meet("b", "a"), good("c"), good("d")}, options_);
  EXPECT_THAT(states(outcomes), testing::Each(State::kDone));
  EXPECT_LE(most, 2u);
}

TEST_F(StudyScheduler, TooLongIsAFailure) {
  options_.patience = 0.2;
  const auto outcomes = run_tasks({task("a", "h", "exec sleep 1000"), good("b")}, options_);
  EXPECT_THAT(states(outcomes), testing::ElementsAre(State::kFailed, State::kDone));
}

TEST_F(StudyScheduler, AnInterruptionEndsWhatRuns) {
  constexpr int kRightly = 42;
  options_.workers = 2;
  const std::string script = "echo $$ > pid; exec sleep 1000";
  const std::vector<Task> tasks{task("a", "h", script), task("b", "h", script), good("c")};
  const pid_t scheduler = fork();
  if (scheduler == 0) {
    common::catch_interruptions();
    options_.show = [&](const ScheduleStatus&) {
      if (!folder_.read("a/pid").empty() && !folder_.read("b/pid").empty()) raise(SIGINT);
    };
    try {
      run_tasks(tasks, options_);
    } catch (const common::Interrupted&) {
      _exit(kRightly);
    }
    _exit(1);
  }
  int status = 0;
  ASSERT_EQ(waitpid(scheduler, &status, 0), scheduler);
  EXPECT_EQ(WEXITSTATUS(status), kRightly);
  for (const char* name : {"a/pid", "b/pid"})
    EXPECT_NE(kill(std::stoi(folder_.read(name)), 0), 0) << name;
  EXPECT_EQ(runs("c"), 0);
}

TEST(StudyProgress, SaysWhatIsDoneRunningAndLeft) {
  ScheduleStatus status;
  status.total = 36;
  status.kept = 3;
  status.done = 2;
  status.running = {"a", "b"};
  EXPECT_EQ(progress_line(status), "[5/36] 2 running");
  status.failed = 1;
  status.left = 600;
  EXPECT_EQ(progress_line(status), "[5/36] 2 running, 1 failed, about 10 min left");
}

}  // namespace
}  // namespace palpate::studies
