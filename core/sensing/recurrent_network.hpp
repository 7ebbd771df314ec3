#pragma once

#include <Eigen/Core>
#include <vector>

namespace palpate::sensing {

/// One LSTM layer (Hochreiter and Schmidhuber 1997, with forget gates). Rows are ordered input
/// gate, forget gate, candidate, output gate, `size` rows each.
struct LstmWeights {
  Eigen::MatrixXf input;   // 4 size x inputs of the layer
  Eigen::MatrixXf hidden;  // 4 size x size
  Eigen::VectorXf bias;    // 4 size

  int size() const { return static_cast<int>(hidden.cols()); }
};

/// Recurrent sensor model, evaluated one sample at a time with a state:
///   x' = x, of which the entries with unit_mask 1 are divided by sqrt(|those|^2 + unit_floor^2)
///   z = (x' - input_mean) / input_deviation
///   h = LSTM layers, in sequence, applied to z
///   y = output_mean + output_deviation * (dense * h + linear * z + offset)
/// The linear path extrapolates beyond the loads of the training, where the cells saturate. The
/// mask makes a map of directions independent of the magnitude of the inputs.
struct RecurrentWeights {
  Eigen::VectorXf unit_mask;         // length inputs, each 0 or 1
  float unit_floor = 1;              // unit of the inputs, > 0
  Eigen::VectorXf input_mean;        // length inputs
  Eigen::VectorXf input_deviation;   // length inputs, > 0
  std::vector<LstmWeights> layers;   // one or more
  Eigen::MatrixXf dense;             // outputs x size of the last layer
  Eigen::MatrixXf linear;            // outputs x inputs; zero without a linear path
  Eigen::VectorXf offset;            // length outputs
  Eigen::VectorXf output_mean;       // length outputs
  Eigen::VectorXf output_deviation;  // length outputs, > 0

  int inputs() const { return static_cast<int>(input_mean.size()); }
  int outputs() const { return static_cast<int>(output_mean.size()); }
  /// Number of state values: h of the first layer, its c, h of the second layer, ...
  int states() const;

  /// Weights of matching shapes, all zero, with deviations of one.
  static RecurrentWeights zero(int inputs, int outputs, const std::vector<int>& layer_sizes);

  /// Throws std::invalid_argument naming the first part that has a wrong shape, exceeds the limits
  /// below, is not finite, or is not positive where required.
  void check() const;

  static constexpr int kLargestInputs = 256;
  static constexpr int kLargestOutputs = 64;
  static constexpr int kLargestLayers = 8;
  static constexpr int kLargestLayerSize = 512;
};

/// Evaluates RecurrentWeights, one sample per step, without allocation. Not thread-safe.
class RecurrentNetwork {
 public:
  /// Throws as RecurrentWeights::check.
  explicit RecurrentNetwork(const RecurrentWeights& weights);

  int inputs() const noexcept { return weights_.inputs(); }
  int outputs() const noexcept { return weights_.outputs(); }
  int states() const noexcept { return states_; }
  const RecurrentWeights& weights() const noexcept { return weights_; }

  /// `input`: inputs() numbers; `state`: states() numbers, zero at the start, overwritten;
  /// `output`: outputs() numbers. None may overlap.
  void step(const float* input, float* state, float* output) noexcept;

 private:
  RecurrentWeights weights_;
  int states_;
  Eigen::VectorXf scaled_;  // length inputs
  Eigen::VectorXf gates_;   // gates of the largest layer
  Eigen::VectorXf answer_;  // length outputs
};

}  // namespace palpate::sensing
