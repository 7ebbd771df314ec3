#pragma once

#include <string>
#include <vector>

#include "core/sensing/payload.hpp"
#include "tools/recordings/data_set.hpp"
#include "tools/recordings/plan.hpp"
#include "tools/recordings/recording_table.hpp"

namespace palpate::recordings {

/// A recording of a wrist sensor with its streams aligned, a row a step of the network.
struct WristRecording {
  Eigen::VectorXd time;                        // s
  std::vector<sensing::MotionSample> samples;  // F_S as measured
  Eigen::MatrixXd inputs;                      // n x all of observer_inputs()
  std::vector<inference::StreamDelay> delays;  // that were taken out
};

/// The columns that load_wrist() wants, in its order.
std::vector<std::string> wrist_columns(const WristColumns& columns);

/// `raw` holds wrist_columns() on a uniform grid. The delays of the inertial unit (its rate against
/// that of the orientation) and of the wrench (against the force that a moving weight would give)
/// come from cross-correlation of what is quick in them; then all streams are delayed as much as
/// the latest one is, averaged and resampled.
WristRecording load_wrist(const DataPlan& plan, const Table& raw);

/// Identifies the payload, with a bias for each recording, on training rows, and fills in the
/// inputs and outputs of data.recordings: outputs are the wrench less the recording's bias (on
/// training rows also less its drift, where the plan lets it drift) and, where the target is the
/// residual, less what the payload explains.
void finish_wrists(const DataPlan& plan, const std::vector<WristRecording>& wrists, DataSet& data);

}  // namespace palpate::recordings
