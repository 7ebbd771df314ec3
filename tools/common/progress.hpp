#pragma once

#include <chrono>
#include <string>

namespace palpate::common {

/// One line per stage on standard error: a progress bar on a terminal, otherwise one line at the
/// end.
class Progress {
 public:
  /// `position` of `count` stages, counted from 1.
  Progress(int position, int count, std::string title);
  /// Ends the line as failed unless finish() was called.
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void show(double fraction, const std::string& note = "");
  void finish(bool good, const std::string& note = "");

 private:
  double elapsed() const;
  std::string prefix_;
  bool terminal_;
  bool finished_ = false;
  std::chrono::steady_clock::time_point start_;
};

}  // namespace palpate::common
