#pragma once

#include <Eigen/Core>

#include "core/math/random.hpp"

namespace palpate::published_sensing {

/// A feed-forward network with one hidden layer (tanh) and linear outputs, its inputs and outputs
/// scaled to mean 0 and deviation 1.
struct ShapeNetwork {
  Eigen::VectorXd input_mean, input_scale;    // of each input; the scale above 0
  Eigen::MatrixXd hidden;                     // hidden units x (inputs + 1), the last column a bias
  Eigen::MatrixXd output;                     // outputs x (hidden units + 1)
  Eigen::VectorXd output_mean, output_scale;  // of each output

  Eigen::Index inputs() const noexcept { return input_mean.size(); }
  Eigen::Index outputs() const noexcept { return output_mean.size(); }
  /// Throws std::invalid_argument, saying what, where sizes do not agree or a number is not finite.
  void check() const;

  /// `room`: a column of as many rows as there are hidden units. Allocates nothing.
  void evaluate(const Eigen::VectorXd& input, Eigen::VectorXd& room,
                Eigen::VectorXd& result) const noexcept;
};

struct ShapeTrainingOptions {
  int hidden = 20;
  int epochs = 3000;    // at most
  int patience = 300;   // epochs without a better validation error until it ends
  double rate = 5e-3;   // of Adam (Kingma and Ba 2015)
  double decay = 1e-4;  // of weights, L2
};

/// Samples by column. Trains on those of `training` and keeps the network that was best on
/// `validation`. Throws std::invalid_argument where sizes do not agree. Allocates.
ShapeNetwork train_shape_network(const Eigen::MatrixXd& inputs, const Eigen::MatrixXd& outputs,
                                 const Eigen::MatrixXd& validation_inputs,
                                 const Eigen::MatrixXd& validation_outputs,
                                 const ShapeTrainingOptions& options, math::Random random);

}  // namespace palpate::published_sensing
