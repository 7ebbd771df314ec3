#include "tools/lab/baselines/learning/learned_shape.hpp"

#include "rt/config/node.hpp"

namespace palpate::baselines {
namespace {

Eigen::VectorXd vector(const config::Node& node, const std::string& key, int count) {
  const std::vector<double> numbers = node.numbers(key, count);
  return Eigen::Map<const Eigen::VectorXd>(numbers.data(),
                                           static_cast<Eigen::Index>(numbers.size()));
}

/// Row-major.
Eigen::MatrixXd matrix(const config::Node& node, const std::string& key, int rows, int columns) {
  return vector(node, key, rows * columns).reshaped(columns, rows).transpose();
}

}  // namespace

LearnedShape::Model read_learned_shape(const std::string& file) {
  const config::Node node = config::Node::load_file(file);
  LearnedShape::Model model;
  model.inputs = node.choice("inputs", {"position", "angle"}) == "angle"
                     ? LearnedShape::Inputs::kAngle
                     : LearnedShape::Inputs::kPosition;
  const int inputs = static_cast<int>(LearnedShape::input_count(model.inputs));
  const int units = node.integer("units", {1, 1000}), hidden = node.integer("hidden", {1, 1000});
  model.units = matrix(node, "places", units, 3).transpose();
  model.network.input_mean = vector(node, "input_mean", inputs);
  model.network.input_scale = vector(node, "input_scale", inputs);
  model.network.hidden = matrix(node, "hidden_weights", hidden, inputs + 1);
  model.network.output = matrix(node, "output_weights", 3 * units, hidden + 1);
  model.network.output_mean = vector(node, "output_mean", 3 * units);
  model.network.output_scale = vector(node, "output_scale", 3 * units);
  node.leave_to_another("card");
  node.check_all_used();
  try {
    model.network.check();
  } catch (const std::invalid_argument& error) {
    node.fail("", error.what());
  }
  return model;
}

}  // namespace palpate::baselines
