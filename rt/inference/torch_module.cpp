#include "rt/inference/torch_functions.hpp"

#include <ATen/Parallel.h>
#include <torch/script.h>
#include <torch/version.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <mutex>
#include <sstream>

namespace palpate::inference {
namespace {

constexpr int kWarmUpSteps = 30;

/// Limits each thread pool to one thread: the inter-operator pool once per process, the
/// intra-operator pool once per thread.
void hold_pools_to_one_thread() {
  static std::once_flag once;
  std::call_once(once, [] {
    try {
      at::set_num_interop_threads(1);
    } catch (const std::exception&) {
      // already set by an earlier user
    }
  });
  thread_local bool done = false;
  if (done) return;
  at::set_num_threads(1);
  done = true;
}

/// One line of libtorch's message: the first or, if TorchScript itself failed, the last; the others
/// are locations in the code.
std::string gist(const std::exception& error) {
  std::istringstream text(error.what());
  std::string first, last;
  for (std::string line; std::getline(text, line);) {
    if (line.find_first_not_of(" ~<-") == std::string::npos) continue;
    if (first.empty()) first = line;
    last = line;
  }
  const bool in_script = first.find("operation failed in the TorchScript") != std::string::npos;
  const std::string& line = in_script ? last : first;
  return line.size() > 300 ? line.substr(0, 300) + " ..." : line;
}

torch::jit::Module load(const std::string& bytes) {
  hold_pools_to_one_thread();
  try {
    std::istringstream stream(bytes);
    torch::jit::Module module = torch::jit::load(stream, torch::kCPU);
    module.eval();
    return module;
  } catch (const std::exception& error) {
    throw ModelError("libtorch cannot read it: " + gist(error));
  }
}

std::string shape_text(const at::Tensor& tensor) {
  std::ostringstream text;
  text << tensor.scalar_type() << tensor.sizes();
  return text.str();
}

class TorchModel final : public SequenceModel {
 public:
  TorchModel(const torch::jit::Module& module, const ModelSizes& sizes) : sizes_(sizes) {
    c10::InferenceMode inference;
    try {
      module_ = torch::jit::freeze(module);
    } catch (const std::exception& error) {
      throw ModelError("it cannot be frozen: " + gist(error));
    }
    x_ = torch::zeros({1, sizes.inputs});
    state_ = torch::zeros({1, sizes.states});
    check();
  }

  ModelSizes sizes() const noexcept override { return sizes_; }
  const char* kind() const noexcept override { return "torch"; }

  bool step(const float* input, float* state, float* output) noexcept override {
    try {
      hold_pools_to_one_thread();
      c10::InferenceMode inference;
      std::copy_n(input, sizes_.inputs, x_.data_ptr<float>());
      std::copy_n(state, sizes_.states, state_.data_ptr<float>());
      const auto [y, next] = run();
      std::copy_n(y.data_ptr<float>(), sizes_.outputs, output);
      std::copy_n(next.data_ptr<float>(), sizes_.states, state);
      return std::all_of(output, output + sizes_.outputs, [](float v) { return std::isfinite(v); });
    } catch (...) {
      return false;
    }
  }

 private:
  /// Throws ModelError if the outputs do not have the declared shapes.
  std::pair<at::Tensor, at::Tensor> run() {
    const c10::IValue answer = module_.forward({x_, state_});
    if (!answer.isTuple()) throw ModelError("forward() must return (y, next_state)");
    const auto& elements = answer.toTupleRef().elements();
    if (elements.size() != 2 || !elements[0].isTensor() || !elements[1].isTensor())
      throw ModelError("forward() must return two tensors, (y, next_state)");
    return {checked("y", elements[0].toTensor(), sizes_.outputs),
            checked("next_state", elements[1].toTensor(), sizes_.states)};
  }

