#include "tools/common/process.hpp"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <thread>

#include "rt/config/installation.hpp"
#include "tools/common/interruption.hpp"
#include "tools/common/output_files.hpp"

namespace palpate::common {
namespace {

using Clock = std::chrono::steady_clock;

Clock::time_point after(double seconds) {
  return Clock::now() +
         std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
}

/// Between fork and exec only async-signal-safe calls are allowed.
[[noreturn]] void become(char* const* arguments, int input, int output, int error_pipe,
                         pid_t parent) {
  setpgid(0, 0);
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(1);  // the parent died before prctl
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGPIPE}) ::signal(signal, SIG_DFL);
  dup2(input >= 0 ? input : open("/dev/null", O_RDONLY), STDIN_FILENO);
  dup2(output, STDOUT_FILENO);
  dup2(output, STDERR_FILENO);
  execvp(arguments[0], arguments);
  const int reason = errno;
  if (write(error_pipe, &reason, sizeof reason) < 0) _exit(126);
  _exit(127);
}

}  // namespace

Process::Process(std::string name, const std::vector<std::string>& command,
                 const std::filesystem::path& output, int input)
    : name_(std::move(name)), output_(output) {
  const int file = open(output.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (file < 0)
    throw std::runtime_error("cannot write " + output.string() + ": " + std::strerror(errno));
  int error_pipe[2];
  if (pipe2(error_pipe, O_CLOEXEC) != 0) {
    close(file);
    throw std::runtime_error(std::string("cannot open a pipe: ") + std::strerror(errno));
  }
  std::vector<std::string> words = command;
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);

  const pid_t parent = getpid();
  pid_ = fork();
  if (pid_ == 0) become(arguments.data(), input, file, error_pipe[1], parent);
  const int fork_error = errno;
  close(file);
  close(error_pipe[1]);
  int reason = pid_ < 0 ? fork_error : 0;
  // End of file without data means that exec closed the pipe: the program runs.
  if (pid_ > 0 && read(error_pipe[0], &reason, sizeof reason) != sizeof reason) reason = 0;
  close(error_pipe[0]);
  if (reason != 0) {
    if (pid_ > 0) waitpid(pid_, nullptr, 0);
    pid_ = -1;
    throw std::runtime_error("cannot run " + command.at(0) + ": " + std::strerror(reason));
  }
}

Process::Process(Process&& other) noexcept
    : name_(std::move(other.name_)),
      output_(std::move(other.output_)),
      pid_(other.pid_),
      exit_code_(other.exit_code_) {
  other.pid_ = -1;
}

Process::~Process() {
  if (pid_ > 0) stop(2.0);
}

void Process::poll() {
  if (pid_ < 0 || exit_code_) return;
  int status = 0;
  if (waitpid(pid_, &status, WNOHANG) != pid_) return;
  exit_code_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

bool Process::running() {
  poll();
  return pid_ > 0 && !exit_code_;
}

std::optional<int> Process::wait(double seconds) {
  const auto end = after(seconds);
  while (running() && Clock::now() < end) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  return exit_code_;
}

int Process::stop(double grace) {
  if (pid_ < 0) return 0;
  if (running()) {
    kill(-pid_, SIGTERM);
    kill(pid_, SIGTERM);  // in case it has not created its group yet
    if (!wait(grace)) {
      kill(-pid_, SIGKILL);
      kill(pid_, SIGKILL);
      wait(2.0);
    }
  }
  kill(-pid_, SIGKILL);  // processes that the child has started and left behind
  return exit_code_.value_or(128 + SIGKILL);
}

int run_to_end(const std::vector<std::string>& command, const std::filesystem::path& output,
               double timeout) {
  Process process(command.at(0), command, output);
  const auto end = after(timeout);
  while (Clock::now() < end) {
    throw_if_interrupted();
    if (const auto code = process.wait(0.05)) {
      throw_if_interrupted();  // Ctrl-C reaches the program, too, which then ends early with 0
      return *code;
    }
  }
  throw std::runtime_error(command.at(0) + " did not end within " +
                           std::to_string(static_cast<int>(timeout)) + " s");
}

std::string run_python(const std::string& program, const std::vector<std::string>& arguments) {
  constexpr const char* kSystemPython = "/usr/bin/python3";  // has Debian's packages
  constexpr double kPatience = 900;                          // s
  const TemporaryFolder folder("palpate-python");
  const std::filesystem::path said = folder.path() / "output.txt";
  std::vector<std::string> command{
      std::filesystem::exists(kSystemPython) ? kSystemPython : "python3", "-B", "-X", "utf8",
      (config::data_folder() / program).string()};
  command.insert(command.end(), arguments.begin(), arguments.end());
  if (run_to_end(command, said, kPatience) != 0)
    throw std::runtime_error(program + ": " + tail(said, 8));
  std::ostringstream text;
  text << std::ifstream(said).rdbuf();
  return text.str();
}

bool is_installed(const std::string& program) {
  if (program.find('/') != std::string::npos) return access(program.c_str(), X_OK) == 0;
  const char* folders = std::getenv("PATH");
  std::istringstream list(folders == nullptr ? "" : folders);
  for (std::string folder; std::getline(list, folder, ':');)
    if (access((std::filesystem::path(folder) / program).c_str(), X_OK) == 0) return true;
  return false;
}

std::string tail(const std::filesystem::path& file, int lines) {
  std::ifstream in(file);
  std::deque<std::string> last;
  for (std::string line; std::getline(in, line);) {
    last.push_back(line);
    if (static_cast<int>(last.size()) > lines) last.pop_front();
  }
  std::string text;
  for (const std::string& line : last) text += line + "\n";
  return text;
}

std::filesystem::path program_folder() { return config::program_folder(); }

}  // namespace palpate::common
