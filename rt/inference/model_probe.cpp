#ifndef PALPATE_WITHOUT_TORCH

#include "rt/inference/model_probe.hpp"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <mutex>
#include <set>

#include "rt/config/installation.hpp"
#include "rt/inference/model_card.hpp"

extern char** environ;

namespace palpate::inference {
namespace {

constexpr std::chrono::seconds kPatience(120);  // wall-clock limit for a heavily loaded machine
constexpr std::size_t kLongestReason = 1000;

[[noreturn]] void fail(const std::string& what, int error) {
  throw ModelError("it cannot be tried: " + what + ": " + std::strerror(error));
}

/// File descriptor that is closed by the destructor.
class Descriptor {
 public:
  Descriptor(int number, const char* what) : number_(number) {
    if (number < 0) fail(what, errno);
  }
  ~Descriptor() { close(); }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int number() const { return number_; }
  void close() {
    if (number_ >= 0) ::close(number_);
    number_ = -1;
  }

 private:
  int number_;
};

void fill(const Descriptor& file, const std::string& bytes) {
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t count = write(file.number(), bytes.data() + done, bytes.size() - done);
    if (count < 0 && errno != EINTR) fail("memory file", errno);
    if (count > 0) done += static_cast<std::size_t>(count);
  }
  lseek(file.number(), 0, SEEK_SET);
}

/// Starts `command` with these descriptors as standard input and output and default signal actions.
pid_t start(std::vector<std::string> command, int input, int output) {
  std::vector<char*> words;
  for (std::string& word : command) words.push_back(word.data());
  words.push_back(nullptr);
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_adddup2(&files, input, STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&files, output, STDOUT_FILENO);
  posix_spawn_file_actions_addopen(&files, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t none;
  sigemptyset(&none);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK);
  pid_t process = -1;
  const int error = posix_spawn(&process, words[0], &files, &attributes, words.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&files);
  if (error != 0) fail(command[0], error);
  return process;
}

/// Reads until the other end closes; kills the process on timeout.
std::string listen(int pipe, pid_t process) {
  const auto end = std::chrono::steady_clock::now() + kPatience;
  std::string text;
  char part[256];
  for (;;) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(
        end - std::chrono::steady_clock::now());
    pollfd wanted{pipe, POLLIN, 0};
    if (left.count() <= 0) kill(process, SIGKILL);
    if (left.count() > 0 && poll(&wanted, 1, static_cast<int>(left.count())) <= 0) continue;
    const ssize_t count = read(pipe, part, sizeof(part));
    if (count == 0 || (count < 0 && errno != EINTR)) return text;
    if (count > 0 && text.size() < kLongestReason)
      text.append(part, static_cast<std::size_t>(count));
  }
}

int wait_for(pid_t process) {
  int status = 0;
  while (waitpid(process, &status, 0) < 0) {
    if (errno != EINTR) fail("its process", errno);
  }
  return status;
}

/// Reason for rejecting the module; "" if it is accepted.
std::string verdict(const std::string& bytes, const ModelSizes& sizes) {
  const std::string program = config::companion("palpate-probe");
  const Descriptor module(memfd_create("palpate-module", MFD_CLOEXEC), "memory file");
  fill(module, bytes);
  int ends[2] = {-1, -1};
  if (pipe2(ends, O_CLOEXEC) != 0) fail("pipe", errno);
  const Descriptor from(ends[0], "pipe");
  Descriptor to(ends[1], "pipe");
  const pid_t process = start({program, std::to_string(sizes.inputs), std::to_string(sizes.states),
                               std::to_string(sizes.outputs)},
                              module.number(), to.number());
  to.close();
  const std::string said = listen(from.number(), process);
  const int status = wait_for(process);
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return "";
  if (WIFEXITED(status)) {
    return said.empty()
               ? "palpate-probe fails with exit code " + std::to_string(WEXITSTATUS(status))
               : said;
  }
  const int signal = WTERMSIG(status);
  if (signal == SIGXCPU || signal == SIGKILL)
    return "libtorch does not come to an end with it within " + std::to_string(kProbeSeconds) +
           " s of processor time";
  return std::string("libtorch crashes on it (") + strsignal(signal) + ")";
}

}  // namespace

void probe_module(const std::string& bytes, const ModelSizes& sizes) {
  static std::mutex mutex;
  static std::set<std::string> passed;
  const std::string key = sha256_of(bytes) + " " + std::to_string(sizes.inputs) + " " +
                          std::to_string(sizes.states) + " " + std::to_string(sizes.outputs);
  {
    const std::lock_guard<std::mutex> lock(mutex);
    if (passed.count(key) > 0) return;
  }
  const std::string reason = verdict(bytes, sizes);
  if (!reason.empty()) throw ModelError(reason);
  const std::lock_guard<std::mutex> lock(mutex);
  passed.insert(key);
}

}  // namespace palpate::inference

#endif
