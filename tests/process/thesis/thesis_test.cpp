// palpate-evaluate thesis with real programs, on separate ports.

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <cstring>
#include <lcm/lcm-cpp.hpp>
#include <map>
#include <nlohmann/json.hpp>

#include "tests/unit/tools/lab/studies/study_folder.hpp"

namespace palpate::evaluate {
namespace {

constexpr const char* kPlan = R"(octree_resolution: 0.01
applications:
  - name: short pull
    kind: control
    scene: sim/scenes/bar_long_soft_control.yaml
    configuration: rt/config/examples/bar_long_soft.yaml
    methods: [pose-driven]
    mismatch: [none]
    seeds: [1]
    duration: 1.5
    target: {feature: point, rest_points: [[0.25, 0.03, 0.06]], displacement: [0, 0, 0.01]}
)";

class StudyProcess : public testing::Test {
 protected:
  int run(const std::string& output, const std::string& options = "") const {
    const std::string command = std::string(PALPATE_BIN_DIR) + "/palpate-evaluate thesis --plan '" +
                                folder_.file("plan.yaml").string() + "' --output '" +
                                folder_.file(output).string() + "' " + options + " > '" +
                                folder_.file(output + ".txt").string() + "' 2>&1";
    return WEXITSTATUS(std::system(command.c_str()));
  }
  nlohmann::json result(const std::string& output) const {
    return nlohmann::json::parse(
        folder_.read(output + "/short_pull_pose_driven_none_1/result.json"));
  }
  std::filesystem::path job(const std::string& output) const {
    return folder_.file(output + "/short_pull_pose_driven_none_1");
  }
  nlohmann::json json_of(const std::string& output, const std::string& name) const {
    return nlohmann::json::parse(std::ifstream(job(output) / name));
  }
  /// Lost messages between the programs: the run is then a different one.
  std::int64_t lost_between_programs(const std::string& output) const {
    std::int64_t lost = json_of(output, "simulator.json")["commands_lost"];
    const nlohmann::json daemon = json_of(output, "palpated.json");
    for (const auto& input : daemon["inputs"]) lost += input["lost"].get<std::int64_t>();
    return lost;
  }
  /// The job, with its logs; repeated if a busy machine has lost a message between programs.
  nlohmann::json run_whole(const std::string& output) const {
    for (int i = 0; i < 10; ++i) {
      std::filesystem::remove_all(folder_.file(output));
      EXPECT_EQ(run(output, "--keep-logs"), 0) << folder_.read(output + ".txt");
      if (lost_between_programs(output) == 0) return result(output);
    }
    ADD_FAILURE() << "messages were lost in every run";
    return result(output);
  }

  /// The content after the header of each message of a channel, by its sequence number.
  static std::map<std::int32_t, std::string> messages(const std::filesystem::path& log,
                                                      const std::string& channel) {
    constexpr int kSeq = 16, kHeader = 28;
    std::map<std::int32_t, std::string> found;
    lcm::LogFile file(log.string(), "r");
    while (const lcm::LogEvent* event = file.readNextEvent()) {
      if (event->channel != channel || event->datalen < kHeader) continue;
      const char* bytes = static_cast<const char*>(event->data);
      std::uint32_t seq = 0;
      std::memcpy(&seq, bytes + kSeq, sizeof seq);
      found[static_cast<std::int32_t>(ntohl(seq))] = {bytes + kHeader, bytes + event->datalen};
    }
    return found;
  }
  /// Bit by bit, of everything that both logs contain, which must be nearly everything.
  void expect_same(const std::string& log, const std::string& channel, std::size_t sent) const {
    const auto a = messages(job("a") / log, channel), b = messages(job("b") / log, channel);
    std::size_t both = 0, different = 0;
    for (const auto& [seq, bytes] : a) {
      const auto other = b.find(seq);
      if (other == b.end()) continue;
      ++both;
      different += other->second == bytes ? 0 : 1;
    }
    EXPECT_EQ(different, 0u) << channel << " of " << both;
    EXPECT_GT(both, sent - sent / 50) << channel;
  }
  studies::StudyFolder folder_;
};

TEST_F(StudyProcess, RunsAJobOnceAndGivesTheSameTwice) {
  folder_.write("plan.yaml", kPlan);
  const nlohmann::json first = run_whole("a");
  EXPECT_EQ(first["simulator"]["mode"], "lock-step");
  EXPECT_EQ(first["simulator"]["ticks"], 1500);
  // The pull has begun, towards its target.
  EXPECT_LT(first["score"]["feature"]["error_mm"], first["score"]["feature"]["start_error_mm"]);
  EXPECT_GT(first["states"][0]["octree_truth_in_estimate"], 0.5);
  EXPECT_NE(folder_.read("a/report.html").find("short pull"), std::string::npos);

  ASSERT_EQ(run("a"), 0);
  EXPECT_NE(folder_.read("a.txt").find("0 jobs run, 1 kept"), std::string::npos)
      << folder_.read("a.txt");
  run_whole("b");
  for (const char* channel : {"FEATURE", "ESTIMATE", "CONTACTS", "TWIST_COMMAND", "FT_WRENCH"})
    expect_same("control.log", channel, 1500);
  for (const char* channel : {"SHAPE", "TRUTH_SHAPE"})
    expect_same("housekeeping.log", channel, 149);
}

TEST_F(StudyProcess, AJobThatFailsIsExitCodeOne) {
  std::string plan = kPlan;
  const std::string good = "duration: 1.5";
  folder_.write("plan.yaml", plan.replace(plan.find(good), good.size(),
                                          "duration: 1.5\n    states: [{name: never, time: 1.5}]"));
  EXPECT_EQ(run("a"), 1) << folder_.read("a.txt");
  EXPECT_NE(folder_.read("a.txt").find("does not reach the state"), std::string::npos)
      << folder_.read("a.txt");
  EXPECT_EQ(run("a", "--list"), 0);
  EXPECT_NE(folder_.read("a.txt").find("1 jobs"), std::string::npos);
}

TEST_F(StudyProcess, AWrongPlanIsAConfigurationError) {
  folder_.write("plan.yaml", "octree_resolution: 0.01\n");
  EXPECT_EQ(run("a"), 78);
  EXPECT_NE(folder_.read("a.txt").find("applications"), std::string::npos);
}

}  // namespace
}  // namespace palpate::evaluate
