#include "rt/registry/sensors.hpp"

#include <algorithm>

#include "core/sensing/biotac_lstm.hpp"
#include "core/sensing/ft_rnnob.hpp"
#include "rt/inference/model_file.hpp"
#include "rt/loop/fixed_rate_loop.hpp"
#include "rt/registry/fallbacks.hpp"

namespace palpate::registry {
namespace {

// s, maximum wait for a result in deterministic mode; then a fault
constexpr double kPatience = 10;

using Channels = std::vector<inference::Channel>;

/// -1: there is none of that name.
int index_of(const Channels& channels, const std::string& name) {
  const auto at = std::find_if(channels.begin(), channels.end(),
                               [&name](const auto& channel) { return channel.name == name; });
  return at == channels.end() ? -1 : static_cast<int>(at - channels.begin());
}

/// Validated model named by a key, with everything required to run it.
class LearnedModel {
 public:
  using Options = inference::TorchExecutorOptions;

  LearnedModel(const config::Node& node, const std::string& key, const Context& context)
      : node_(node), key_(key) {
    kind_ = node.choice({"executor", "",
                         "Runtime of the network: libtorch in a thread of its own, or compiled "
                         "weights in the loop"},
                        {"torch", "compiled"}, "torch") == "torch"
                ? inference::ExecutorKind::kTorch
                : inference::ExecutorKind::kCompiled;
    options_ = node.read(config::OptionTable<Options>(context.inference)
                             .number("wait_us", "us",
                                     "Duration for which a cycle waits for the network; a later "
                                     "result is used in the next one",
                                     {0, 1e5}, &Options::wait, 1e-6));
    if (context.deterministic) options_.wait = options_.patience = kPatience;
    options_.patience = std::max(options_.patience, options_.wait);
    options_.remarks = context.remarks;
    try {
      file_ = inference::read_model_file(
          node.path({key, "", "TorchScript module of palpate-train, next to its model card"}));
    } catch (const inference::ModelError& error) {
      node.fail(key, error.what());
    }
  }

  const inference::ModelCard& card() const { return file_.card; }

  /// Creates a warmed-up executor.
  std::unique_ptr<sensing::Executor> make_executor() const {
    try {
      return inference::make_executor(file_, kind_, options_);
    } catch (const inference::ModelError& error) {
      node_.fail(key_, error.what());
    }
  }

  /// Indices in `known`, whose names are `names`, of the card's inputs.
  std::vector<int> inputs(const Channels& known, const std::string& names) const {
    std::vector<int> places;
    for (const inference::Channel& input : file_.card.inputs) {
      const int place = index_of(known, input.name);
      if (place < 0) fail("takes an input '" + input.name + "'; known: " + names);
      if (input.unit != known[place].unit)
        fail("takes input '" + input.name + "' in " + input.unit + ", not in " + known[place].unit);
      places.push_back(place);
    }
    return places;
  }

  /// Indices of the required outputs in the card.
  std::vector<int> outputs(const Channels& wanted) const {
    std::vector<int> places;
    for (const inference::Channel& want : wanted) {
      places.push_back(index_of(file_.card.outputs, want.name));
      if (places.back() < 0) fail("has no output '" + want.name + "'");
      const std::string& unit = file_.card.outputs[places.back()].unit;
      if (unit != want.unit) fail("gives '" + want.name + "' in " + unit + ", not in " + want.unit);
    }
    return places;
  }

  [[noreturn]] void fail(const std::string& what) const {
    node_.fail(key_, file_.path + ": the model " + what);
  }

