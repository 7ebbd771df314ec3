#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "tests/support/child_process.hpp"

namespace palpate::exporting {

/// Output of a script of this folder, run by Debian's Python, and its exit code.
struct Answer {
  int code = -1;
  std::string text;
};

inline Answer run(std::vector<std::string> command) {
  support::ChildProcess process(std::move(command));
  Answer answer;
  answer.code = process.wait(std::chrono::seconds(100));
  answer.text = process.output();
  return answer;
}

inline Answer run_python(const std::string& script, const std::vector<std::string>& arguments) {
  std::vector<std::string> command{
      DEBIAN_PYTHON, std::string(PALPATE_SOURCE_DIR) + "/tests/unit/tools/export/" + script};
  command.insert(command.end(), arguments.begin(), arguments.end());
  return run(command);
}

}  // namespace palpate::exporting
