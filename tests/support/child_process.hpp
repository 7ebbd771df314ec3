#pragma once

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

extern char** environ;

namespace palpate::support {

/// A child program in a separate process, with its output in a file; killed at the latest by the
/// destructor.
class ChildProcess {
 public:
  explicit ChildProcess(std::vector<std::string> command) {
    output_ = std::filesystem::temp_directory_path() /
              ("palpate_test_" + std::to_string(getpid()) + "_" + std::to_string(next_id()++));
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, output_.c_str(),
                                     O_CREAT | O_WRONLY | O_TRUNC, 0600);
    posix_spawn_file_actions_adddup2(&actions, STDOUT_FILENO, STDERR_FILENO);
    std::vector<char*> arguments;
    for (std::string& word : command) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    if (posix_spawn(&pid_, arguments[0], &actions, nullptr, arguments.data(), environ) != 0)
      pid_ = -1;
    posix_spawn_file_actions_destroy(&actions);
  }
  ~ChildProcess() {
    if (running()) {
      send(SIGKILL);
      wait(std::chrono::seconds(5));
    }
    std::error_code ignored;
    std::filesystem::remove(output_, ignored);
  }
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  void send(int signal) const {
    if (pid_ > 0) kill(pid_, signal);
  }

  int pid() const { return pid_; }

  bool running() {
    if (pid_ <= 0 || ended_) return false;
    ended_ = waitpid(pid_, &status_, WNOHANG) == pid_;
    return !ended_;
  }

  /// Exit code; 128 + signal if one ended it; -1 if it is still running after `limit`.
  int wait(std::chrono::milliseconds limit) {
    const auto end = std::chrono::steady_clock::now() + limit;
    while (running()) {
      if (std::chrono::steady_clock::now() > end) return -1;
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    if (pid_ <= 0) return -1;
    return WIFEXITED(status_) ? WEXITSTATUS(status_) : 128 + WTERMSIG(status_);
  }

  std::string output() const {
    std::ifstream file(output_);
    std::stringstream text;
    text << file.rdbuf();
    return text.str();
  }

 private:
  static int& next_id() {
    static int id = 0;
    return id;
  }
  pid_t pid_ = -1;
  int status_ = 0;
  bool ended_ = false;
  std::filesystem::path output_;
};

/// LCM URL of this test process only, the same at each call: concurrent test runs do not receive
/// each other's messages. Its port is below those assigned by the system.
inline std::string private_url(int which) {
  const int number = getpid() % 20000;
  return "udpm://239.255." + std::to_string(80 + number / 250) + "." +
         std::to_string(1 + number % 250) + ":" +
         std::to_string(10000 + 3 * number % 22000 + which) + "?ttl=0";
}

}  // namespace palpate::support
