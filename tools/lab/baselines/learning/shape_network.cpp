#include "tools/lab/baselines/learning/shape_network.hpp"

#include <cmath>
#include <stdexcept>

namespace palpate::baselines {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Columns (x - mean) / scale, with a row of ones below.
MatrixXd scaled(const MatrixXd& x, const VectorXd& mean, const VectorXd& scale) {
  MatrixXd y(x.rows() + 1, x.cols());
  y.topRows(x.rows()) = (x.colwise() - mean).array().colwise() / scale.array();
  y.bottomRows(1).setOnes();
  return y;
}

VectorXd deviation(const MatrixXd& x, const VectorXd& mean) {
  const VectorXd variance = (x.colwise() - mean).rowwise().squaredNorm() / x.cols();
  return variance.cwiseSqrt().cwiseMax(1e-9);
}

struct Adam {
  MatrixXd mean, square;
  void step(const MatrixXd& gradient, double rate, int epoch, MatrixXd& weights) {
    if (mean.size() == 0) mean = square = MatrixXd::Zero(gradient.rows(), gradient.cols());
    mean = 0.9 * mean + 0.1 * gradient;
    square = 0.999 * square + 0.001 * gradient.cwiseAbs2();
    const double of_mean = 1 / (1 - std::pow(0.9, epoch)),
                 of_square = 1 / (1 - std::pow(0.999, epoch));
    weights.array() -= rate * of_mean * mean.array() / ((of_square * square.array()).sqrt() + 1e-8);
  }
};

MatrixXd hidden_layer(const MatrixXd& weights, const MatrixXd& inputs) {
  MatrixXd h(weights.rows() + 1, inputs.cols());
  h.topRows(weights.rows()) = (weights * inputs).array().tanh();
  h.bottomRows(1).setOnes();
  return h;
}

}  // namespace

void ShapeNetwork::check() const {
  if (input_mean.size() < 1 || output_mean.size() < 1 || input_scale.size() != input_mean.size() ||
      output_scale.size() != output_mean.size() || hidden.cols() != input_mean.size() + 1 ||
      output.rows() != output_mean.size() || output.cols() != hidden.rows() + 1)
    throw std::invalid_argument("a network's sizes do not agree");
  if (!input_mean.allFinite() || !hidden.allFinite() || !output.allFinite() ||
      !output_mean.allFinite() || !output_scale.allFinite() || !(input_scale.minCoeff() > 0) ||
      !input_scale.allFinite())
    throw std::invalid_argument("a network's number is not finite, or a scale not above 0");
}

void ShapeNetwork::evaluate(const VectorXd& input, VectorXd& room,
                            VectorXd& result) const noexcept {
  const Eigen::Index n = inputs(), h = hidden.rows();
  for (Eigen::Index i = 0; i < h; ++i) {
    double sum = hidden(i, n);
    for (Eigen::Index k = 0; k < n; ++k)
      sum += hidden(i, k) * (input[k] - input_mean[k]) / input_scale[k];
    room[i] = std::tanh(sum);
  }
  for (Eigen::Index i = 0; i < outputs(); ++i) {
    double sum = output(i, h);
    for (Eigen::Index k = 0; k < h; ++k) sum += output(i, k) * room[k];
    result[i] = output_mean[i] + output_scale[i] * sum;
  }
}

ShapeNetwork train_shape_network(const MatrixXd& inputs, const MatrixXd& outputs,
                                 const MatrixXd& validation_inputs,
                                 const MatrixXd& validation_outputs,
                                 const ShapeTrainingOptions& options, math::Random random) {
  if (inputs.cols() < 2 || inputs.cols() != outputs.cols() ||
      validation_inputs.cols() != validation_outputs.cols() ||
      validation_inputs.rows() != inputs.rows() || validation_outputs.rows() != outputs.rows() ||
      options.hidden < 1)
    throw std::invalid_argument("samples of inputs and outputs do not agree");
  ShapeNetwork net;
  net.input_mean = inputs.rowwise().mean();
  net.input_scale = deviation(inputs, net.input_mean);
  net.output_mean = outputs.rowwise().mean();
  net.output_scale = deviation(outputs, net.output_mean);
  net.hidden.resize(options.hidden, inputs.rows() + 1);
  net.output.resize(outputs.rows(), options.hidden + 1);
  for (double& w : net.hidden.reshaped()) w = random.normal() / std::sqrt(inputs.rows());
  for (double& w : net.output.reshaped()) w = 0.3 * random.normal() / std::sqrt(options.hidden);
  const MatrixXd x = scaled(inputs, net.input_mean, net.input_scale);
  const MatrixXd y = scaled(outputs, net.output_mean, net.output_scale).topRows(outputs.rows());
  const MatrixXd x_held = scaled(validation_inputs, net.input_mean, net.input_scale);
  Adam of_hidden, of_output;
  ShapeNetwork best = net;
  double least = -1;
  int since = 0;
  for (int epoch = 1; epoch <= options.epochs && since < options.patience; ++epoch, ++since) {
    const MatrixXd h = hidden_layer(net.hidden, x);
    const MatrixXd error = (net.output * h - y) / static_cast<double>(x.cols());
    const MatrixXd back = net.output.leftCols(options.hidden).transpose() * error;
    const MatrixXd inner =
        (back.array() * (1 - h.topRows(options.hidden).array().square())).matrix();
    of_output.step(error * h.transpose() + options.decay * net.output, options.rate, epoch,
                   net.output);
    of_hidden.step(inner * x.transpose() + options.decay * net.hidden, options.rate, epoch,
                   net.hidden);
    // in the units of the outputs
    MatrixXd off = net.output * hidden_layer(net.hidden, x_held);
    off = (off.array().colwise() * net.output_scale.array()).matrix();
    off.colwise() += net.output_mean;
    const double squared = (off - validation_outputs).squaredNorm();
    if (least >= 0 && squared >= least) continue;
    least = squared;
    best = net;
    since = 0;
  }
  return best;
}

}  // namespace palpate::baselines
