#pragma once

#include <string>

#include "rt/inference/model_card.hpp"
#include "rt/inference/torch_executor.hpp"
#include "tools/lab/sensor_models/sensors_baselines.hpp"

namespace palpate::sensor_models {

/// For an executor whose every result is awaited: results do not depend on scheduling.
inference::TorchExecutorOptions patient_executor();

/// Force (n x 3, N) that the daemon's component biotac_lstm computes for each row of a fingertip's
/// track, before its contact gate. It is tared on the track's rows at rest, then receives the
/// recording from its start. Throws config::Error if it rejects the model, std::runtime_error if it
/// fails.
Eigen::MatrixXd stream_fingertip(const std::string& model, const std::string& executor,
                                 const SensorTrack& track);

/// Outward normal of the skin (n x 3, in N) at the contact point that the component computes with a
/// network of its direction; the force is a constant stand-in. Rows before the first contact hold
/// the pad's centre. Throws the same.
Eigen::MatrixXd stream_place(const std::string& direction, const inference::ModelCard& card,
                             const FingertipFrame& frame, const std::string& executor,
                             const SensorTrack& track);

/// Contact wrench (n x 6, N and N m) that the daemon's component ft_rnnob, untared, reports at each
/// row of a wrist's track; the loop runs at the recording's own rate, or the next multiple of the
/// model's. If gravity was removed from the accelerations it is added back with the orientation at
/// the time of the (delayed) inertial sample. Throws the same.
Eigen::MatrixXd stream_wrist(const std::string& model, const std::string& executor,
                             const inference::ModelCard& card, const SensorTrack& track);

}  // namespace palpate::sensor_models
