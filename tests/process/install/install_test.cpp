// The unit for systemd starts the installed programs.

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <fstream>
#include <sstream>

#include "tests/support/child_process.hpp"
#include "tests/support/scratch_folder.hpp"

namespace palpate {
namespace {

namespace fs = std::filesystem;

std::string text_of(const fs::path& file) {
  std::stringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

/// Value of `key` in a unit.
std::string word_behind(const std::string& key, const std::string& text) {
  const std::size_t at = text.find(key);
  if (at == std::string::npos) return "";
  const std::size_t begin = at + key.size();
  return text.substr(begin, text.find_first_of(" \n", begin) - begin);
}

TEST(Install, TheUnitStartsTheDaemonThatIsInstalled) {
  const support::ScratchFolder folder;
  const std::string command = "cmake --install '" + std::string(PALPATE_BUILD_DIR) +
                              "' --component daemon --prefix '" + folder.path().string() + "' > '" +
                              (folder.path() / "words.txt").string() + "' 2>&1";
  ASSERT_EQ(WEXITSTATUS(std::system(command.c_str())), 0) << text_of(folder.path() / "words.txt");
  const std::string unit = text_of(folder.path() / "lib/systemd/system/palpated.service");
  const std::string program = word_behind("ExecStart=", unit);
  EXPECT_EQ(program, (folder.path() / "bin/palpated").string()) << unit;

  support::ChildProcess version({program, "--version"});
  EXPECT_EQ(version.wait(std::chrono::seconds(20)), 0) << version.output();
  EXPECT_NE(version.output().find(PALPATE_VERSION), std::string::npos) << version.output();
  // Examples are read correctly: the wrong key is the only complaint.
  support::ChildProcess wrong(
      {program, "--config",
       (folder.path() / "share/palpate/rt/config/examples/bar_long_soft.yaml").string(), "--set",
       "loop.no_such_key=1"});
  EXPECT_EQ(wrong.wait(std::chrono::seconds(20)), 78);
  EXPECT_NE(wrong.output().find("no_such_key"), std::string::npos) << wrong.output();
}

/// The file that find_package(palpate) reads, as written by CMake in the build folder.
std::string exported_targets() {
  const fs::path folder = fs::path(PALPATE_BUILD_DIR) / "tools/packaging/CMakeFiles/Export";
  if (!fs::exists(folder)) return "";
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder))
    if (entry.path().filename() == "palpateTargets.cmake") return text_of(entry.path());
  return "";
}

TEST(Install, UsersOfThePackageChooseTheirProcessor) {
  const std::string targets = exported_targets();
  ASSERT_NE(targets.find("palpate::flags"), std::string::npos) << "no exported targets";
  EXPECT_EQ(targets.find("-march"), std::string::npos);
  EXPECT_EQ(targets.find("-mtune"), std::string::npos);
  EXPECT_NE(targets.find("EIGEN_MAX_ALIGN_BYTES=16"), std::string::npos)
      << "types of Eigen have another size or alignment without it";
}

}  // namespace
}  // namespace palpate
