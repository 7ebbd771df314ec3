#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "core/sensing/payload.hpp"
#include "rt/inference/model_card.hpp"
#include "tools/recordings/plan.hpp"

namespace palpate::recordings {

enum class Part { kTraining, kValidation, kTest };

/// One recording in the form used by the network, one row per step.
struct Recording {
  std::string name;
  Eigen::VectorXd time;      // s
  Eigen::MatrixXd inputs;    // n x inputs
  Eigen::MatrixXd outputs;   // n x outputs: training targets
  Eigen::MatrixXd analytic;  // n x outputs: prediction of a rigid payload; otherwise empty
  std::vector<Part> parts;   // n
  std::vector<bool> counts;  // n: whether the row is used for training and scoring
};

struct DataFile {
  std::string file;  // as named by the plan
  std::string sha256;
};

struct DataSet {
  std::vector<Recording> recordings;
  std::vector<inference::Channel> inputs;
  std::vector<inference::Channel> outputs;
  std::vector<DataFile> files;
  // Of a wrist sensor:
  std::vector<inference::StreamDelay> delays;         // of the first recording
  std::optional<sensing::PayloadParameters> payload;  // of the training part; without bias
};

/// Reads, aligns, tares and resamples all recordings of a plan, each from the first of `folders`
/// that has it. Throws import::CsvError or std::runtime_error naming the file.
DataSet load_data(const DataPlan& plan, const std::vector<std::string>& folders);

/// Rows of one part that count, of all recordings, concatenated.
Eigen::MatrixXd gather(const DataSet& data, const std::vector<Eigen::MatrixXd>& of_recordings,
                       Part part);
std::vector<Eigen::MatrixXd> inputs_of(const DataSet& data);
std::vector<Eigen::MatrixXd> outputs_of(const DataSet& data);

}  // namespace palpate::recordings
