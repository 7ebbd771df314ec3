#pragma once

#include <string>

#include "rt/inference/model_card.hpp"
#include "rt/inference/torch_executor.hpp"
#include "tools/lab/sensor_models/sensors_baselines.hpp"

namespace palpate::sensor_models {

/// For an executor whose every answer is awaited: nothing depends on scheduling.
inference::TorchExecutorOptions patient_executor();

/// Force (n x 3, N) that the daemon's component biotac_lstm answers to each row of a fingertip's
/// track, before its contact gate. It is tared on the track's rows at rest, then gets the recording
/// from its start. Throws config::Error where it refuses the model, std::runtime_error where it
/// fails.
Eigen::MatrixXd stream_fingertip(const std::string& model, const std::string& executor,
                                 const SensorTrack& track);

/// Outward normal of the skin (n x 3, in N) at the place where the component puts the contact by a
/// network of its direction; a stand-in says a constant force. Rows before the first contact hold
/// the pad's middle. Throws the same.
Eigen::MatrixXd stream_place(const std::string& direction, const inference::ModelCard& card,
                             const FingertipFrame& frame, const std::string& executor,
                             const SensorTrack& track);

/// Contact wrench (n x 6, N and N m) that the daemon's component ft_rnnob, not tared, reports at
/// each row of a wrist's track; the loop runs at the recording's own rate, or the next multiple of
/// the model's. Where gravity was taken out of the accelerations it is put back by the orientation
/// of the moment that the (late) inertial unit felt. Throws the same.
Eigen::MatrixXd stream_wrist(const std::string& model, const std::string& executor,
                             const inference::ModelCard& card, const SensorTrack& track);

}  // namespace palpate::sensor_models
