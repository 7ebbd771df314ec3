#include "tools/lab/cases/case_commands.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>

#include "rt/config/node.hpp"
#include "tests/unit/tools/lab/cases/case_folder.hpp"

namespace palpate::cases {
namespace {

class CommandLine : public testing::Test {
 protected:
  CommandLine() { write_pulled_bar(folder_); }

  std::optional<int> run(std::vector<std::string> arguments) {
    CLI::App app;
    app.add_subcommand("other");
    CaseCommands commands(app);
    std::reverse(arguments.begin(), arguments.end());  // as CLI11 takes them
    app.parse(arguments);
    return commands.run({}, out_);
  }
  nlohmann::json written() const {
    std::ifstream in(folder_.path() / "out.json");
    return nlohmann::json::parse(in);
  }

  const CaseFolder folder_;
  const std::string case_ = folder_.path().string(), json_ = (folder_.path() / "out.json").string();
  std::ostringstream out_;
};

TEST_F(CommandLine, StaticWritesOneObjectOrAList) {
  EXPECT_EQ(run({"static", case_, "--element", "linear", "--ticks", "20", "--json", json_}), 0);
  EXPECT_EQ(written().at("element"), "linear");
  EXPECT_EQ(written().at("mesh"), "coarse");
  EXPECT_GT(written().at("step_p99_us").get<double>(), 0);
  EXPECT_NE(out_.str().find("pulled_bar"), std::string::npos);

  EXPECT_EQ(run({"static", case_, "--all", "--ticks", "0", "--json", json_}), 0);
  ASSERT_EQ(written().size(), 2u);
  EXPECT_NE(written().at(0).at("element"), written().at(1).at("element"));

  EXPECT_EQ(run({"static", case_, "--own-mesh", "4,1,2", "--ticks", "0", "--json", json_}), 0);
  EXPECT_EQ(written().at("mesh"), "4x1x2");
  EXPECT_EQ(written().at("elements"), 5 * 8);
}

TEST_F(CommandLine, DynamicReportsWhenTheBodySettles) {
  EXPECT_EQ(run({"dynamic", case_, "--rise", "0.02", "--json", json_}), 0);
  EXPECT_EQ(written().at("at_rest"), true);
  EXPECT_LT(written().at("probe_rms_error_over_max_u").get<double>(), 1e-4);
  EXPECT_LT(written().at("static").at("probe_rms_error_over_max_u").get<double>(), 1e-8);
  // Nothing is at rest that early.
  EXPECT_EQ(run({"dynamic", case_, "--seconds", "0.005"}), 1);
  EXPECT_NE(out_.str().find("NOT CONVERGED"), std::string::npos);
}

TEST_F(CommandLine, ThrowsForABadCaseAndLeavesOtherCommandsAlone) {
  EXPECT_THROW(run({"static", case_, "--mesh", "fine"}), config::Error);
  EXPECT_THROW(run({"static", case_ + "/none"}), config::Error);
  EXPECT_THROW(run({"static", case_, "--element", "cubic"}), CLI::ValidationError);
  EXPECT_EQ(run({"other"}), std::nullopt);
}

}  // namespace
}  // namespace palpate::cases
