#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tools/log/log_reader.hpp"

namespace palpate::studies {

/// A motion of the hand in view of a camera, simulated once and then replayed by other estimators.
struct SensingRecording {
  std::filesystem::path sensors;  // log of the daemon's inputs, by the simulator's clock
  log::RunLog truth;
};

/// Settings of a recording.
struct SensingScene {
  std::filesystem::path scene;
  std::vector<std::string> scene_overrides;
  std::filesystem::path configuration;
  std::vector<std::string> daemon_overrides;
  double duration = 0;  // s; 0: that of the scene's motion
  double period = 0;    // s, between instants of the truth that are read, at least
};

/// Hash of all inputs of a recording: scene and configuration after overrides, the files that they
/// name, its duration, the simulator's program.
std::string hash_of_recording(const SensingScene& scene);

/// Simulates the scene by palpate-sim, or reuses the recording of the same hash that an earlier
/// call has left in `folder`; result.json there holds the hash. Throws RunFailed.
SensingRecording record_sensing(const SensingScene& scene, const std::filesystem::path& folder);

/// The recording that such a call has left there. Throws RunFailed if it is missing, or of another
/// hash.
SensingRecording read_recording(const SensingScene& scene, const std::filesystem::path& folder);

/// Replays the recording by palpate-replay with `overrides` of the configuration and collects its
/// log with `reader`; the program's output stays in `folder`. `patience`: s. Throws RunFailed.
void replay(const SensingScene& scene, const SensingRecording& recording,
            const std::vector<std::string>& overrides, const std::filesystem::path& folder,
            double patience, log::LogReader& reader);

}  // namespace palpate::studies