 private:
  config::Node node_;
  std::string key_;
  inference::ExecutorKind kind_{};
  Options options_;
  inference::ModelFile file_;
};

std::vector<int> tactile_inputs_of(const LearnedModel& model) {
  if (model.card().average > 0)
    model.fail("needs averaged counts, which this component does not provide");
  Channels known;
  for (int i = 0; i < sensing::kElectrodeCount; ++i)
    known.push_back({"e" + std::to_string(i + 1), "count"});
  known.insert(known.end(), {{"pac0", "count"}, {"pdc", "count"}});
  return model.inputs(known, "e1 to e19, pac0, pdc");
}

std::vector<int> observer_inputs_of(const LearnedModel& model) {
  Channels known;
  std::string names;
  for (int i = 0; i < sensing::kObserverInputCount; ++i) {
    known.push_back({sensing::observer_input_name(i), sensing::observer_input_unit(i)});
    names += (i > 0 ? ", " : "") + known.back().name;
  }
  return model.inputs(known, names);
}

/// Key `fallback`, unless it is a section with a component of its own: whether `built_in` takes
/// over.
bool has_built_in_fallback(const config::Node& node, const char* built_in) {
  return !has_fallback(node) &&
         node.choice({"fallback", "", "Component that takes over where the network fails"},
                     {"none", built_in}, "none") == built_in;
}

std::optional<sensing::BiotacLstm::Direction> read_direction(const config::Node& node,
                                                             const Context& context, double rate) {
  if (!node.has("direction_file")) return {};
  const LearnedModel model(node, "direction_file", context);
  if (model.card().rate != rate) model.fail("has another rate than that of model_file");
  sensing::BiotacLstm::Direction direction;
  direction.inputs = tactile_inputs_of(model);
  direction.outputs = model.outputs({{"nx", "1"}, {"ny", "1"}, {"nz", "1"}});
  direction.R_TN =
      node.pose({"direction_frame", "m",
                 "X_TN, pose of the frame in which the network of the direction predicts a normal"})
          .linear();
  direction.executor = model.make_executor();
  return direction;
}

config::OptionTable<sensing::BiotacLstm::Options> biotac_lstm_options() {
  using Options = sensing::BiotacLstm::Options;
  using sensing::ElectrodeScatter;
  return fingertip_options<Options>()
      .choice<ElectrodeScatter>("localisation",
                                "Positions of the electrodes: nominal, or randomly scattered about "
                                "them (gaussian: wider under pressure)",
                                {{"nominal", ElectrodeScatter::kNominal},
                                 {"gaussian", ElectrodeScatter::kGaussian},
                                 {"inverted_gaussian", ElectrodeScatter::kInvertedGaussian}},
                                &Options::scatter)
      .number("largest_force", "N",
              "Largest plausible force; a larger prediction is scaled down, and the model degraded",
              {0, 1000}, &Options::largest_force);
}

/// Null if the section names none.
std::unique_ptr<sensing::SensorModel> make_tactile_fallback(const config::Node& node) {
  if (!has_built_in_fallback(node, "biotac_linear")) {
    if (node.has("fallback_file")) node.fail("fallback_file", "needs fallback: biotac_linear");
    return nullptr;
  }
  if (!node.has("fallback_file")) node.fail("fallback", "needs fallback_file, a linear force map");
  return make_biotac_linear(node, "fallback_file");
}

}  // namespace

inference::TorchExecutorOptions read_inference(const config::Node& root, bool deterministic) {
  using Options = inference::TorchExecutorOptions;
  Options defaults;
  const int loop_priority = root.child_or_empty("loop").integer("fifo_priority", {0, 98},
                                                                loop::LoopOptions().fifo_priority);
  defaults.fifo_priority = std::max(0, loop_priority - 1);
  const Options options =
      root.child_or_empty({"inference", "", "Threads that run learned models"})
          .read(config::OptionTable<Options>(defaults)
                    .integer("priority",
                             "SCHED_FIFO priority of the inference threads; 0: ordinary scheduling",
                             {0, 98}, &Options::fifo_priority)
                    .integer("cpu", "Processor to which the inference threads are bound; -1: any",
                             {-1, 1023}, &Options::cpu));
  return deterministic ? Options() : options;
}

std::unique_ptr<sensing::SensorModel> make_biotac_lstm(const config::Node& node,
                                                       const Context& context) {
  const LearnedModel model(node, "model_file", context);
  sensing::BiotacLstm::Options options = node.read(biotac_lstm_options());
  options.inputs = tactile_inputs_of(model);
  options.outputs = model.outputs({{"fx", "N"}, {"fy", "N"}, {"fz", "N"}});
  options.rate = model.card().rate;
  auto direction = read_direction(node, context, options.rate);
  std::unique_ptr<sensing::SensorModel> fallback = make_tactile_fallback(node);
  auto learned =
      std::make_unique<sensing::BiotacLstm>(options, model.make_executor(), std::move(direction));
  if (!fallback) return learned;
  return std::make_unique<SensorFallback>(
      std::move(learned), std::move(fallback),
      "the network of the force fails or hangs: biotac_linear has taken over");
}

std::unique_ptr<sensing::SensorModel> make_ft_rnnob(const config::Node& node,
                                                    const Context& context) {
  const Frames& frames = frames_of(node, context);
  const LearnedModel model(node, "model_file", context);
  const inference::ModelCard& card = model.card();
  auto options = node.read(wrist_options<sensing::FtRnnob::Options>());
  options.inputs = observer_inputs_of(model);
  options.outputs = model.outputs(
      {{"fx", "N"}, {"fy", "N"}, {"fz", "N"}, {"tx", "N m"}, {"ty", "N m"}, {"tz", "N m"}});
  options.rate = card.rate;
  options.average = card.average;
  for (const inference::StreamDelay& delay : card.delays) {
    if (delay.stream != "inertial" && delay.stream != "force_torque")
      model.fail("names the delay of a stream '" + delay.stream +
                 "'; known: inertial, force_torque");
    (delay.stream == "inertial" ? options.inertial_delay : options.force_torque_delay) =
        delay.seconds;
  }
  options.network_gives_rest = card.payload.has_value();
  if (card.payload) options.payload = *card.payload;
  options.domain = card.domain;
  const bool given = node.has("payload");
  if (given) options.payload = read_payload(node);
  options.fall_back = has_built_in_fallback(node, "newton_euler");
  if (options.fall_back && !given && !card.payload)
    node.fail("fallback", "needs a payload, which neither the model's card nor this section has");
  if (given && !card.payload && !options.fall_back)
    node.fail("payload", "is used only by a fallback with this model, and there is none");

  options.period = context.period;
  options.gravity_W = frames.gravity_W;
  options.X_ES = frames.X_ES;
  options.X_EI = frames.X_EI;
  return std::make_unique<sensing::FtRnnob>(options, model.make_executor());
}

}  // namespace palpate::registry
