// The daemon has no access to the simulator's ground truth: in every configuration it subscribes to
// none of these channels, and none of its source files names one.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

#include "rt/daemon/daemon.hpp"
#include "rt/daemon/stepped_clock.hpp"

namespace palpate::daemon {
namespace {

namespace fs = std::filesystem;
const fs::path kSource = PALPATE_SOURCE_DIR;

/// Records the names of all subscribed channels.
class RecordingBus : public bus::MessageBus {
 public:
  bus::Subscription& subscribe(const std::string& channel, int encoded_size,
                               std::int64_t fingerprint, int depth) override {
    subscriptions_.push_back(
        std::make_unique<bus::Subscription>(channel, encoded_size, fingerprint, depth));
    return *subscriptions_.back();
  }
  void start() override {}
  void start_without_thread() override {}
  bool receive(std::int64_t) noexcept override { return false; }
  void stop() noexcept override {}
  bool publish(const char*, const void*, int) noexcept override { return true; }

  std::set<std::string> channels() const {
    std::set<std::string> names;
    for (const auto& subscription : subscriptions_) names.insert(subscription->channel());
    return names;
  }

 private:
  std::vector<std::unique_ptr<bus::Subscription>> subscriptions_;
};

bool mentions_truth(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return text.find("TRUTH_") != std::string::npos;
}

std::string text_of(const fs::path& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

/// Files below `folder` that name a channel or a type of ground truth.
std::vector<std::string> culprits(const fs::path& folder, int& scanned) {
  std::vector<std::string> found;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    ++scanned;
    if (entry.path().filename() == "scene.json") continue;  // schema of the simulator's scenes
    if (mentions_truth(text_of(entry.path()))) found.push_back(entry.path().string());
  }
  return found;
}

std::vector<std::string> examples() {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(kSource / "rt/config/examples"))
    if (entry.path().extension() == ".yaml") names.push_back(entry.path().stem().string());
  std::sort(names.begin(), names.end());
  return names;
}

/// Without sensor models that are not in the tree.
std::vector<std::string> overrides_for(const fs::path& example) {
  return config::Node::load_file(example).list("sensing")[0].has("model_file")
             ? std::vector<std::string>{"sensing=[]"}
             : std::vector<std::string>{};
}

class EveryConfiguration : public ::testing::TestWithParam<std::string> {};

TEST_P(EveryConfiguration, SubscribesToNoTruth) {
  const fs::path file = kSource / "rt/config/examples" / (GetParam() + ".yaml");
  const config::Node root = config::Node::load_file(file, overrides_for(file));
  RecordingBus control, housekeeping;
  Daemon daemon(root, control, housekeeping, Mode::kDeterministic, 1);
  SteppedClock clock(control, 1);

  const std::set<std::string> expected = {"FT_WRENCH",     "IMU",
                                          "ROBOT_STATE",   "HAND_STATE",
                                          "MANUAL_FORCE",  "BIOTAC_0",
                                          "BIOTAC_1",      "BIOTAC_2",
                                          "BIOTAC_3",      "BIOTAC_4",
                                          "SIM_TICK",      "COMPONENT_COMMAND",
                                          "SHAPE_TARGET",  "SHAPE_OBSERVATION",
                                          "TOUCH_REQUEST", "FINGERTIP_0",
                                          "FINGERTIP_4"};
  const std::set<std::string> heard = control.channels();
  EXPECT_TRUE(std::includes(heard.begin(), heard.end(), expected.begin(), expected.end()));
  for (const RecordingBus* bus : {&control, &housekeeping}) {
    for (const std::string& channel : bus->channels())
      EXPECT_FALSE(mentions_truth(channel)) << channel;
  }
}

INSTANTIATE_TEST_SUITE_P(Example, EveryConfiguration, ::testing::ValuesIn(examples()),
                         [](const auto& tested) { return tested.param; });

TEST(Subscriptions, NoSourceOfTheDaemonNamesTruth) {
  int scanned = 0;
  for (const char* folder : {"rt", "core"}) {
    for (const std::string& file : culprits(kSource / folder, scanned))
      ADD_FAILURE() << file << " names a channel or type of truth";
  }
  EXPECT_GT(scanned, 100);
}

TEST(Subscriptions, TheScanFindsWhatItLooksFor) {
  EXPECT_TRUE(mentions_truth("TRUTH_SHAPE"));
  EXPECT_TRUE(mentions_truth("#include <palpate/truth_contact_t.hpp>"));
  EXPECT_FALSE(mentions_truth("the truth of it"));
  int scanned = 0;
  EXPECT_FALSE(culprits(kSource / "sim/scenes", scanned).empty()) << "who publishes it names it";
}

}  // namespace
}  // namespace palpate::daemon
