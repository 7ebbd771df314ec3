#include "tools/train/trainer.hpp"

#include <ATen/Parallel.h>
#include <torch/nn/modules/linear.h>
#include <torch/nn/modules/rnn.h>
#include <torch/nn/utils/clip_grad.h>
#include <torch/optim/adam.h>
#include <torch/serialize.h>

#include <cmath>
#include <filesystem>
#include <random>
#include <stdexcept>

namespace palpate::train {
namespace {

using RowMajor = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

Eigen::MatrixXf to_matrix(const at::Tensor& tensor) {
  const at::Tensor t = tensor.detach().contiguous();
  return Eigen::Map<const RowMajor>(t.data_ptr<float>(), t.size(0), t.size(1));
}

Eigen::VectorXf to_vector(const at::Tensor& tensor) {
  const at::Tensor t = tensor.detach().contiguous();
  return Eigen::Map<const Eigen::VectorXf>(t.data_ptr<float>(), t.size(0));
}

at::Tensor to_tensor(const Eigen::MatrixXf& matrix) {
  RowMajor rows = matrix;
  return torch::from_blob(rows.data(), {rows.rows(), rows.cols()}).clone();
}

struct Network : torch::nn::Module {
  Network(int inputs, int outputs, const std::vector<int>& sizes, bool start_at_zero) {
    int below = inputs;
    for (std::size_t k = 0; k < sizes.size(); ++k) {
      lstms.push_back(register_module("lstm" + std::to_string(k),
                                      torch::nn::LSTM(torch::nn::LSTMOptions(below, sizes[k]))));
      below = sizes[k];
      // A forget gate that starts open retains the state from the first step on.
      torch::NoGradGuard no_grad;
      lstms.back()->named_parameters()["bias_ih_l0"].slice(0, below, 2 * below).fill_(1);
    }
    dense = register_module("dense", torch::nn::Linear(below, outputs));
    torch::NoGradGuard no_grad;
    if (start_at_zero) dense->weight.zero_();
    dense->bias.zero_();
  }

  /// Takes over cells of the same shapes.
  void put(const Cells& cells) {
    torch::NoGradGuard no_grad;
    for (std::size_t k = 0; k < lstms.size(); ++k) {
      auto parameters = lstms[k]->named_parameters();
      parameters["weight_ih_l0"].copy_(to_tensor(cells.layers[k].input));
      parameters["weight_hh_l0"].copy_(to_tensor(cells.layers[k].hidden));
      parameters["bias_ih_l0"].copy_(to_tensor(cells.layers[k].bias).flatten());
      parameters["bias_hh_l0"].zero_();
    }
    dense->weight.copy_(to_tensor(cells.dense));
    dense->bias.copy_(to_tensor(cells.offset).flatten());
  }

  using State = std::vector<std::tuple<at::Tensor, at::Tensor>>;

  State zero_state(std::int64_t lanes) const {
    State state;
    for (const torch::nn::LSTM& lstm : lstms) {
      const at::Tensor zero = torch::zeros({1, lanes, lstm->options.hidden_size()});
      state.emplace_back(zero, zero.clone());
    }
    return state;
  }

  /// x: steps x lanes x inputs.
  at::Tensor forward(at::Tensor x, State& state) {
    for (std::size_t k = 0; k < lstms.size(); ++k) {
      auto [y, next] = lstms[k]->forward(x, state[k]);
      x = y;
      state[k] = next;
    }
    return dense->forward(x);
  }

  Cells cells() const {
    Cells cells;
    for (const torch::nn::LSTM& lstm : lstms) {
      const auto parameters = lstm->named_parameters();
      cells.layers.push_back({to_matrix(parameters["weight_ih_l0"]),
                              to_matrix(parameters["weight_hh_l0"]),
                              to_vector(parameters["bias_ih_l0"] + parameters["bias_hh_l0"])});
    }
    cells.dense = to_matrix(dense->weight);
    cells.offset = to_vector(dense->bias);
    return cells;
  }

  std::vector<torch::nn::LSTM> lstms;
  torch::nn::Linear dense{nullptr};
};

/// Assigns the next piece of a sequence to each lane.
class Feeder {
 public:
  Feeder(const std::vector<Sequence>& sequences, const recordings::TrainingPlan& plan)
      : sequences_(sequences), plan_(plan), lanes_(plan.lanes) {
    for (std::size_t i = 0; i < sequences.size(); ++i) {
      const Eigen::Index starts = sequences[i].inputs.rows() - plan.steps + 1;
      if (starts < 1) continue;
      total_ += starts;
      ends_.push_back(total_);
      indices_.push_back(i);
    }
    if (total_ == 0)
      throw std::runtime_error("no stretch of training data is as long as training.steps (" +
                               std::to_string(plan.steps) + ")");
  }

  /// All lanes restart, in an order that depends only on the given numbers.
  void restart(int seed, int iteration) {
    std::seed_seq numbers{seed, iteration};
    random_.seed(numbers);
    for (Lane& lane : lanes_) lane.sequence = nullptr;
  }

