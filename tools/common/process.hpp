#pragma once

#include <sys/types.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace palpate::common {

/// A child program in a separate process group. It is killed with this object, including everything
/// it has started, and with this process (PR_SET_PDEATHSIG): start it from a thread that keeps
/// running.
class Process {
 public:
  /// Starts `command` (its first word a path, or a name in PATH); standard output and error go to
  /// the file `output`, standard input comes from the descriptor `input` (-1: it is empty), which
  /// stays the caller's. Throws std::runtime_error if it cannot be run.
  Process(std::string name, const std::vector<std::string>& command,
          const std::filesystem::path& output, int input = -1);
  ~Process();
  Process(Process&& other) noexcept;
  Process& operator=(Process&&) = delete;

  const std::string& name() const { return name_; }
  const std::filesystem::path& output() const { return output_; }
  pid_t pid() const { return pid_; }
  bool running();

  /// Waits for its end; empty after `seconds`. 128 + n if signal n ended it.
  std::optional<int> wait(double seconds);

  /// SIGTERM to the group, SIGKILL after `grace` seconds; the exit code.
  int stop(double grace = 5.0);

 private:
  void poll();
  std::string name_;
  std::filesystem::path output_;
  pid_t pid_ = -1;
  std::optional<int> exit_code_;
};

/// Runs a program to its end; throws Interrupted, and std::runtime_error after `timeout` seconds.
int run_to_end(const std::vector<std::string>& command, const std::filesystem::path& output,
               double timeout);

/// Runs one of palpate's own Python programs, by its path in the source tree
/// ("tools/common/plots.py"), and returns what it prints. Throws Interrupted, and
/// std::runtime_error with the end of its output if it fails.
std::string run_python(const std::string& program, const std::vector<std::string>& arguments);

/// Whether a program, by its path or by its name in PATH, can be run.
bool is_installed(const std::string& program);

/// The last `lines` lines of a text file; empty if there is none.
std::string tail(const std::filesystem::path& file, int lines);

/// Folder of this process' executable, where its sibling programs are.
std::filesystem::path program_folder();

}  // namespace palpate::common
