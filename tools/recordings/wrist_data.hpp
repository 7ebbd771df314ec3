#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/sensing/payload.hpp"
#include "tools/recordings/data_set.hpp"
#include "tools/recordings/plan.hpp"
#include "tools/recordings/recording_table.hpp"

namespace palpate::recordings {

struct DelayFit {
  double seconds = 0;      // lag of `signal` behind `reference`; negative: it leads
  double correlation = 0;  // of the two at that delay, 0 to 1
};

/// Delay at which the cross-correlation of two recordings of the same motion is largest. Both are n
/// x channels, sampled at `rate`; means are removed, channels are summed. Interpolated between
/// samples by a parabola through the three largest values. Throws std::invalid_argument if they
/// differ in size or are shorter than four times `largest` (s).
DelayFit identify_delay(const Eigen::MatrixXd& reference, const Eigen::MatrixXd& signal,
                        double rate, double largest);

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
