#pragma once

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/scratch_folder.hpp"
#include "tools/common/process.hpp"

namespace palpate::mesh_tool {

/// Runs palpate-mesh and others in the test's own folder.
class MeshFolder : public ::testing::Test {
 protected:
  std::string path(const std::string& name) const { return (folder_.path() / name).string(); }

  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(path(name), std::ios::binary) << text;
    return path(name);
  }

  std::string text_of(const std::string& name) const {
    std::stringstream text;
    text << std::ifstream(path(name), std::ios::binary).rdbuf();
    return text.str();
  }

  /// Exit code of palpate-mesh; its output is stored in output().
  int run(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), PALPATE_MESH_PROGRAM);
    return run_other(arguments);
  }
  int run_other(const std::vector<std::string>& command) const {
    return common::run_to_end(command, path("output.txt"), 100);
  }
  std::string output() const { return text_of("output.txt"); }

  /// Output of --json, of a run that must succeed.
  nlohmann::json run_json(std::vector<std::string> arguments, int code = 0) const {
    arguments.insert(arguments.end(), {"--json", path("result.json")});
    EXPECT_EQ(run(arguments), code) << output();
    return nlohmann::json::parse(text_of("result.json"));
  }

 private:
  support::ScratchFolder folder_;
};

}  // namespace palpate::mesh_tool
