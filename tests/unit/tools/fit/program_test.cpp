#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <csignal>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "rt/config/node.hpp"
#include "rt/registry/object.hpp"
#include "tests/unit/tools/fit/fit_folder.hpp"
#include "tools/common/process.hpp"
#include "tools/fit/checkpoint.hpp"

namespace palpate::fit {
namespace {

using ::testing::AllOf;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;

std::string text_of(const std::filesystem::path& file) {
  std::stringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

/// A ball of 5 mm pressed 2 mm into 20 kPa, with a little noise.
std::string indentation_csv() {
  std::ostringstream out;
  out << "d,F\n";
  for (int i = 0; i <= 20; ++i) {
    const double d = 1e-4 * i;
    const double F = 4.0 / 3 * 20e3 / 0.75 * std::sqrt(5e-3) * std::pow(d, 1.5);
    out << 1e3 * d << ',' << F + 1e-4 * std::sin(17.0 * i) << '\n';
  }
  return out.str();
}

constexpr char kPlan[] =
    "name: ball\nrecordings:\n  - {kind: hertz, file: a.csv, columns: {depth: {name: d, unit: mm}, "
    "force: {name: F}}, geometry: {radius: 5 mm}, contact_offset: none, held_out: {quantity: "
    "depth, "
    "from: 1.5e-3}}\n";

class ProgramTest : public testing::Test {
 protected:
  ProgramTest() {
    folder_.write("a.csv", indentation_csv());
    folder_.write("plan.yaml", kPlan);
  }

  /// Exit code; the output is stored in output().
  int run_program(std::vector<std::string> arguments) {
    std::vector<std::string> command = {PALPATE_FIT_PROGRAM,
                                        (folder_.path() / "plan.yaml").string(), "--data",
                                        folder_.path().string()};
    command.insert(command.end(), arguments.begin(), arguments.end());
    return common::run_to_end(command, folder_.path() / "output.txt", 60);
  }
  std::string output() const { return text_of(folder_.path() / "output.txt"); }

  FitFolder folder_;
};

TEST_F(ProgramTest, WritesWhatItFound) {
  const std::filesystem::path out = folder_.path() / "out";
  ASSERT_EQ(run_program({"--output", out.string(), "--json", (out / "all.json").string(),
                         "--check-gradients", "--numeric"}),
            0)
      << output();
  EXPECT_THAT(output(), AllOf(HasSubstr("young_modulus"), HasSubstr("95 % interval"),
                              HasSubstr("times the evaluations"), HasSubstr("Ridders")));
  const config::Node material = config::Node::load_file((out / "material.yaml").string());
  EXPECT_NEAR(material.child("material").number("young_modulus", {}), 20e3, 100);
  EXPECT_EQ(material.child("material").text("model"), "linear");
  EXPECT_NEAR(material.child("corotational").number("young_modulus", {}), 20e3, 100);
  EXPECT_LT(material.child("corotational").number("poisson_ratio", {}), 0.4999);
  const std::vector<double> interval = material.child("intervals").numbers("young_modulus", 2);
  EXPECT_LT(interval[0], 20e3 + 50);
  EXPECT_GT(interval[1], 20e3 - 50);
  const nlohmann::json json = nlohmann::json::parse(text_of(out / "all.json"));
  EXPECT_EQ(json["fits"][0]["parameters"]["poisson_ratio"]["standing"], "known");
  EXPECT_GT(json["fits"][0]["series"][0]["held_out"]["samples"], 3);
  EXPECT_THAT(text_of(out / "samples.csv"), HasSubstr("a,force,N,depth,m,0.0015,"));
  EXPECT_EQ(text_of(out / "fit.png").substr(1, 3), "PNG");
  EXPECT_EQ(nlohmann::json::parse(text_of(out / "fits.json")), json);
  EXPECT_FALSE(std::filesystem::exists(out / "checkpoint.json"));  // done
}

TEST_F(ProgramTest, PalpatedReadsWhatItWrites) {
  ASSERT_EQ(run_program({"--output", folder_.path().string()}), 0) << output();
  folder_.write("bar.yaml",
                "object:\n  mesh: {box: {size: [0.2, 0.04, 0.04], cells: [4, 1, 1]}}\n"
                "  fixed_box: {lower: [0, 0, 0], upper: [0, 0.04, 0.04]}\n"
                "  grasp_box: {lower: [0.2, 0, 0], upper: [0.2, 0.04, 0.04]}\n"
                "  material: {density: 26}\n  material_file: material.yaml\n");
  const config::Node root = config::Node::load_file((folder_.path() / "bar.yaml").string());
  const registry::Object object = registry::read_object(root, registry::Frames());
  root.check_all_used();
  EXPECT_NEAR(object.body.material.young_modulus, 20e3, 100);
  EXPECT_EQ(object.body.material.density, 26);
}

TEST_F(ProgramTest, WhatWasKilledIsGoneOnFrom) {
  const std::filesystem::path out = folder_.path() / "out", checkpoint = out / "checkpoint.json";
  const std::vector<std::string> command = {PALPATE_FIT_PROGRAM,
                                            (folder_.path() / "plan.yaml").string(),
                                            "--data",
                                            folder_.path().string(),
                                            "--output",
                                            out.string(),
                                            "--set",
                                            "solver.starts=2000"};
  {
    common::Process process("palpate-fit", command, folder_.path() / "killed.txt");
    while (!std::filesystem::exists(checkpoint) && process.running())
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    ::kill(process.pid(), SIGKILL);
    ASSERT_EQ(process.wait(60), 128 + SIGKILL) << text_of(process.output());
  }
  const nlohmann::json kept = nlohmann::json::parse(text_of(checkpoint));
  std::vector<std::string> again = command;
  again.emplace_back("--resume");
  ASSERT_EQ(common::run_to_end(again, folder_.path() / "output.txt", 60), 0) << output();
  EXPECT_FALSE(std::filesystem::exists(checkpoint));
  const config::Node material = config::Node::load_file((out / "material.yaml").string());
  EXPECT_NEAR(material.child("material").number("young_modulus", {}), 20e3, 100);
}

TEST_F(ProgramTest, UndeterminedParametersAreNamedNotGuessed) {
  ASSERT_EQ(run_program({"--set", "parameters.poisson_ratio={lower: 0, upper: 0.5}"}), 0)
      << output();
  EXPECT_THAT(output(),
              AllOf(HasSubstr("undetermined"), HasSubstr("The data do not determine young_modulus"),
                    HasSubstr("poisson_ratio")));
}

TEST_F(ProgramTest, AWrongPlanHasItsExitCodeAndBadDataAnother) {
  EXPECT_EQ(run_program({"--set", "recordings.0.columns.force.unit=mm"}), config::kExitCode);
  EXPECT_THAT(output(), AllOf(HasSubstr("columns.force.unit"), HasSubstr("'mN'")));
  EXPECT_EQ(run_program({"--set", "recordings.0.kind=magic"}), config::kExitCode);
  EXPECT_THAT(output(), HasSubstr("uniaxial"));
  EXPECT_EQ(run_program({"--set", "colour=red"}), config::kExitCode);
  EXPECT_EQ(run_program({"--resume"}), config::kExitCode);
  folder_.write("a.csv", "d,F\n0,0\n1,-1\n2,-2\n3,-3\n");
  EXPECT_EQ(run_program({}), 1);
  EXPECT_THAT(output(), AllOf(HasSubstr("a.csv:5"), HasSubstr("sign: -1")));
  folder_.write("a.csv", "d,F\n0,0\n1,nan\n2,2\n3,3\n");
  EXPECT_EQ(run_program({}), 1);
  EXPECT_THAT(output(), AllOf(HasSubstr("a.csv:3:F"), HasSubstr("remove the row")));
}

TEST_F(ProgramTest, HelpSuffices) {
  ASSERT_EQ(run_program({"--help"}), 0);
  EXPECT_THAT(output(), AllOf(HasSubstr("hertz"), HasSubstr("elastomer_tensile"),
                              HasSubstr("--check-gradients"), HasSubstr("kind: uniaxial")));
}

TEST_F(ProgramTest, ACheckpointIsGoneOnFromAndBelongsToItsPlan) {
  const Plan plan = folder_.plan(kPlan);
  const auto problem = make_problem(plan.jobs.front(), folder_.path());
  const std::filesystem::path file = folder_.path() / "checkpoint.json";
  Checkpoint first(file, plan.hash, false);
  EXPECT_EQ(first.start("ball", *problem), problem->start());
  const Eigen::VectorXd there = problem->start().array() + 0.5;
  first.keep("ball", *problem, there, 1, true);
  const Checkpoint again(file, plan.hash, true);
  EXPECT_LT((again.start("ball", *problem) - there).norm(), 1e-9);
  EXPECT_EQ(again.start("other", *problem), problem->start());
  EXPECT_THROW(Checkpoint(file, "another", true), std::runtime_error);
  std::ofstream(file) << "{\"plan\": 3";
  EXPECT_THROW(Checkpoint(file, plan.hash, true), std::runtime_error);
}

TEST_F(ProgramTest, VariantsAndEachMultiplyFits) {
  folder_.write("many.csv", "p,d,F\n1,0,0\n1,1,1\n1,2,3\n1,3,5\n7,0,0\n7,1,2\n7,2,5\n7,3,9\n");
  const std::vector<JobResult> results = folder_.run(
      "name: many\nrecording: {kind: hertz, geometry: {radius: 5 mm}, columns: {depth: {name: d, "
      "unit: "
      "mm}, force: {name: F}}}\nfits:\n  - {name: m, each: p, recordings: [{file: many.csv}]}\n"
      "variants:\n  - {name: Hertz}\n  - {name: linear, recording: {model: linear}}\n");
  ASSERT_EQ(results.size(), 4U);
  for (const JobResult& result : results) EXPECT_EQ(result.error, "");
  EXPECT_GT(results[1].fit.find("young_modulus")->value,
            results[0].fit.find("young_modulus")->value);
}

}  // namespace
}  // namespace palpate::fit
