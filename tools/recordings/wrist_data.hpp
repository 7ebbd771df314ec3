#pragma once

#include <string>
#include <vector>

#include "core/sensing/payload.hpp"
#include "tools/recordings/data_set.hpp"
#include "tools/recordings/plan.hpp"
#include "tools/recordings/recording_table.hpp"

namespace palpate::recordings {

/// A recording of a wrist sensor with its streams aligned, one row per step of the network.
struct WristRecording {
  Eigen::VectorXd time;                        // s
  std::vector<sensing::MotionSample> samples;  // F_S as measured
  Eigen::MatrixXd inputs;                      // n x all of observer_inputs()
  std::vector<inference::StreamDelay> delays;  // delays that were removed
};

/// The columns required by load_wrist(), in its order.
std::vector<std::string> wrist_columns(const WristColumns& columns);

/// `raw` holds wrist_columns() on a uniform grid. The delays of the inertial unit (its angular rate
/// relative to that of the orientation) and of the wrench (relative to the force of a moving mass)
/// are found by cross-correlation of their high-frequency parts; then all streams are delayed to
/// match the latest one, averaged and resampled.
WristRecording load_wrist(const DataPlan& plan, const Table& raw);

/// Identifies the payload, with a bias for each recording, on training rows, and fills in the
/// inputs and outputs of data.recordings: outputs are the wrench minus the recording's bias (on
/// training rows also minus its drift, if the plan lets it drift) and, if the target is the
/// residual, minus the payload's wrench.
void finish_wrists(const DataPlan& plan, const std::vector<WristRecording>& wrists, DataSet& data);

}  // namespace palpate::recordings
