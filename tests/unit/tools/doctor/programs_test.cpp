#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/unit/tools/doctor/tree.hpp"
#include "tools/doctor/finding.hpp"

namespace palpate::doctor {
namespace {

using Programs = Tree;
const std::string kExamples = std::string(PALPATE_SOURCE_DIR) + "/rt/config/examples";

TEST_F(Programs, VersionsOfLcm) {
  expect("lcm", Verdict::kOk, "1.3.1+repack1-3");
  put("var/lib/dpkg/status", "Package: liblcm1\nStatus: install ok installed\nVersion: 9.0-1\n\n");
  expect("lcm", Verdict::kWarn, "9.0-1");
  put("var/lib/dpkg/status",
      "Package: liblcm1\nStatus: deinstall ok config-files\nVersion: 1.3.1-1\n\n"
      "Package: other\nStatus: install ok installed\nVersion: 1.3.1-1\n\n");
  expect("lcm", Verdict::kFail, "not installed");
  put("usr/local/lib/liblcm.so.1", "");
  expect("lcm", Verdict::kOk, "/usr/local/lib/liblcm.so.1");
}

#ifdef PALPATE_SUITESPARSE
TEST_F(Programs, BlasWithThreadsWithoutLocksOrSlow) {
  const std::string chosen = "etc/alternatives/libblas.so.3-x86_64-linux-gnu";
  const auto choose = [&](const std::string& which) {
    put(kBlas + which + "/libblas.so.3", "");
    link(chosen, "/" + kBlas + which + "/libblas.so.3");
  };
  expect("blas", Verdict::kOk, "openblas-pthread");
  for (const char* other : {"openblas-serial", "openblas-openmp", "blis-pthread"}) {
    choose(other);
    expect("blas", Verdict::kFail, other);
  }
  choose("blas");
  expect("blas", Verdict::kWarn, "blas/libblas.so.3");
  EXPECT_NE(finding("blas").remedy.find("--set libblas.so.3-x86_64-linux-gnu /usr/lib/"),
            std::string::npos);
  remove(kBlas + "libblas.so.3");
  expect("blas", Verdict::kFail, "not installed");
}
#endif

TEST_F(Programs, EachThingThatTheSpyNeeds) {
  expect("spy", Verdict::kOk, "Java 17.0.15");
  remove("opt/palpate-spy.jar");
  expect("spy", Verdict::kWarn, "/opt/palpate-spy.jar is missing");
  remove("usr/share/java/jchart2d.jar");
  expect("spy", Verdict::kWarn, "jchart2d.jar is missing");
  remove("usr/share/java/lcm.jar");
  expect("spy", Verdict::kWarn, "lcm.jar is missing");
  remove("usr/lib/jvm/java-17/lib/libawt_xawt.so");
  expect("spy", Verdict::kWarn, "headless");
  remove("etc/alternatives/java");
  expect("spy", Verdict::kWarn, "not installed");
  link("usr/bin/java", "java");  // leads to itself
  expect("spy", Verdict::kWarn, "not installed");
}

TEST(Disk, RoomForLogs) {
  const auto verdict = [](double megabytes) {
    Needs needs;
    needs.record_folder = "/logs";
    return check_disk(needs, [=](const std::string& folder) {
      EXPECT_EQ(folder, "/logs");
      return static_cast<std::int64_t>(megabytes * 1e6);
    })[0];
  };
  EXPECT_EQ(verdict(50000).verdict, Verdict::kOk);
  EXPECT_EQ(verdict(1000).verdict, Verdict::kWarn);
  EXPECT_EQ(verdict(100).verdict, Verdict::kFail);
  EXPECT_NE(verdict(100).found.find("100 MB free in /logs"), std::string::npos);
  Needs nowhere;
  nowhere.record_folder = "/no/such/folder";
  EXPECT_EQ(check_disk(nowhere, record::free_space_of_system)[0].verdict, Verdict::kFail);
}

TEST(Configuration, OneThatPalpatedTakesIsWell) {
  const Findings findings = check_configuration(kExamples + "/bar_long_soft.yaml", {});
  ASSERT_FALSE(findings.empty());
  EXPECT_EQ(findings[0].verdict, Verdict::kOk) << findings[0].found;
  EXPECT_NE(findings[0].found.find("189 nodes"), std::string::npos) << findings[0].found;
}

TEST(Configuration, ABoxBetweenRowsOfNodesIsAWarning) {
  const Findings findings = check_configuration(kExamples + "/bar_long_soft.yaml",
                                                {"object.grasp_box.lower=[0.45, 0.01, 0]"});
  ASSERT_EQ(findings.size(), 2u);
  EXPECT_EQ(findings[1].verdict, Verdict::kWarn);
  EXPECT_NE(findings[1].found.find("y = 0.01 m"), std::string::npos) << findings[1].found;
}

TEST(Configuration, FilesThatCannotBeReadAreNamed) {
  const std::string example = kExamples + "/bar_long_soft.yaml";
  const auto failure = [&](const std::string& override_) {
    const Findings findings = check_configuration(example, {override_});
    EXPECT_EQ(findings.size(), 1u);
    EXPECT_EQ(findings[0].verdict, Verdict::kFail);
    return findings[0].found;
  };
  EXPECT_NE(failure("object.mesh={file: nowhere.msh}").find("nowhere.msh"), std::string::npos)
      << failure("object.mesh={file: nowhere.msh}");
  EXPECT_NE(failure("loop.no_such_key=1").find("no_such_key"), std::string::npos);
  EXPECT_NE(failure("loop.cpu=-7").find("loop.cpu"), std::string::npos);
  EXPECT_NE(failure("bus.control=udpm://1.2.3.4:5").find("1.2.3.4"), std::string::npos);
  EXPECT_NE(check_configuration("/no/such.yaml", {})[0].found.find("/no/such.yaml"),
            std::string::npos);
}

TEST(Configuration, SaysWhatItNeeds) {
  const Needs needs = needs_of(config::Node::from_text(
      "loop: {fifo_priority: 71, cpu: 3, lock_memory: false}\n"
      "bus: {control: 'udpm://239.1.1.1:1111?ttl=1', housekeeping: 'udpm://239.1.1.2:1112'}\n"
      "record: {folder: /logs}\n"));
  EXPECT_EQ(needs.fifo_priority, 71);
  EXPECT_EQ(needs.cpu, 3);
  EXPECT_FALSE(needs.lock_memory);
  EXPECT_EQ(needs.control.group(), "239.1.1.1:1111");
  EXPECT_EQ(needs.housekeeping.port, 1112);
  EXPECT_EQ(needs.record_folder, "/logs");
}

TEST(Report, PrintsVerdictsReasonsAndRemedies) {
  const Findings findings = {ok("one", "fine"), warn("two", "so so", "it hurts", "sudo x\nsudo y"),
                             fail("three", "bad", "it kills", "sudo z")};
  EXPECT_EQ(worst(findings), Verdict::kFail);
  EXPECT_EQ(worst({findings[0], findings[1]}), Verdict::kWarn);
  EXPECT_EQ(worst({}), Verdict::kOk);
  std::ostringstream text;
  print(findings, false, false, text);
  EXPECT_NE(text.str().find("warn  two"), std::string::npos) << text.str();
  EXPECT_NE(text.str().find(": sudo y"), std::string::npos);
  EXPECT_EQ(text.str().find('\x1b'), std::string::npos);
  std::ostringstream bad;
  print(findings, true, true, bad);
  EXPECT_EQ(bad.str().find("fine"), std::string::npos);
  EXPECT_NE(bad.str().find('\x1b'), std::string::npos);
  const nlohmann::json json = to_json(findings);
  EXPECT_EQ(json["verdict"], "fail");
  EXPECT_EQ(json["findings"][1]["remedy"], "sudo x\nsudo y");
}

}  // namespace
}  // namespace palpate::doctor
