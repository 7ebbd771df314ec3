#pragma once

#include <filesystem>
#include <fstream>
#include <functional>
#include <string>

#include "rt/config/node.hpp"
#include "tests/support/scratch_folder.hpp"
#include "tools/fit/plan.hpp"
#include "tools/fit/runner.hpp"

namespace palpate::fit {

/// A folder for recordings created by a test.
class FitFolder {
 public:
  const std::filesystem::path& path() const { return folder_.path(); }

  void write(const std::string& file, const std::string& text) const {
    std::ofstream(path() / file) << text;
  }

  Plan plan(const std::string& yaml) const {
    return read_plan(config::Node::from_text(yaml, "plan"), path());
  }

  std::vector<JobResult> run(const std::string& yaml, RunOptions options = {}) const {
    options.data = path();
    return fit::run(plan(yaml), options);
  }

  /// Error of a plan or its inputs; empty: none.
  std::string complaint(const std::string& yaml) const {
    try {
      run(yaml);
    } catch (const std::exception& error) {
      return error.what();
    }
    return "";
  }

 private:
  support::ScratchFolder folder_;
};

}  // namespace palpate::fit
