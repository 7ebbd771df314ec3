#include "rt/inference/model_file.hpp"

#include <filesystem>
#include <fstream>
#include <sstream>

#include "rt/config/node.hpp"
#include "rt/inference/compiled_executor.hpp"
#include "rt/inference/model_probe.hpp"

namespace palpate::inference {
namespace {

/// Neither a directory nor a pipe without a writer.
void require_file(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) throw ModelError(path + ": is not a file");
}

std::string read_bytes(const std::string& path, std::size_t largest) {
  require_file(path);
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (error) throw ModelError(path + ": " + error.message());
  if (size > largest)
    throw ModelError(path + ": has " + std::to_string(size) + " bytes; allowed: at most " +
                     std::to_string(largest));
  std::ifstream stream(path, std::ios::binary);
  std::string bytes(size, '\0');
  if (!stream.read(bytes.data(), static_cast<std::streamsize>(size)))
    throw ModelError(path + ": cannot be read");
  return bytes;
}

/// Runs `make`; adds the file name to exceptions.
template <class Make>
auto named(const ModelFile& file, Make make) {
  try {
    return make();
  } catch (const std::exception& error) {
    throw ModelError(file.path + ": " + error.what());
  }
}

/// Loads the module in libtorch after a separate process has done so successfully.
std::unique_ptr<SequenceModel> load(const ModelFile& file) {
  probe_module(file.bytes, file.card.sizes());
  return load_torch_module(file.bytes, file.card.sizes());
}

bool same(const ModelSizes& a, const ModelSizes& b) {
  return a.inputs == b.inputs && a.states == b.states && a.outputs == b.outputs;
}

std::string to_text(const ModelSizes& sizes) {
  return std::to_string(sizes.inputs) + " inputs, " + std::to_string(sizes.states) + " states, " +
         std::to_string(sizes.outputs) + " outputs";
}

}  // namespace

#ifdef PALPATE_WITHOUT_TORCH
namespace {
constexpr const char* kWithout = "this build of palpate has no libtorch";
}
std::unique_ptr<SequenceModel> load_torch_module(const std::string&, const ModelSizes&) {
  throw ModelError(kWithout);
}
sensing::RecurrentWeights read_recurrent_weights(const std::string&) { throw ModelError(kWithout); }
std::string write_torch_module(const sensing::RecurrentWeights&) { throw ModelError(kWithout); }
std::string torch_version() { return "none"; }
void probe_module(const std::string&, const ModelSizes&) {}  // loading reports what is missing
#endif

ModelFile read_model_file(const std::string& path) {
  ModelFile file;
  file.path = path;
  file.bytes = read_bytes(path, kLargestModule);
  const std::string card = card_path(path);
  require_file(card);
  try {
    file.card = read_card(card);
  } catch (const std::exception& error) {
    throw ModelError(error.what());
  }
  const std::string hash = sha256_of(file.bytes);
  if (hash != file.card.sha256)
    throw ModelError(path + ": its SHA-256 is " + hash + ", that in " + card + " " +
                     file.card.sha256 + ": the file is damaged or not the card's");
  return file;
}

std::unique_ptr<SequenceModel> make_torch_model(const ModelFile& file) {
  return named(file, [&] { return load(file); });
}

std::unique_ptr<SequenceModel> make_compiled_model(const ModelFile& file) {
  return named(file, [&]() -> std::unique_ptr<SequenceModel> {
    if (file.card.architecture != kRecurrentNetwork)
      throw ModelError("architecture '" + file.card.architecture +
                       "' runs with `executor: torch` only; compiled runs " + kRecurrentNetwork);
    probe_module(file.bytes, file.card.sizes());
    auto compiled = std::make_unique<CompiledModel>(read_recurrent_weights(file.bytes));
    if (!same(compiled->sizes(), file.card.sizes()))
      throw ModelError("it has " + to_text(compiled->sizes()) + ", its card says " +
                       to_text(file.card.sizes()));
    const auto torch = load(file);
    const double difference = largest_difference(*compiled, *torch);
    if (!(difference <= kAgreement)) {
      std::ostringstream text;
      text << "compiled and libtorch differ by " << difference
           << " of an output's deviation; allowed: " << kAgreement;
      throw ModelError(text.str());
    }
    return compiled;
  });
}

std::unique_ptr<Executor> make_executor(const ModelFile& file, ExecutorKind kind,
                                        const TorchExecutorOptions& options) {
  if (kind == ExecutorKind::kCompiled)
    return std::make_unique<DirectExecutor>(make_compiled_model(file));
  return named(file, [&] { return std::make_unique<TorchExecutor>(load(file), options); });
}

void write_model_file(const std::string& path, const sensing::RecurrentWeights& weights,
                      ModelCard card) {
  const std::string bytes = write_torch_module(weights);
  card.architecture = kRecurrentNetwork;
  card.states = weights.states();
  card.sha256 = sha256_of(bytes);
  std::ofstream stream(path, std::ios::binary);
  stream.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  stream.close();
  if (!stream) throw std::runtime_error(path + ": cannot be written");
  write_card(card, card_path(path));
}

}  // namespace palpate::inference
