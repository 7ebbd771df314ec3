#include "tools/train/fit.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "tools/recordings/ridge.hpp"

namespace palpate::train {
namespace {

using sensing::RecurrentWeights;

Eigen::VectorXd floors(const std::vector<recordings::ColumnGroup>& groups) {
  std::vector<double> list;
  for (const recordings::ColumnGroup& group : groups)
    list.insert(list.end(), group.columns.size(), group.floor);
  return Eigen::Map<Eigen::VectorXd>(list.data(), static_cast<Eigen::Index>(list.size()));
}

struct Scale {
  Eigen::VectorXd mean;
  Eigen::VectorXd deviation;  // not below the floor

  Scale(const Eigen::MatrixXd& rows, const Eigen::VectorXd& floor) {
    mean = rows.colwise().mean().transpose();
    deviation = ((rows.rowwise() - mean.transpose()).colwise().squaredNorm() /
                 static_cast<double>(rows.rows()))
                    .cwiseSqrt()
                    .transpose()
                    .cwiseMax(floor);
  }
  Scale(const Eigen::VectorXf& known_mean, const Eigen::VectorXf& known_deviation)
      : mean(known_mean.cast<double>()), deviation(known_deviation.cast<double>()) {}
  static Scale of_inputs(const RecurrentWeights& w) { return {w.input_mean, w.input_deviation}; }
  static Scale of_outputs(const RecurrentWeights& w) { return {w.output_mean, w.output_deviation}; }

