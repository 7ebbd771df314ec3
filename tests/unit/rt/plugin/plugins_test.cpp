// Libraries of a user's own components: which are loaded, which are rejected, and the handling of
// those that fail in the loop.

#include "rt/plugin/plugins.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <fstream>
#include <functional>
#include <iterator>
#include <thread>

#include "rt/plugin/supervision.hpp"
#include "tests/support/scratch_folder.hpp"
#include "tests/unit/rt/plugin/plugged_pipeline.hpp"

namespace palpate::plugin {
namespace {

const std::string kLibraries = PALPATE_TEST_PLUGINS;

std::string library(const std::string& name) {
  return "plugins=[{library: " + kLibraries + "/" + name + "}]";
}

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
  expect_complaint({library("other_version.so")},
                   {"plugins.0.library", "was built for another palpate", "palpate 9", "build it"});
  expect_complaint({library("other_interface.so")},
                   {"plugins.0.library", "plug-in interface 1, here 9"});
}

TEST(Plugins, OneOfAnotherCompilerIsRefused) {
  expect_complaint(
      {library("other_compiler.so")},
      {"plugins.0.library", "C++ ABI 1011, here " + std::to_string(__GXX_ABI_VERSION)});
  expect_complaint({library("other_strings.so")},
                   {"plugins.0.library", "kind of std::string 0, here 1"});
}

TEST(Plugins, OneThatAlignsOrAllocatesOtherwiseIsRefused) {
  expect_complaint({library("other_alignment.so")},
                   {"plugins.0.library", "EIGEN_MAX_ALIGN_BYTES 32, here 16"});
  // The host has one of both, by whether it is compiled with AVX.
  const std::string name =
      EIGEN_MALLOC_ALREADY_ALIGNED ? "malloc_of_eigen.so" : "malloc_of_system.so";
  const std::string theirs = std::to_string(1 - EIGEN_MALLOC_ALREADY_ALIGNED),
                    here = std::to_string(EIGEN_MALLOC_ALREADY_ALIGNED);
  expect_complaint({library(name)}, {"plugins.0.library",
                                     "EIGEN_MALLOC_ALREADY_ALIGNED " + theirs + ", here " + here});
}

TEST(Plugins, NamesAreCheckedAtRegistration) {
  expect_complaint({library("taken.so")},
                   {"control law 'quadratic_program' has the name of a built-in one"});
  expect_complaint({library("misnamed.so")}, {"control law 'My-Law' is no name"});
  expect_complaint(
      {"plugins=[{library: palpate-unruly.so}, {library: " + kLibraries + "/twice.so}]"},
      {"plugins.1.library", "control law 'unruly_law' is there twice"});
  expect_complaint({"plugins=[{library: palpate-unruly.so}, {library: palpate-unruly.so}]"},
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
                   {"control.law", "no_such_law", "guarded_motion, unruly_law"});
  expect_complaint({"control.law=unruly_law"}, {"'unruly_law' is unknown"});
}

TEST(Plugins, WhatSetUpThrowsIsReportedWithFileAndKey) {
  for (const unruly::Slot& slot : kSlots)
    expect_complaint({kUnruly, slot.configured("fail_setup", "")},
                     {slot.component, "no such hardware"});
  expect_complaint({kUnruly, sensor("fail_setup")}, {"sensing.0.component"});
  expect_complaint({kUnruly, law("throw_number_warm_up")},
                   {"control.law", "unruly_law: the plug-in threw"});
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

/// Whether it is refused with these words within five seconds and `allowance`; in a process of its
/// own, so that several can be waited for at a time, and no abandoned thread is left.
pid_t refuse_in_process(const std::vector<std::string>& overrides,
                        const std::vector<std::string>& words, double allowance) {
  const pid_t child = fork();
  if (child != 0) return child;
  const double time = seconds_of([&] { expect_complaint(overrides, words); });
  EXPECT_LT(time, 5 + allowance) << overrides.back();
  _exit(testing::Test::HasFailure() ? 1 : 0);
}

TEST(Plugins, OneThatHangsAtSetUpIsRefusedWithinFiveSeconds) {
  const double sound = seconds_of([] { EXPECT_EQ(error_of({kUnruly, law("nothing")}), ""); });
  // All of them at a time take as many times as long to be set up where there is one processor.
  const double allowance = 2 * sound * static_cast<double>(2 * std::size(kSlots) + 1);
  std::vector<pid_t> children{
      refuse_in_process({library("hangs.so")},
                        {"plugins.0.library", "its registration has not returned"}, allowance)};
  for (const unruly::Slot& slot : kSlots)
    for (const char* does : {"hang_setup", "hang_warm_up"})
      children.push_back(refuse_in_process({kUnruly, slot.configured(does, "")},
                                           {slot.component, "has not returned within 4 s"},
                                           allowance));
  for (const pid_t child : children) {
    int status = 1;
    waitpid(child, &status, 0);
    EXPECT_EQ(status, 0);
  }
}

TEST(Plugins, OneThatFailsToWarmUpIsRefused) {
  for (const unruly::Slot& slot : kSlots)
    expect_complaint({kUnruly, slot.configured("throw_warm_up", "")},
                     {slot.component, "cannot warm up"});
  expect_complaint({kUnruly, estimator("throw_warm_up")}, {"warm-up"});
  expect_complaint({kUnruly, model("throw_warm_up")}, {"warm-up"});
}

/// A law that reads the feature a second after it was refused, which the preset asan checks.
TEST(Plugins, WhatAnAbandonedThreadUsesStaysAlive) {
  const int before = abandoned_calls();
  expect_complaint({kUnruly, law("slow_warm_up")}, {"control.law", "has not returned"});
  EXPECT_EQ(abandoned_calls(), before + 1);
  std::this_thread::sleep_for(std::chrono::milliseconds(1500));
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
