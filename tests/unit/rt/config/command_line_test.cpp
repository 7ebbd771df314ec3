#include "rt/config/command_line.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <CLI/CLI.hpp>

namespace palpate::config {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

/// A program with an option, a subcommand, and a deprecated spelling of each kind.
class CommandLineTest : public ::testing::Test {
 protected:
  CommandLineTest() {
    app_.add_option("-o,--output", output_, "folder");
    app_.add_option("--config", configuration_, "YAML file");
    add_deprecated_positional(app_, "configuration", configuration_, "--config");
    add_url_option(app_, {{"control", &control_}, {"housekeeping", &housekeeping_}});
    app_.add_subcommand("sub", "a command")->add_option("--number", number_)->required();
    app_.footer("Example:\n  program --output there");
  }

  /// The exit code, or -1 where the program would continue; what is printed is in out_ and error_.
  int run(std::vector<const char*> words) {
    words.insert(words.begin(), "program");
    const CommandLine line{{{kExitError, "a run failed"}, {78, "wrong configuration"}},
                           {{"--out", "--output"}, {"--housekeeping", "--url", "housekeeping="}}};
    ::testing::internal::CaptureStdout();
    ::testing::internal::CaptureStderr();
    const auto code = parse(app_, static_cast<int>(words.size()), words.data(), line);
    out_ = ::testing::internal::GetCapturedStdout();
    error_ = ::testing::internal::GetCapturedStderr();
    return code.value_or(-1);
  }

  CLI::App app_{"program does nothing"};
  std::string output_, configuration_, control_ = "udpm://a:1", housekeeping_;
  int number_ = 0;
  std::string out_, error_;
};

TEST_F(CommandLineTest, GoesOnSilentlyAfterARightCommandLine) {
  EXPECT_EQ(run({"--output", "there", "--config", "a.yaml"}), -1);
  EXPECT_EQ(output_, "there");
  EXPECT_EQ(configuration_, "a.yaml");
  EXPECT_EQ(out_ + error_, "");
}

TEST_F(CommandLineTest, EveryWrongCommandLineEndsWithTheSameCode) {
  EXPECT_EQ(run({"--no-such-option"}), kExitUsage);
  EXPECT_THAT(error_, HasSubstr("--no-such-option"));
  EXPECT_THAT(error_, HasSubstr("--help"));
  EXPECT_EQ(run({"sub"}), kExitUsage);
  EXPECT_EQ(run({"sub", "--number", "three"}), kExitUsage);
  EXPECT_EQ(run({"--output"}), kExitUsage);
  EXPECT_EQ(run({"--url", "pictures=udpm://a:1"}), kExitUsage);
  EXPECT_THAT(error_, HasSubstr("none of the labels control, housekeeping"));
}

TEST_F(CommandLineTest, HelpAndVersionEndWithZero) {
  EXPECT_EQ(run({"--version"}), 0);
  EXPECT_EQ(out_, PALPATE_VERSION "\n");
  EXPECT_EQ(run({"--help"}), 0);
  EXPECT_THAT(out_, HasSubstr("  program --output there\n"
                              "Exit codes: 0   done\n"
                              "            1   a run failed\n"
                              "            64  wrong command line\n"
                              "            78  wrong configuration\n"));
}

TEST_F(CommandLineTest, ASubcommandsHelpHasTheTableToo) {
  EXPECT_EQ(run({"sub", "--help"}), 0);
  EXPECT_THAT(out_, HasSubstr("Exit codes: 0   done\n"));
}

TEST_F(CommandLineTest, HelpNamesNoDeprecatedSpelling) {
  run({"--help"});
  EXPECT_THAT(out_, HasSubstr("-o,--output"));
  EXPECT_THAT(out_, Not(HasSubstr("--out ")));
  EXPECT_THAT(out_, Not(HasSubstr("configuration]")));
  EXPECT_THAT(out_, Not(HasSubstr("Positionals")));
  EXPECT_THAT(out_, HasSubstr("--url [LABEL=]URL"));
}

TEST_F(CommandLineTest, ARenamedOptionWorksAndWarnsInOneLine) {
  EXPECT_EQ(run({"--out", "there"}), -1);
  EXPECT_EQ(output_, "there");
  EXPECT_EQ(error_, "warning: --out is deprecated; use --output\n");
}

TEST_F(CommandLineTest, ARenamedOptionWorksWithAnEqualsSign) {
  EXPECT_EQ(run({"--out=there"}), -1);
  EXPECT_EQ(output_, "there");
  EXPECT_EQ(error_, "warning: --out is deprecated; use --output\n");
}

TEST_F(CommandLineTest, ARenamedOptionMayBringThePrefixOfItsValue) {
  EXPECT_EQ(run({"--housekeeping", "udpm://b:2?ttl=0"}), -1);
  EXPECT_EQ(housekeeping_, "udpm://b:2?ttl=0");
  EXPECT_EQ(control_, "udpm://a:1");
  EXPECT_EQ(error_, "warning: --housekeeping is deprecated; use --url housekeeping=...\n");
}

TEST_F(CommandLineTest, APositionalThatBecameAnOptionWorksAndWarns) {
  EXPECT_EQ(run({"a.yaml"}), -1);
  EXPECT_EQ(configuration_, "a.yaml");
  EXPECT_EQ(error_, "warning: the positional argument configuration is deprecated; use --config\n");
}

TEST_F(CommandLineTest, APositionalExcludesItsOption) {
  EXPECT_EQ(run({"a.yaml", "--config", "b.yaml"}), kExitUsage);
  EXPECT_THAT(error_, HasSubstr("'a.yaml' is given in addition to --config"));
}

TEST_F(CommandLineTest, AUrlHasALabelOrIsThatOfControl) {
  EXPECT_EQ(run({"--url", "udpm://c:3?ttl=0", "--url", "housekeeping=udpm://d:4?ttl=0"}), -1);
  EXPECT_EQ(control_, "udpm://c:3?ttl=0");
  EXPECT_EQ(housekeeping_, "udpm://d:4?ttl=0");
  EXPECT_EQ(error_, "");
}

TEST_F(CommandLineTest, AMessageOfTheProgramEndsLikeAnyWrongCommandLine) {
  ::testing::internal::CaptureStderr();
  EXPECT_EQ(usage_error(app_, "a log is required"), kExitUsage);
  EXPECT_THAT(::testing::internal::GetCapturedStderr(),
              HasSubstr("a log is required\nRun with --help for more information."));
}

}  // namespace
}  // namespace palpate::config
