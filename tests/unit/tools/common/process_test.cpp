#include "tools/common/process.hpp"

#include <gtest/gtest.h>
#include <signal.h>

#include <fstream>
#include <thread>

#include "tools/common/interruption.hpp"

namespace palpate::common {
namespace {

class ProcessTest : public testing::Test {
 protected:
  std::filesystem::path output_ = std::filesystem::path(testing::TempDir()) /
                                  ("process_" + std::to_string(getpid()) + "_" +
                                   testing::UnitTest::GetInstance()->current_test_info()->name());
  void TearDown() override { std::filesystem::remove(output_); }

  /// The number written by a child, once it has been written.
  pid_t written() const {
    for (int attempt = 0; attempt < 1000; ++attempt) {
      std::ifstream in(output_);
      pid_t pid = 0;
      if (in >> pid) return pid;
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return -1;
  }

  static bool is_gone(pid_t pid) {
    for (int attempt = 0; attempt < 1000; ++attempt) {
      std::ifstream stat("/proc/" + std::to_string(pid) + "/stat");
      std::string number, name, state;
      if (!(stat >> number >> name >> state) || state == "Z") return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return false;
  }
};

TEST_F(ProcessTest, OutputAndExitCodeAreKept) {
  EXPECT_EQ(run_to_end({"sh", "-c", "echo one; echo two >&2; echo three; exit 7"}, output_, 20), 7);
  EXPECT_EQ(tail(output_, 2), "two\nthree\n");
}

TEST_F(ProcessTest, AProgramThatEndsBecauseOfAnInterruptionHasNotDoneItsWork) {
  EXPECT_EXIT(
      {
        catch_interruptions();
        try {
          run_to_end({"sh", "-c", "kill -INT $PPID; exit 0"}, output_, 20);
        } catch (const Interrupted&) {
          _exit(3);
        }
        _exit(0);
      },
      testing::ExitedWithCode(3), "");
}

TEST_F(ProcessTest, ProgramThatIsAbsentIsAnError) {
  EXPECT_THROW(Process("none", {"/nonexistent/program"}, output_), std::runtime_error);
}

TEST_F(ProcessTest, AProgramInPythonThatFailsIsAnErrorWithItsReason) {
  EXPECT_NE(run_python("tools/common/plots.py", {"--help"}).find("panel"), std::string::npos);
  try {
    run_python("tools/common/plots.py", {"/nonexistent/plot.json"});
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("/nonexistent/plot.json"), std::string::npos);
  }
}

TEST_F(ProcessTest, StopIsPolite) {
  Process process("sh", {"sh", "-c", "trap 'exit 0' TERM; echo 1; while :; do sleep 0.01; done"},
                  output_);
  ASSERT_EQ(written(), 1);
  EXPECT_TRUE(process.running());
  EXPECT_EQ(process.stop(), 0);
  EXPECT_FALSE(process.running());
}

TEST_F(ProcessTest, ADeafProgramIsKilled) {
  Process process("sh", {"sh", "-c", "trap '' TERM; echo 1; while :; do sleep 0.01; done"},
                  output_);
  ASSERT_EQ(written(), 1);
  EXPECT_EQ(process.stop(0.1), 128 + SIGKILL);
}

TEST_F(ProcessTest, ChildrenOfTheChildGoToo) {
  pid_t grandchild = -1;
  {
    Process process("sh", {"sh", "-c", "trap '' TERM; sleep 1000 & echo $!; wait"}, output_);
    grandchild = written();
    ASSERT_GT(grandchild, 0);
    EXPECT_FALSE(kill(grandchild, 0));
    process.stop(0.1);
  }
  EXPECT_TRUE(is_gone(grandchild));
}

TEST_F(ProcessTest, NoChildOutlivesItsParent) {
  const pid_t middle = fork();
  if (middle == 0) {
    Process process("sleep", {"sh", "-c", "echo $$; exec sleep 1000"}, output_);
    for (;;) pause();
  }
  const pid_t child = written();
  ASSERT_GT(child, 0);
  ASSERT_EQ(kill(child, 0), 0);
  kill(middle, SIGKILL);
  EXPECT_TRUE(is_gone(child));
}

}  // namespace
}  // namespace palpate::common
