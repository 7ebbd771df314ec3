#include "rt/bus/instance_lock.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <memory>

namespace palpate::bus {
namespace {

/// Differs for each process that runs this test concurrently.
std::string url(const std::string& options) {
  return "udpm://239.255.76." + std::to_string(getpid() % 250) + ":" +
         std::to_string(20000 + getpid() % 10000) + options;
}

TEST(InstanceLock, ASecondOneIsRefusedUntilTheFirstIsGone) {
  auto first = std::make_unique<InstanceLock>(url("?ttl=0"));
  try {
    const InstanceLock second(url("?ttl=1&recv_buf_size=1000"));
    ADD_FAILURE() << "a second instance was let in";
  } catch (const std::runtime_error& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("another palpated (process " + std::to_string(getpid()) + ")"),
              std::string::npos)
        << text;
    EXPECT_NE(text.find(url("")), std::string::npos) << text;
  }
  first.reset();
  EXPECT_NO_THROW(InstanceLock(url("")));
}

TEST(InstanceLock, AnotherUrlOrRoleIsAnotherLock) {
  const InstanceLock first(url(""));
  EXPECT_NO_THROW(InstanceLock("udpm://239.255.77.1:19999"));
  EXPECT_NO_THROW(InstanceLock(url(""), "palpate-sim"));
  EXPECT_THROW(InstanceLock("file:///log"), std::invalid_argument);
  EXPECT_THROW(InstanceLock(url(""), std::string(33, 'x')), std::invalid_argument);
}

TEST(InstanceLock, AKilledProcessLeavesNothingBehind) {
  int ready[2];
  ASSERT_EQ(pipe(ready), 0);
  const std::string where = url("?ttl=0");
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    const InstanceLock lock(where);
    if (write(ready[1], "1", 1) != 1) _exit(1);
    for (;;) pause();
  }
  char byte = 0;
  ASSERT_EQ(read(ready[0], &byte, 1), 1);
  EXPECT_THROW(InstanceLock{where}, std::runtime_error);
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  EXPECT_NO_THROW(InstanceLock{where});
  close(ready[0]);
  close(ready[1]);
}

}  // namespace
}  // namespace palpate::bus
