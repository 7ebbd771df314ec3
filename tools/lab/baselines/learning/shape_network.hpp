#pragma once

#include <Eigen/Core>

#include "core/math/random.hpp"

namespace palpate::baselines {

/// Feed-forward network with one hidden layer (tanh) and linear outputs; inputs and outputs are
/// scaled to mean 0 and standard deviation 1.
struct ShapeNetwork {
  Eigen::VectorXd input_mean, input_scale;    // of each input; scales > 0
  Eigen::MatrixXd hidden;                     // hidden units x (inputs + 1), the last column a bias
  Eigen::MatrixXd output;                     // outputs x (hidden units + 1)
  Eigen::VectorXd output_mean, output_scale;  // of each output

  Eigen::Index inputs() const noexcept { return input_mean.size(); }
  Eigen::Index outputs() const noexcept { return output_mean.size(); }
  /// Throws std::invalid_argument naming the error if sizes do not match or a number is not finite.
  void check() const;

  /// `room`: workspace, as many rows as there are hidden units. Does not allocate.
  void evaluate(const Eigen::VectorXd& input, Eigen::VectorXd& room,
                Eigen::VectorXd& result) const noexcept;
};

struct ShapeTrainingOptions {
  int hidden = 20;
  int epochs = 3000;    // maximum number
  int patience = 300;   // epochs without improvement of the validation error until training stops
  double rate = 5e-3;   // learning rate of Adam (Kingma and Ba 2015)
  double decay = 1e-4;  // L2 weight decay
};

/// Samples by column. Trains on the training samples and returns the network that performed best on
/// the validation samples. Throws std::invalid_argument if sizes do not match. Allocates.
ShapeNetwork train_shape_network(const Eigen::MatrixXd& inputs, const Eigen::MatrixXd& outputs,
                                 const Eigen::MatrixXd& validation_inputs,
                                 const Eigen::MatrixXd& validation_outputs,
                                 const ShapeTrainingOptions& options, math::Random random);

}  // namespace palpate::baselines