  static at::Tensor checked(const char* name, const at::Tensor& tensor, int width) {
    if (tensor.scalar_type() != torch::kFloat32 || tensor.dim() != 2 || tensor.size(0) != 1 ||
        tensor.size(1) != width)
      throw ModelError(std::string(name) + " is " + shape_text(tensor) + ", must be Float[1, " +
                       std::to_string(width) + "]");
    return tensor.contiguous();
  }

  void check() {
    std::pair<at::Tensor, at::Tensor> first, second;
    try {
      first = run();
      second = run();
      for (int i = 0; i < kWarmUpSteps; ++i) run();
    } catch (const ModelError&) {
      throw;
    } catch (const std::exception& error) {
      throw ModelError("forward(x[1, " + std::to_string(sizes_.inputs) + "], state[1, " +
                       std::to_string(sizes_.states) + "]) fails: " + gist(error));
    }
    for (const at::Tensor& tensor : {first.first, first.second})
      if (!torch::isfinite(tensor).all().item<bool>())
        throw ModelError("its answer to zeros is not finite");
    if (!torch::equal(first.first, second.first) || !torch::equal(first.second, second.second))
      throw ModelError("it answers the same input differently each time");
  }

  torch::jit::Module module_;
  ModelSizes sizes_;
  at::Tensor x_, state_;
};

/// Reads parameters by name.
class Reader {
 public:
  explicit Reader(const torch::jit::Module& module) : module_(module) {}

  bool has(const std::string& name) const { return module_.hasattr(name); }

  Eigen::MatrixXf matrix(const std::string& name) const {
    const at::Tensor tensor = find(name, 2);
    return Eigen::Map<const Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(
        tensor.data_ptr<float>(), tensor.size(0), tensor.size(1));
  }

  Eigen::VectorXf vector(const std::string& name) const {
    const at::Tensor tensor = find(name, 1);
    return Eigen::Map<const Eigen::VectorXf>(tensor.data_ptr<float>(), tensor.size(0));
  }

 private:
  // Maximum count of numbers in one parameter.
  static constexpr std::int64_t kLargest = 4 * 512 * 512;

  at::Tensor find(const std::string& name, int dimensions) const {
    if (!has(name) || !module_.attr(name).isTensor())
      throw ModelError("it has no parameter '" + name + "'");
    const at::Tensor tensor = module_.attr(name).toTensor();
    if (tensor.scalar_type() != torch::kFloat32 || tensor.dim() != dimensions ||
        tensor.numel() > kLargest)
      throw ModelError("parameter '" + name + "' is " + shape_text(tensor) + ", must be Float of " +
                       std::to_string(dimensions) + " dimensions and at most " +
                       std::to_string(kLargest) + " numbers");
    return tensor.detach().contiguous();
  }

  const torch::jit::Module& module_;
};

at::Tensor to_tensor(const Eigen::MatrixXf& matrix) {
  const at::Tensor tensor = torch::empty({matrix.rows(), matrix.cols()});
  Eigen::Map<Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(
      tensor.data_ptr<float>(), matrix.rows(), matrix.cols()) = matrix;
  return tensor;
}

at::Tensor to_tensor(const Eigen::VectorXf& vector) {
  const at::Tensor tensor = torch::empty({vector.size()});
  Eigen::Map<Eigen::VectorXf>(tensor.data_ptr<float>(), vector.size()) = vector;
  return tensor;
}

/// TorchScript source of forward() for a network with these layers.
std::string forward_source(const std::vector<sensing::LstmWeights>& layers) {
  std::ostringstream text;
  text << R"(
def forward(self, x: Tensor, state: Tensor) -> Tuple[Tensor, Tensor]:
    norm = torch.sqrt(torch.sum(self.unit_mask * x * x, 1, True) + self.unit_floor * self.unit_floor)
    z = (x * (1 - self.unit_mask + self.unit_mask / norm) - self.input_mean) / self.input_deviation
)";
  int begin = 0;
  std::string below = "z", next;
  for (std::size_t k = 0; k < layers.size(); ++k) {
    const int middle = begin + layers[k].size();
    const int end = middle + layers[k].size();
    const std::string h = "h" + std::to_string(k), c = "c" + std::to_string(k);
    const std::string lstm = "self.lstm" + std::to_string(k);
    text << "    " << h << ", " << c << " = torch.lstm_cell(" << below << ", [state[:, " << begin
         << ":" << middle << "], state[:, " << middle << ":" << end << "]], " << lstm << "_input, "
         << lstm << "_hidden, " << lstm << "_bias, None)\n";
    next += (k == 0 ? "" : ", ") + h + ", " + c;
    below = h;
    begin = end;
  }
  text << "    y = torch.matmul(" << below << ", self.dense.t()) + torch.matmul(z, self.linear.t())"
       << " + self.offset\n"
       << "    return self.output_mean + self.output_deviation * y, torch.cat([" << next
       << "], 1)\n";
  return text.str();
}

}  // namespace

