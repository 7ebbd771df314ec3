#pragma once

#include <sys/ptrace.h>
#include <sys/wait.h>

#include <cerrno>
#include <filesystem>
#include <fstream>
#include <string>

namespace palpate {

/// Stops one thread of another process, as if it hung, while the others continue.
class HeldThread {
 public:
  HeldThread(int process, const std::string& name) {
    for (const auto& entry :
         std::filesystem::directory_iterator("/proc/" + std::to_string(process) + "/task")) {
      std::string its_name;
      std::getline(std::ifstream(entry.path() / "comm") >> std::ws, its_name);
      if (its_name == name) thread_ = std::stoi(entry.path().filename());
    }
    if (thread_ == 0 || ptrace(PTRACE_SEIZE, thread_, nullptr, nullptr) != 0) return;
    int status = 0;
    held_ = ptrace(PTRACE_INTERRUPT, thread_, nullptr, nullptr) == 0 &&
            waitpid(thread_, &status, __WALL) == thread_;
  }
  ~HeldThread() { release(); }
  HeldThread(const HeldThread&) = delete;
  HeldThread& operator=(const HeldThread&) = delete;

  bool found() const { return thread_ != 0; }
  bool held() const { return held_; }
  void release() {
    if (held_) ptrace(PTRACE_DETACH, thread_, nullptr, nullptr);
    held_ = false;
  }

 private:
  int thread_ = 0;
  bool held_ = false;
};

}  // namespace palpate
