// The chain of palpate-evaluate observer with real programs: recording, palpate-train, the daemon
// in palpate-replay, scores; and the same contacts with either executor.

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tools/lab/sensor_models/observer_score.hpp"

namespace palpate::evaluate {
namespace {

namespace fs = std::filesystem;

const std::string kBin = PALPATE_BIN_DIR;
const std::string kConfiguration = PALPATE_SOURCE_DIR "/rt/config/examples/payload_arm_rnnob.yaml";

class ObserverProcess : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("palpate_observer_process_" + std::to_string(getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  /// Runs a program of palpate; its output is shown if it fails.
  int run(const std::string& command) const {
    const fs::path output = folder_ / "output.txt";
    const int code = WEXITSTATUS(
        std::system((kBin + "/" + command + " > '" + output.string() + "' 2>&1").c_str()));
    std::ifstream text(output);
    printed_.assign(std::istreambuf_iterator<char>(text), {});
    return code;
  }

  sensor_models::ForceSeries contacts(const std::string& executor) const {
    const fs::path log = folder_ / (executor + ".log");
    EXPECT_EQ(run("palpate-replay '" + (folder_ / "logs/rotation_y.control.log").string() +
                  "' --config '" + kConfiguration + "' --start --output '" + log.string() +
                  "' --set sensing.0.model_file='" + (folder_ / "models/ft_rnnob.pt").string() +
                  "' --set sensing.0.executor=" + executor),
              0)
        << printed_;
    return sensor_models::read_wrist_contacts(log, 2);
  }

  fs::path folder_;
  mutable std::string printed_;
};

TEST_F(ObserverProcess, LearnsAndIsNoWorseThanNewtonAndEuler) {
  const fs::path json = folder_ / "result.json";
  // Exit code 1 would mean a missed bound, which is possible after so little training.
  const int code =
      run("palpate-evaluate observer --output '" + folder_.string() + "' --json '" + json.string() +
          "' --iterations 20 --recordings 1 --longest 12 --motions rotation_y --models "
          "newton_euler newton_euler_smooth ft_rnnob");
  ASSERT_LE(code, 1) << printed_;
  ASSERT_TRUE(fs::exists(json)) << printed_;
  const nlohmann::json result = nlohmann::json::parse(std::ifstream(json));
  EXPECT_NEAR(result["payload_mass_kg"].get<double>(), 4.8, 0.1);
  ASSERT_EQ(result["runs"].size(), 3u);
  const auto rms = [&result](int i) { return result["runs"][i]["force_rms_n"].get<double>(); };
  ASSERT_EQ(result["runs"][2]["model"], "ft_rnnob");
  EXPECT_GT(rms(2), 0.01) << "the cables alone leave more";
  EXPECT_LT(rms(2), rms(0));
  EXPECT_LT(rms(2), 1.1 * rms(1));
  EXPECT_LT(rms(2), 0.02 * result["payload_weight_n"].get<double>());
  EXPECT_TRUE(fs::exists(folder_ / "observer.csv"));

  // The daemon's output is the same with libtorch's kernel and with palpate's own.
  const sensor_models::ForceSeries compiled = contacts("compiled"), torch = contacts("torch");
  ASSERT_EQ(compiled.time, torch.time);
  ASSERT_GT(compiled.time.size(), 5000u);
  EXPECT_LT((compiled.force - torch.force).cwiseAbs().maxCoeff(), 1e-5);
  EXPECT_LT((compiled.torque - torch.torque).cwiseAbs().maxCoeff(), 1e-5);
  EXPECT_GT(compiled.force.cwiseAbs().maxCoeff(), 0.01);
}

}  // namespace
}  // namespace palpate::evaluate