  /// Fills steps x lanes x ... tensors; the state of restarting lanes is zeroed.
  void next(at::Tensor& x, at::Tensor& y, at::Tensor& w, Network::State& state) {
    const Eigen::Index inputs = sequences_.front().inputs.cols();
    const Eigen::Index outputs = sequences_.front().targets.cols();
    x = torch::empty({plan_.steps, plan_.lanes, inputs});
    y = torch::empty({plan_.steps, plan_.lanes, outputs});
    w = torch::empty({plan_.steps, plan_.lanes, 1});
    for (int l = 0; l < plan_.lanes; ++l) {
      Lane& lane = lanes_[l];
      const bool restarts = !plan_.carry || lane.sequence == nullptr ||
                            lane.begin + plan_.steps > lane.sequence->inputs.rows();
      if (restarts) draw(lane, state, l);
      for (int t = 0; t < plan_.steps; ++t) {
        const Eigen::Index row = lane.begin + t;
        const Eigen::Index place = t * plan_.lanes + l;
        using Row = Eigen::Map<Eigen::RowVectorXf>;
        Row(x.data_ptr<float>() + place * inputs, inputs) = lane.sequence->inputs.row(row);
        Row(y.data_ptr<float>() + place * outputs, outputs) = lane.sequence->targets.row(row);
        w.data_ptr<float>()[place] =
            restarts && t < plan_.burn_in ? 0.f : lane.sequence->weights[row];
      }
      lane.begin += plan_.steps;
    }
  }

 private:
  struct Lane {
    const Sequence* sequence = nullptr;
    Eigen::Index begin = 0;
  };

  void draw(Lane& lane, Network::State& state, int l) {
    const auto start = static_cast<Eigen::Index>(random_() % static_cast<std::uint64_t>(total_));
    std::size_t i = 0;
    while (ends_[i] <= start) ++i;
    lane.sequence = &sequences_[indices_[i]];
    lane.begin = start - (i == 0 ? 0 : ends_[i - 1]);
    for (auto& [h, c] : state) {
      h.select(1, l).zero_();
      c.select(1, l).zero_();
    }
  }

