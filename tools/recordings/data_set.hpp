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

/// One recording as the network sees it, a row a step.
struct Recording {
  std::string name;
  Eigen::VectorXd time;      // s
  Eigen::MatrixXd inputs;    // n x inputs
  Eigen::MatrixXd outputs;   // n x outputs: what is to be learned
  Eigen::MatrixXd analytic;  // n x outputs: what a rigid payload says of them; else empty
  std::vector<Part> parts;   // n
  std::vector<bool> counts;  // n: whether the row is learned and scored
};

struct DataFile {
  std::string file;  // as the plan names it
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

/// Rows of one part that count, of all recordings, one below the other.
Eigen::MatrixXd gather(const DataSet& data, const std::vector<Eigen::MatrixXd>& of_recordings,
                       Part part);
std::vector<Eigen::MatrixXd> inputs_of(const DataSet& data);
std::vector<Eigen::MatrixXd> outputs_of(const DataSet& data);

}  // namespace palpate::recordings
