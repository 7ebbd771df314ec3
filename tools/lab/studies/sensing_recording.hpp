#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tools/log/log_reader.hpp"

namespace palpate::studies {

/// A motion of the hand before a camera, simulated once and then replayed by other estimators.
struct SensingRecording {
  std::filesystem::path sensors;  // log of what the daemon was told, by the simulator's clock
  log::RunLog truth;
};

/// What is recorded.
struct SensingScene {
  std::filesystem::path scene;
  std::vector<std::string> scene_overrides;
  std::filesystem::path configuration;
  std::vector<std::string> daemon_overrides;
  double duration = 0;  // s; 0: that of the scene's motion
};

/// Hash of all that a recording depends on: scene and configuration after overrides, the files that
/// they name, its duration, the simulator's program.
std::string hash_of_recording(const SensingScene& scene);

/// Simulates the scene in lock-step, or takes what an earlier call has left in `folder` of the same
/// hash; result.json there holds it. Throws RunFailed.
SensingRecording record_sensing(const SensingScene& scene, const std::filesystem::path& folder);

/// What such a call has left there. Throws RunFailed where it is missing, or of another hash.
SensingRecording read_recording(const SensingScene& scene, const std::filesystem::path& folder);

/// The replay as a command: `overrides` of the configuration, log to `output`.
std::vector<std::string> replay_command(const SensingScene& scene,
                                        const SensingRecording& recording,
                                        const std::vector<std::string>& overrides,
                                        const std::filesystem::path& output);

}  // namespace palpate::studies
