#pragma once

#include <Eigen/Core>
#include <vector>

namespace palpate::sensing {

/// One layer of long short-term memory cells (Hochreiter and Schmidhuber 1997, with forget gates).
/// Rows stand in the order input gate, forget gate, candidate, output gate, `size` rows each.
struct LstmWeights {
  Eigen::MatrixXf input;   // 4 size x inputs of the layer
  Eigen::MatrixXf hidden;  // 4 size x size
  Eigen::VectorXf bias;    // 4 size

  int size() const { return static_cast<int>(hidden.cols()); }
};

/// A sensor model that takes one sample at a time and carries its state:
///   x' = x, of which the entries with unit_mask 1 are divided by sqrt(|those|^2 + unit_floor^2)
///   z = (x' - input_mean) / input_deviation
///   h = LSTM layers, one behind the other, of z
///   y = output_mean + output_deviation * (dense * h + linear * z + offset)
/// The linear path goes on growing where the cells saturate, which is beyond the loads of the
/// training. The mask makes a map of directions independent of how strong the inputs are.
struct RecurrentWeights {
  Eigen::VectorXf unit_mask;         // inputs, each 0 or 1
  float unit_floor = 1;              // unit of the inputs, above 0
  Eigen::VectorXf input_mean;        // inputs
  Eigen::VectorXf input_deviation;   // inputs, above 0
  std::vector<LstmWeights> layers;   // one or more
  Eigen::MatrixXf dense;             // outputs x size of the last layer
  Eigen::MatrixXf linear;            // outputs x inputs; zero where there is no such path
  Eigen::VectorXf offset;            // outputs
  Eigen::VectorXf output_mean;       // outputs
  Eigen::VectorXf output_deviation;  // outputs, above 0

  int inputs() const { return static_cast<int>(input_mean.size()); }
  int outputs() const { return static_cast<int>(output_mean.size()); }
  /// Hidden and cell value of every cell: h of the first layer, its c, h of the second, ...
  int states() const;

  /// Weights of the right shapes, all zero, with deviations of one.
  static RecurrentWeights zero(int inputs, int outputs, const std::vector<int>& layer_sizes);

  /// Throws std::invalid_argument naming the first part that has a wrong shape, is beyond the
  /// limits below, is not finite, or is not above zero where it must be.
  void check() const;

  static constexpr int kLargestInputs = 256;
  static constexpr int kLargestOutputs = 64;
  static constexpr int kLargestLayers = 8;
  static constexpr int kLargestLayerSize = 512;
};

/// Runs RecurrentWeights, one sample a step, without allocation. Not for two threads at once.
class RecurrentNetwork {
 public:
  /// Throws as RecurrentWeights::check.
  explicit RecurrentNetwork(const RecurrentWeights& weights);

  int inputs() const noexcept { return weights_.inputs(); }
  int outputs() const noexcept { return weights_.outputs(); }
  int states() const noexcept { return states_; }
  const RecurrentWeights& weights() const noexcept { return weights_; }

  /// `input` of inputs(), `state` of states() (zero at the start; overwritten), `output` of
  /// outputs() numbers, none of which may overlap.
  void step(const float* input, float* state, float* output) noexcept;

 private:
  RecurrentWeights weights_;
  int states_;
  Eigen::VectorXf scaled_;  // inputs
  Eigen::VectorXf gates_;   // of the largest layer
  Eigen::VectorXf answer_;  // outputs
};

}  // namespace palpate::sensing