  Eigen::MatrixXd apply(const Eigen::MatrixXd& rows) const {
    return (rows.rowwise() - mean.transpose()) * deviation.cwiseInverse().asDiagonal();
  }
};

/// As many rows as `like` has, each this vector.
Eigen::MatrixXd ones_times(const Eigen::VectorXd& row, const Eigen::MatrixXd& like) {
  return row.transpose().replicate(like.rows(), 1);
}

/// Throws if the initial network does not have the plan's shape.
void check_start(const RecurrentWeights& start, const RecurrentWeights& plan) {
  bool same = start.inputs() == plan.inputs() && start.outputs() == plan.outputs() &&
              start.layers.size() == plan.layers.size() && start.unit_mask == plan.unit_mask &&
              start.unit_floor == plan.unit_floor;
  for (std::size_t k = 0; same && k < plan.layers.size(); ++k)
    same = start.layers[k].size() == plan.layers[k].size();
  if (!same)
    throw std::runtime_error(
        "start_from: the network has other inputs, outputs, layers or unit_length than the plan");
}

void set_unit_length(const std::vector<recordings::ColumnGroup>& inputs,
                     RecurrentWeights& weights) {
  Eigen::Index first = 0;
  for (const recordings::ColumnGroup& group : inputs) {
    const auto count = static_cast<Eigen::Index>(group.columns.size());
    if (group.unit_length > 0) {
      weights.unit_mask.segment(first, count).setOnes();
      weights.unit_floor = static_cast<float>(group.unit_length);
    }
    first += count;
  }
}

/// Rows transformed by the network's input map.
Eigen::MatrixXd with_unit_length(const Eigen::MatrixXd& rows, const RecurrentWeights& weights) {
  const Eigen::ArrayXd mask = weights.unit_mask.cast<double>().array();
  const double floor = weights.unit_floor;
  Eigen::MatrixXd result = rows;
  for (Eigen::Index k = 0; k < rows.rows(); ++k) {
    const Eigen::ArrayXd x = rows.row(k).transpose().array();
    const double norm = std::sqrt((mask * x.square()).sum() + floor * floor);
    result.row(k) = (x * (1 - mask + mask / norm)).matrix().transpose();
  }
  return result;
}

bool is_used(const recordings::Recording& recording, std::size_t k, bool all_parts) {
  return all_parts || recording.parts[k] == recordings::Part::kTraining;
}

Eigen::MatrixXd gather_used(const recordings::DataSet& data,
                            const std::vector<Eigen::MatrixXd>& list, bool all_parts) {
  if (!all_parts) return recordings::gather(data, list, recordings::Part::kTraining);
  const Eigen::MatrixXd parts[] = {recordings::gather(data, list, recordings::Part::kTraining),
                                   recordings::gather(data, list, recordings::Part::kValidation),
                                   recordings::gather(data, list, recordings::Part::kTest)};
  Eigen::MatrixXd all(parts[0].rows() + parts[1].rows() + parts[2].rows(), parts[0].cols());
  all << parts[0], parts[1], parts[2];
  return all;
}

/// Ranges of rows without a gap that may be used for training.
std::vector<Sequence> stretches(const recordings::DataSet& data,
                                const std::vector<Eigen::MatrixXd>& inputs,
                                const std::vector<Eigen::MatrixXd>& targets, bool all_parts) {
  std::vector<Sequence> list;
  for (std::size_t r = 0; r < data.recordings.size(); ++r) {
    const recordings::Recording& recording = data.recordings[r];
    const std::size_t n = recording.parts.size();
    for (std::size_t begin = 0; begin < n;) {
      std::size_t end = begin;
      while (end < n && is_used(recording, end, all_parts)) ++end;
      const auto count = static_cast<Eigen::Index>(end - begin);
      if (count > 0) {
        Sequence sequence;
        const auto first = static_cast<Eigen::Index>(begin);
        sequence.inputs = inputs[r].middleRows(first, count).cast<float>();
        sequence.targets = targets[r].middleRows(first, count).cast<float>();
        sequence.weights.resize(count);
        for (Eigen::Index k = 0; k < count; ++k)
          sequence.weights[k] = recording.counts[begin + static_cast<std::size_t>(k)] ? 1.f : 0.f;
        list.push_back(std::move(sequence));
      }
      begin = end + 1;
    }
  }
  return list;
}

/// Puts cells whose output is in units of `target_deviation` after the linear path of `base`.
RecurrentWeights assemble(const RecurrentWeights& base, const Cells& cells,
                          const Eigen::VectorXd& target_deviation) {
  RecurrentWeights weights = base;
  const Eigen::VectorXf scale = target_deviation.cast<float>().cwiseQuotient(base.output_deviation);
  weights.layers = cells.layers;
  weights.dense = scale.asDiagonal() * cells.dense;
  weights.offset += scale.cwiseProduct(cells.offset);
  return weights;
}

double validation_error(const RecurrentWeights& weights, const recordings::DataSet& data,
                        int window) {
  const Eigen::MatrixXd predicted =
      recordings::gather(data, predict(weights, data, window, {}, recordings::Part::kValidation),
                         recordings::Part::kValidation);
  const Eigen::MatrixXd truth =
      recordings::gather(data, recordings::outputs_of(data), recordings::Part::kValidation);
  const Eigen::VectorXd scale = weights.output_deviation.cast<double>().cwiseInverse();
  return ((predicted - truth) * scale.asDiagonal()).squaredNorm() /
         static_cast<double>(truth.size());
}

/// Per output, the fraction of the cells' output that minimises the validation error, 0 to 1.
Eigen::VectorXd trusted_part(const RecurrentWeights& base, const RecurrentWeights& network,
                             const recordings::DataSet& data, int window) {
  const Eigen::MatrixXd without =
      recordings::gather(data, predict(base, data), recordings::Part::kValidation);
  const Eigen::MatrixXd cells =
      recordings::gather(data, predict(network, data, window), recordings::Part::kValidation) -
      without;
  const Eigen::MatrixXd wanted =
      recordings::gather(data, recordings::outputs_of(data), recordings::Part::kValidation) -
      without;
  Eigen::VectorXd part = Eigen::VectorXd::Zero(cells.cols());
  for (Eigen::Index k = 0; k < cells.cols(); ++k)
    if (cells.col(k).squaredNorm() > 0)
      part[k] = std::clamp(cells.col(k).dot(wanted.col(k)) / cells.col(k).squaredNorm(), 0.0, 1.0);
  return part;
}

}  // namespace

Fit fit_model(const recordings::Plan& plan, const recordings::DataSet& data,
              const FitOptions& options) {
  const int inputs = static_cast<int>(data.inputs.size());
  const int outputs = static_cast<int>(data.outputs.size());
  RecurrentWeights base = RecurrentWeights::zero(inputs, outputs, plan.network.layers);
  set_unit_length(plan.data.inputs, base);

  std::vector<Eigen::MatrixXd> x = recordings::inputs_of(data);
  for (Eigen::MatrixXd& rows : x) rows = with_unit_length(rows, base);
  std::vector<Eigen::MatrixXd> y = recordings::outputs_of(data);
  const Eigen::MatrixXd used_x = gather_used(data, x, options.all_parts);
  const Eigen::MatrixXd used_y = gather_used(data, y, options.all_parts);
  if (used_x.rows() < 10) throw std::runtime_error("fewer than ten rows of training data count");
  const bool is_validated = recordings::gather(data, y, recordings::Part::kValidation).rows() > 0;
  if (!options.all_parts && !is_validated && (!plan.training.keep_last || plan.network.shrink))
    throw std::runtime_error(
        "no row of the validation part counts: the recordings are shorter than the plan says, or "
        "without contact there");
  const Scale in =
      options.start ? Scale::of_inputs(*options.start) : Scale(used_x, floors(plan.data.inputs));
  const Scale out =
      options.start ? Scale::of_outputs(*options.start) : Scale(used_y, floors(plan.data.outputs));
  base.input_mean = in.mean.cast<float>();
  base.input_deviation = in.deviation.cast<float>();
  base.output_mean = out.mean.cast<float>();
  base.output_deviation = out.deviation.cast<float>();
  if (options.start) {
    check_start(*options.start, base);
    base.linear = options.start->linear;
    base.offset = options.start->offset;
  }

  // Target of the ridge: the residual of the initial network, if there is one.
  for (Eigen::MatrixXd& rows : x) rows = in.apply(rows);
  std::vector<Eigen::MatrixXd> left = y;
  if (options.start) {
    const std::vector<Eigen::MatrixXd> known = predict(*options.start, data);
    for (std::size_t r = 0; r < y.size(); ++r)
      left[r] = y[r] - known[r] + ones_times(out.mean, y[r]);
  }
  for (Eigen::MatrixXd& rows : left) rows = out.apply(rows);
  Fit fit;
  const recordings::Ridge ridge =
      recordings::fit_ridge(gather_used(data, x, options.all_parts),
                            gather_used(data, left, options.all_parts), plan.network.penalties);
  fit.penalty = ridge.penalty;
  fit.linear = options.start ? *options.start : base;
  fit.linear.linear += ridge.matrix.cast<float>();
  fit.linear.offset += ridge.offset.cast<float>();
  if (plan.network.linear) {
    base.linear += ridge.matrix.cast<float>();
    base.offset += ridge.offset.cast<float>();
  }

  // Target of the cells: the residual of the linear path, scaled to unit size; an initial network
  // has its own scale.
  for (std::size_t r = 0; r < y.size(); ++r) {
    y[r] = out.apply(y[r]);
    y[r] -= x[r] * base.linear.cast<double>().transpose();
    y[r].rowwise() -= base.offset.cast<double>().transpose();
    y[r] = y[r] * out.deviation.asDiagonal();
  }
  const Eigen::VectorXd target_deviation =
      options.start
          ? out.deviation
          : Scale(gather_used(data, y, options.all_parts), 1e-3 * floors(plan.data.outputs))
                .deviation;
  for (Eigen::MatrixXd& rows : y) rows = rows * target_deviation.cwiseInverse().asDiagonal();

  TrainerHooks hooks;
  const int window = plan.training.carry ? 0 : plan.training.steps;
  hooks.validate = [&](const Cells& cells) -> double {
    if (options.all_parts || !is_validated) return std::nan("");
    return validation_error(assemble(base, cells, target_deviation), data, window);
  };
  hooks.progress = options.progress;
  hooks.checkpoint = options.checkpoint;
  hooks.resume = options.resume;
  hooks.start_at_zero = plan.network.linear;
  Cells start;
  if (options.start) {
    start = {options.start->layers, options.start->dense, Eigen::VectorXf::Zero(outputs)};
    hooks.start = &start;
  }
  recordings::TrainingPlan training = plan.training;
  training.keep_last = training.keep_last || options.all_parts;
  const TrainerResult result =
      train_cells(stretches(data, x, y, options.all_parts), plan.network.layers, training, hooks);
  fit.network = assemble(base, result.cells, target_deviation);
  fit.trust = Eigen::VectorXd::Ones(outputs);
  if (plan.network.shrink) {
    fit.trust = options.all_parts ? options.trust : trusted_part(base, fit.network, data, window);
    const Eigen::VectorXf trust = fit.trust.cast<float>();
    fit.network.dense = trust.asDiagonal() * fit.network.dense;
    fit.network.offset = base.offset + trust.cwiseProduct(fit.network.offset - base.offset);
  }
  if (plan.network.domain_points > 0)
    fit.domain = sensing::cover(gather_used(data, recordings::inputs_of(data), options.all_parts),
                                in.deviation, plan.network.domain_points, plan.network.domain_near,
                                plan.network.domain_far);
  fit.best_iteration = result.best_iteration;
  fit.curve = result.curve;
  return fit;
}

std::vector<Eigen::MatrixXd> predict(const RecurrentWeights& weights,
                                     const recordings::DataSet& data, int window,
                                     const sensing::InputDomain& domain,
                                     std::optional<recordings::Part> only) {
  sensing::RecurrentNetwork network(weights);
  std::vector<float> state(network.states());
  Eigen::VectorXf answer(network.outputs());
  std::vector<Eigen::MatrixXd> list;
  for (const recordings::Recording& recording : data.recordings) {
    const Eigen::MatrixXf x = recording.inputs.cast<float>().transpose();
    Eigen::MatrixXd y = Eigen::MatrixXd::Zero(x.cols(), network.outputs());
    if (only &&
        std::find(recording.parts.begin(), recording.parts.end(), *only) == recording.parts.end()) {
      list.push_back(std::move(y));
      continue;
    }
    std::fill(state.begin(), state.end(), 0.f);
    for (Eigen::Index k = 0; k < x.cols(); ++k) {
      if (window > 0) std::fill(state.begin(), state.end(), 0.f);
      const Eigen::Index first = window > 0 ? k - window + 1 : k;
      for (Eigen::Index i = first; i <= k; ++i)
        network.step(x.col(std::max<Eigen::Index>(i, 0)).data(), state.data(), answer.data());
      y.row(k) =
          domain.trust(recording.inputs.row(k).transpose()) * answer.cast<double>().transpose();
    }
    list.push_back(std::move(y));
  }
  return list;
}

}  // namespace palpate::train
