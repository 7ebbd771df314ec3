// Libraries of a user's own components: which are loaded, which are rejected, and the handling of
// those that fail in the loop.

#include "rt/plugin/plugins.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <fstream>
#include <functional>

#include "tests/support/scratch_folder.hpp"
#include "tests/unit/rt/plugin/plugged_pipeline.hpp"

namespace palpate::plugin {
namespace {

TEST(Plugins, WithoutTheKeyThereAreNone) {
  EXPECT_TRUE(Plugins::load(example({}))->components().control_laws.entries().empty());
}

TEST(Plugins, ComponentsAreMadeByName) {
  Running running(
      {kUnruly, sensor("nothing"), law("nothing"), "contact=[{component: unruly_transformer}]"});
  running.run(200);
  EXPECT_EQ(running.pipeline.condition().state, pipeline::LifeCycle::kActive)
      << running.pipeline.condition().reason;
  ASSERT_EQ(running.pipeline.contacts().count, 1);
  EXPECT_NEAR(running.pipeline.contacts().contacts[0].wrench.force.norm(), 0.125 * std::sqrt(3.0),
              1e-12);
  EXPECT_NEAR(running.speed, 0.01, 1e-9);
}

TEST(Plugins, AProviderServesABuiltInLaw) {
  Running running(
      {kUnruly, sensor("nothing"), "control={provider: unruly_provider, law: proportional_twist}"});
  running.run(50);
  EXPECT_EQ(running.pipeline.condition().state, pipeline::LifeCycle::kActive);
  EXPECT_GT(running.speed, 1e-3);
}

TEST(Plugins, WhatIsNoPluginIsRefusedWithFileAndKey) {
  expect_complaint({"plugins=[{library: /no/such/file.so}]"},
                   {"plugins.0.library", "/no/such/file.so", "no such file"});
  expect_complaint({"plugins=[{library: /tmp}]"}, {"plugins.0.library", "no such file"});
  expect_complaint({library("no_plugin.so")},
                   {"plugins.0.library", "no_plugin.so", "is no plug-in of palpate",
                    "palpate_plugin_abi", "PALPATE_PLUGIN"});
  expect_complaint({"plugins=[{path: here.so}]"}, {"plugins.0.library"});
  expect_complaint({"plugins=[here.so]"}, {"plugins.0", "mapping"});
  expect_complaint({"plugins=here.so"}, {"plugins"});
  const support::ScratchFolder folder;
  const std::string text = (folder.path() / "text.so").string();
  std::ofstream(text) << "hello\n";
  expect_complaint({"plugins=[{library: " + text + "}]"},
                   {"plugins.0.library", text, "cannot be loaded"});
}

TEST(Plugins, OneOfAnotherPalpateIsNotEvenAsked) {
  expect_complaint({library("other_abi.so")},
                   {"plugins.0.library", "was built for another palpate", "palpate 9",
                    "EIGEN_MAX_ALIGN_BYTES 32, here 16", "build it"});
}

TEST(Plugins, NamesAreCheckedAtRegistration) {
  expect_complaint({library("taken.so")},
                   {"control law 'quadratic_program' has the name of a built-in one"});
  expect_complaint({library("misnamed.so")}, {"control law 'My-Law' is no name"});
  expect_complaint(
      {"plugins=[{library: " + kLibraries + "/unruly.so}, {library: " + kLibraries + "/twice.so}]"},
      {"plugins.1.library", "control law 'unruly_law' is there twice"});
  expect_complaint({"plugins=[{library: " + kLibraries + "/unruly.so}, {library: " + kLibraries +
                    "/unruly.so}]"},
                   {"plugins.1.library", "is there twice"});
  expect_complaint({library("throws.so")},
                   {"plugins.0.library", "its registration failed: there is no licence for it"});
}

TEST(Plugins, KeysAreThoseThatItDeclared) {
  expect_complaint({kUnruly, law("mischief")}, {"control.does", "'mischief'", "allowed: nothing"});
  expect_complaint({kUnruly, law("nothing", ", after: -1")},
                   {"control.after", "0", "1000000", "cycles before it"});
  expect_complaint({kUnruly, law("nothing", ", gain: 1")},
                   {"control.gain", "unknown key", "after"});
  expect_complaint({kUnruly, "control.law=no_such_law"},
                   {"control.law", "no_such_law", "quadratic_program, unruly_law"});
  expect_complaint({"control.law=unruly_law"}, {"'unruly_law' is unknown"});
}

TEST(Plugins, WhatSetUpThrowsIsReportedWithFileAndKey) {
  expect_complaint({kUnruly, sensor("fail_setup")},
                   {"sensing.0.component", "unruly_sensor: no such hardware"});
  expect_complaint({kUnruly, law("fail_setup")}, {"control.law", "unruly_law: the plug-in threw"});
}

TEST(Plugins, AFallbackMustBeOfTheSameSensor) {
  EXPECT_EQ(error_of({kUnruly, sensor("nothing", ", fallback: {component: ft_tare_only}")}), "");
  expect_complaint({kUnruly, sensor("nothing", ", fallback: {component: manual}")},
                   {"manual is of"});
}

class Unruly : public ::testing::TestWithParam<const char*> {};

TEST_P(Unruly, SensorFaultsAndTheRobotStops) {
  Running running({kUnruly, sensor(GetParam(), ", after: 60"), law("nothing")});
  running.run(50);
  ASSERT_EQ(running.pipeline.condition().state, pipeline::LifeCycle::kActive);
  ASSERT_GT(running.speed, 1e-3);
  running.run(150);
  EXPECT_EQ(running.pipeline.condition().state, pipeline::LifeCycle::kFaulted);
  EXPECT_NE(std::string(running.pipeline.condition().reason).find("the plug-in"),
            std::string::npos);
  EXPECT_EQ(running.pipeline.contacts().count, 0);
  EXPECT_EQ(running.speed, 0);
}
INSTANTIATE_TEST_SUITE_P(Kinds, Unruly,
                         ::testing::Values("throw", "throw_number", "many", "bad_source"));

TEST(Plugins, ASensorsNumbersThatAreNoneStopTheRobot) {
  Running running({kUnruly, sensor("nan", ", after: 60"), law("nothing")});
  running.run(50);
  ASSERT_GT(running.speed, 1e-3);
  running.run(150);
  EXPECT_EQ(running.pipeline.condition().state, pipeline::LifeCycle::kDegraded);
  EXPECT_EQ(running.speed, 0);
}

TEST(Plugins, ASensorThatThrowsGivesWayToItsFallback) {
  Running running(
      {kUnruly,
       sensor("throw", ", after: 60, fallback: {component: ft_tare_only, tare_samples: 10}"),
       law("nothing")});
  running.run(250);
  EXPECT_EQ(running.pipeline.condition().state, pipeline::LifeCycle::kDegraded);
  EXPECT_TRUE(running.pipeline.on_fallback());
  EXPECT_NEAR(running.speed, 0.01, 1e-9);
}

TEST(Plugins, ALawThatErrsFaultsAndSaysWhy) {
  for (const auto& [does, reason] :
       {std::pair("throw", "the plug-in threw an exception"),
        std::pair("throw_number", "the plug-in threw an exception"),
        std::pair("nan", "the command is not finite"),
        std::pair("resize", "the plug-in changed the length of an output")}) {
    Running running({kUnruly, sensor("nothing"), law(does, ", after: 60")});
    running.run(50);
    ASSERT_GT(running.speed, 1e-3) << does;
    running.run(150);
    EXPECT_EQ(running.pipeline.condition().state, pipeline::LifeCycle::kFaulted) << does;
    EXPECT_NE(std::string(running.pipeline.condition().reason).find(reason), std::string::npos)
        << does << ": " << running.pipeline.condition().reason;
    EXPECT_EQ(running.speed, 0) << does;
  }
}

TEST(Plugins, ALawThatThrowsGivesWayToItsFallback) {
  Running running(
      {kUnruly, sensor("nothing"),
       law("throw", ", after: 60, fallback: {provider: fem, law: proportional_twist}")});
  running.run(250);
  EXPECT_EQ(running.pipeline.condition().state, pipeline::LifeCycle::kDegraded);
  EXPECT_NE(std::string(running.pipeline.fallback_reason()).find("the plug-in threw"),
            std::string::npos);
  EXPECT_GT(running.speed, 1e-3);
}

TEST(Plugins, AProviderThatErrsLeavesTheRobotWhereItIs) {
  for (const char* does : {"throw", "nan"}) {
    Running running({kUnruly, sensor("nothing"),
                     std::string("control={provider: unruly_provider, after: 60, law: "
                                 "proportional_twist, does: ") +
                         does + "}"});
    running.run(50);
    ASSERT_GT(running.speed, 1e-3) << does;
    running.run(150);
    EXPECT_EQ(running.pipeline.condition().state, pipeline::LifeCycle::kFaulted) << does;
    EXPECT_EQ(running.speed, 0) << does;
  }
}

TEST(Plugins, ATransformerThatErrsIsAFault) {
  for (const char* does : {"throw", "nan", "bad_node"}) {
    Running running(
        {kUnruly, sensor("nothing"), law("nothing"),
         std::string("contact=[{component: unruly_transformer, after: 60, does: ") + does + "}]"});
    running.run(50);
    ASSERT_GT(running.speed, 1e-3) << does;
    running.run(150);
    EXPECT_EQ(running.pipeline.condition().state, pipeline::LifeCycle::kFaulted) << does;
    EXPECT_EQ(running.speed, 0) << does;
  }
}

TEST(Plugins, OneThatThrewIsAskedAgainAfterReset) {
  Running running({kUnruly, sensor("nothing"), law("throw", ", after: 60")});
  running.run(200);
  ASSERT_EQ(running.pipeline.condition().state, pipeline::LifeCycle::kFaulted);
  running.pipeline.reset();
  EXPECT_EQ(running.pipeline.condition().state, pipeline::LifeCycle::kInactive);
  running.pipeline.start();
  running.run(10);
  EXPECT_EQ(running.pipeline.condition().state, pipeline::LifeCycle::kActive);
}

TEST(Plugins, TheLibrariesStayAsTheyAreWhileTheDaemonRuns) {
  const config::Node root = example({kUnruly});
  try {
    pipeline::find_changes(root, root.changed("", "plugins: []", false, "replace"));
    FAIL();
  } catch (const config::Error& error) {
    EXPECT_NE(std::string(error.what()).find("plugins"), std::string::npos);
  }
}

double seconds_of(const std::function<void()>& call) {
  const auto begin = std::chrono::steady_clock::now();
  call();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

TEST(Plugins, OneThatHangsAtSetUpIsRefusedInTime) {
  for (const auto& [overrides, words] :
       std::vector<std::pair<std::vector<std::string>, std::vector<std::string>>>{
           {{library("hangs.so")}, {"plugins.0.library", "its registration has not returned"}},
           {{kUnruly, law("hang_setup")}, {"control.law", "unruly_law", "construction"}},
           {{kUnruly, law("hang_warm_up")}, {"control.law", "unruly_law", "has not returned"}},
           {{kUnruly, model("hang_warm_up")}, {"warm-up", "unruly_model", "has not returned"}}}) {
    EXPECT_LT(seconds_of([&] { expect_complaint(overrides, words); }), kSetupDeadline + 3);
  }
}

TEST(Plugins, OneThatFailsToWarmUpIsRefused) {
  expect_complaint({kUnruly, estimator("throw_warm_up")},
                   {"warm-up", "unruly_estimator", "cannot warm up"});
  expect_complaint({kUnruly, model("throw_warm_up")}, {"warm-up", "cannot warm up"});
  expect_complaint({kUnruly, feature("throw_warm_up")}, {"warm-up", "cannot warm up"});
}

TEST(Plugins, OneOfAnotherInterfaceIsRefused) {
  expect_complaint({library("other_interface.so")},
                   {"plugins.0.library", "plug-in interface 1, here 2"});
}

TEST(Plugins, AWatchdogClaimsAThreadInACall) {
  CallRecord record;
  const RecordCalls calls(record);
  EXPECT_EQ(record.component(), nullptr);
  const char* const name = "a component";
  {
    const InCall outer(name);
    EXPECT_EQ(record.component(), name);
    {
      const InCall inner("another");
      EXPECT_FALSE(record.claim(name));
    }
    EXPECT_EQ(record.component(), name);
  }
  EXPECT_FALSE(record.claim(name));
}

}  // namespace
}  // namespace palpate::plugin