std::unique_ptr<SequenceModel> load_torch_module(const std::string& bytes,
                                                 const ModelSizes& sizes) {
  const torch::jit::Module module = load(bytes);
  const auto method = module.find_method("forward");
  if (!method) throw ModelError("it has no method forward(x, state)");
  if (method->num_inputs() != 3)  // including self
    throw ModelError("forward() must take two arguments, (x, state), not " +
                     std::to_string(method->num_inputs() - 1));
  return std::make_unique<TorchModel>(module, sizes);
}

sensing::RecurrentWeights read_recurrent_weights(const std::string& bytes) {
  const torch::jit::Module module = load(bytes);
  const Reader reader(module);
  sensing::RecurrentWeights weights;
  weights.unit_mask = reader.vector("unit_mask");
  const Eigen::VectorXf floor = reader.vector("unit_floor");
  if (floor.size() != 1) throw ModelError("unit_floor must be one number");
  weights.unit_floor = floor[0];
  weights.input_mean = reader.vector("input_mean");
  weights.input_deviation = reader.vector("input_deviation");
  for (int k = 0; k <= sensing::RecurrentWeights::kLargestLayers; ++k) {
    const std::string name = "lstm" + std::to_string(k);
    if (!reader.has(name + "_input")) break;
    weights.layers.push_back({reader.matrix(name + "_input"), reader.matrix(name + "_hidden"),
                              reader.vector(name + "_bias")});
  }
  weights.dense = reader.matrix("dense");
  weights.linear = reader.matrix("linear");
  weights.offset = reader.vector("offset");
  weights.output_mean = reader.vector("output_mean");
  weights.output_deviation = reader.vector("output_deviation");
  return weights;
}

std::string write_torch_module(const sensing::RecurrentWeights& weights) {
  hold_pools_to_one_thread();
  torch::jit::Module module("RecurrentNetwork");
  const auto add = [&](const std::string& name, const auto& value) {
    module.register_parameter(name, to_tensor(value), false);
  };
  add("unit_mask", weights.unit_mask);
  add("unit_floor", Eigen::VectorXf(Eigen::VectorXf::Constant(1, weights.unit_floor)));
  add("input_mean", weights.input_mean);
  add("input_deviation", weights.input_deviation);
  for (std::size_t k = 0; k < weights.layers.size(); ++k) {
    const std::string name = "lstm" + std::to_string(k);
    add(name + "_input", weights.layers[k].input);
    add(name + "_hidden", weights.layers[k].hidden);
    add(name + "_bias", weights.layers[k].bias);
  }
  add("dense", weights.dense);
  add("linear", weights.linear);
  add("offset", weights.offset);
  add("output_mean", weights.output_mean);
  add("output_deviation", weights.output_deviation);
  module.define(forward_source(weights.layers));
  std::ostringstream stream;
  module.save(stream);
  return stream.str();
}

std::string torch_version() { return TORCH_VERSION; }

}  // namespace palpate::inference

const palpate::inference::TorchFunctions* palpate_torch_functions() {
  using namespace palpate::inference;
  static const TorchFunctions kFunctions{&load_torch_module, &read_recurrent_weights,
                                         &write_torch_module, &torch_version};
  return &kFunctions;
}