  const std::vector<Sequence>& sequences_;
  const recordings::TrainingPlan& plan_;
  std::vector<Lane> lanes_;
  std::vector<Eigen::Index> ends_;  // of the possible starts, counted over all sequences
  std::vector<std::size_t> indices_;
  Eigen::Index total_ = 0;
  std::mt19937_64 random_;
};

/// State of a training; restored from a checkpoint.
struct Standing {
  int iteration = 0;
  int best_iteration = 0;
  double best = 0;
  std::vector<CurvePoint> curve;
};

/// Settings that must be equal for a training to be resumed.
std::string signature(const std::vector<Sequence>& sequences, const std::vector<int>& layers,
                      const recordings::TrainingPlan& plan) {
  std::ostringstream text;
  text << plan.seed << ' ' << plan.evaluate_every << ' ' << plan.lanes << ' ' << plan.steps << ' '
       << plan.carry << ' ' << plan.burn_in << ' ' << plan.rate << ' ' << plan.clip << ' '
       << plan.weight_decay << ' ' << plan.input_noise << ' ' << plan.iterations;
  for (const int size : layers) text << ' ' << size;
  double sum = 0;
  for (const Sequence& sequence : sequences)
    sum += sequence.inputs.cast<double>().sum() + 3 * sequence.targets.cast<double>().sum();
  text << ' ' << sum;
  return text.str();
}

at::Tensor to_tensor(const std::vector<CurvePoint>& curve) {
  const at::Tensor tensor =
      torch::empty({static_cast<std::int64_t>(curve.size()), 3}, torch::kFloat64);
  for (std::size_t i = 0; i < curve.size(); ++i) {
    double* const row = tensor.data_ptr<double>() + 3 * i;
    row[0] = curve[i].iteration;
    row[1] = curve[i].training;
    row[2] = curve[i].validation;
  }
  return tensor;
}

void save(const std::string& path, const std::string& sign, Network& network, Network& best,
          torch::optim::Adam& adam, const Standing& standing) {
  torch::serialize::OutputArchive archive, network_archive, best_archive, adam_archive;
  network.save(network_archive);
  best.save(best_archive);
  adam.save(adam_archive);
  archive.write("signature", c10::IValue(sign));
  archive.write("iteration", c10::IValue(standing.iteration));
  archive.write("best_iteration", c10::IValue(standing.best_iteration));
  archive.write("best", c10::IValue(standing.best));
  archive.write("curve", to_tensor(standing.curve), true);
  archive.write("network", network_archive);
  archive.write("best_network", best_archive);
  archive.write("adam", adam_archive);
  archive.save_to(path + ".part");
  std::filesystem::rename(path + ".part", path);  // never a partial checkpoint
}

void restore(const std::string& path, const std::string& sign, Network& network, Network& best,
             torch::optim::Adam& adam, Standing& standing) {
  try {
    torch::serialize::InputArchive archive, network_archive, best_archive, adam_archive;
    archive.load_from(path);
    c10::IValue value;
    archive.read("signature", value);
    if (value.toStringRef() != sign)
      throw std::runtime_error("it belongs to another plan, data set or seed");
    archive.read("iteration", value);
    standing.iteration = static_cast<int>(value.toInt());
    archive.read("best_iteration", value);
    standing.best_iteration = static_cast<int>(value.toInt());
    archive.read("best", value);
    standing.best = value.toDouble();
    at::Tensor curve;
    archive.read("curve", curve, true);
    for (std::int64_t i = 0; i < curve.size(0); ++i) {
      const double* const row = curve.data_ptr<double>() + 3 * i;
      standing.curve.push_back({static_cast<int>(row[0]), row[1], row[2]});
    }
    archive.read("network", network_archive);
    archive.read("best_network", best_archive);
    archive.read("adam", adam_archive);
    network.load(network_archive);
    best.load(best_archive);
    adam.load(adam_archive);
  } catch (const std::exception& error) {
    const std::string what = error.what();
    throw std::runtime_error(path + ": cannot be resumed: " + what.substr(0, what.find('\n')));
  }
}

void copy_parameters(const Network& from, Network& to) {
  torch::NoGradGuard no_grad;
  const auto source = from.parameters();
  const auto target = to.parameters();
  for (std::size_t i = 0; i < source.size(); ++i) target[i].copy_(source[i]);
}

}  // namespace

TrainerResult train_cells(const std::vector<Sequence>& sequences, const std::vector<int>& layers,
                          const recordings::TrainingPlan& plan, const TrainerHooks& hooks) {
  if (sequences.empty()) throw std::runtime_error("there is no training data");
  at::set_num_threads(1);  // sums in the same order each time, for reproducibility
  torch::manual_seed(plan.seed);
  const int inputs = static_cast<int>(sequences.front().inputs.cols());
  const int outputs = static_cast<int>(sequences.front().targets.cols());
  Network network(inputs, outputs, layers, hooks.start_at_zero);
  Network best(inputs, outputs, layers, hooks.start_at_zero);
  if (hooks.start != nullptr) network.put(*hooks.start);
  torch::optim::Adam adam(network.parameters(),
                          torch::optim::AdamOptions(plan.rate).weight_decay(plan.weight_decay));
  Feeder feeder(sequences, plan);
  const std::string sign = signature(sequences, layers, plan);

  Standing standing;
  const auto evaluate = [&](double training) {
    const CurvePoint point{standing.iteration, training, hooks.validate(network.cells())};
    standing.curve.push_back(point);
    if (plan.keep_last || standing.curve.size() == 1 || point.validation < standing.best) {
      standing.best = point.validation;
      standing.best_iteration = standing.iteration;
      copy_parameters(network, best);
    }
    return hooks.progress(point);
  };
  bool goes_on = true;
  if (hooks.resume && std::filesystem::exists(hooks.checkpoint)) {
    restore(hooks.checkpoint, sign, network, best, adam, standing);
  } else {
    goes_on = evaluate(std::nan(""));
  }

  Network::State state = network.zero_state(plan.lanes);
  while (goes_on && standing.iteration < plan.iterations &&
         standing.iteration - standing.best_iteration < plan.patience * plan.evaluate_every) {
    feeder.restart(plan.seed, standing.iteration);
    torch::manual_seed(static_cast<std::uint64_t>(plan.seed) * 1000003u +
                       static_cast<std::uint64_t>(standing.iteration));
    double sum = 0;
    int count = 0;
    for (; count < plan.evaluate_every && standing.iteration < plan.iterations; ++count) {
      const double turn = M_PI * standing.iteration / plan.iterations;
      static_cast<torch::optim::AdamOptions&>(adam.param_groups()[0].options())
          .lr(plan.rate * (0.1 + 0.9 * 0.5 * (1 + std::cos(turn))));
      at::Tensor x, y, w;
      for (auto& [h, c] : state) {
        h = h.detach();
        c = c.detach();
      }
      feeder.next(x, y, w, state);
      if (plan.input_noise > 0) x = x + plan.input_noise * torch::randn_like(x);
      adam.zero_grad();
      const at::Tensor error = network.forward(x, state) - y;
      const at::Tensor loss =
          (error * error * w).sum() / (static_cast<double>(outputs) * w.sum().clamp_min(1));
      loss.backward();
      torch::nn::utils::clip_grad_norm_(network.parameters(), plan.clip);
      adam.step();
      const double value = loss.item<double>();
      if (!std::isfinite(value)) throw std::runtime_error("the loss is not finite; lower the rate");
      sum += value;
      ++standing.iteration;
    }
    goes_on = evaluate(sum / std::max(1, count));
    if (!hooks.checkpoint.empty()) save(hooks.checkpoint, sign, network, best, adam, standing);
  }
  return {best.cells(), standing.best_iteration, standing.curve};
}

}  // namespace palpate::train
