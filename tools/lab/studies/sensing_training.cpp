#include "tools/lab/studies/sensing_training.hpp"

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <palpate/channels.hpp>

#include "core/math/random.hpp"
#include "core/mesh/surface.hpp"
#include "rt/registry/object.hpp"
#include "tools/common/interruption.hpp"
#include "tools/common/output_files.hpp"
#include "tools/common/table.hpp"
#include "tools/lab/baselines/learning/learned_shape.hpp"
#include "tools/lab/baselines/learning/neural_gas.hpp"
#include "tools/lab/runs/live_run.hpp"
#include "tools/lab/studies/sensing_recording.hpp"
#include "tools/log/plant_truth.hpp"

namespace palpate::studies {

namespace fs = std::filesystem;
using baselines::LearnedShape;

struct TrainSensingCommand::Options {
  fs::path plan, output = "out/train-sensing";
};

TrainSensingCommand::TrainSensingCommand(CLI::App& app)
    : options_(std::make_unique<Options>()),
      command_(app.add_subcommand("train-sensing",
                                  "trains the networks of the published methods that learn a "
                                  "shape, on recordings of motions "
                                  "that no study runs; writes a model for each object and "
                                  "method.\nExample: palpate-evaluate "
                                  "train-sensing --output out/train-sensing")) {
  Options& o = *options_;
  command_
      ->add_option("--plan", o.plan, "(default: tools/lab/studies/published_sensing_training.yaml)")
      ->check(CLI::ExistingFile);
  command_->add_option("--output", o.output, "folder of recordings and models")
      ->capture_default_str();
}

TrainSensingCommand::~TrainSensingCommand() = default;

namespace {

constexpr double kEvery = 0.02;       // s, between two samples
constexpr double kValidation = 0.25;  // fraction of the recording, in blocks of it
constexpr int kBlocks = 12;
constexpr double kReplayPatience = 600;  // s

struct Samples {
  Eigen::MatrixXd inputs, outputs, held_inputs, held_outputs;
};

/// Poses distributed over a box, as a motion of a scene.
std::string random_motion(const config::Node& node, int seed) {
  math::Random random(static_cast<std::uint64_t>(seed), "poses");
  const Eigen::Vector3d way = node.vector3("translation", {0, 1}),
                        turn = node.vector3("rotation_deg", {0, 180});
  std::string text = "motion={start_delay: 0.5, poses: [";
  for (int i = 0; i < node.integer("poses", {4, 200}); ++i) {
    const auto any = [&random](const Eigen::Vector3d& most) {
      std::string numbers;
      for (int k = 0; k < 3; ++k)
        numbers += (k > 0 ? ", " : "") + std::to_string(random.uniform(-most[k], most[k]));
      return "[" + numbers + "]";
    };
    const std::string name = "L" + std::to_string(i + 1), place = any(way);
    text += (i > 0 ? ", " : "") + ("{name: " + name) +
            ", move: 1.8, hold: 0.4, translation: " + place + ", rotation_deg: " + any(turn) + "}";
  }
  return text + "]}";
}

math::Pose grasp_of(const estimate_t& m) {
  math::Pose X = math::Pose::Identity();
  X.translation() = Eigen::Map<const Eigen::Vector3d>(m.grasp_position[0]);
  const double* q = m.grasp_quaternion[0];
  X.linear() = Eigen::Quaterniond(q[0], q[1], q[2], q[3]).toRotationMatrix();
  return X;
}

/// The pipeline's hand pose and wrench in a replay of the recording, with the ground truth.
Samples gather(const SensingScene& scene, const SensingRecording& recording,
               const registry::Object& object, const Eigen::Matrix3Xd& units,
               LearnedShape::Inputs inputs, const fs::path& folder) {
  std::vector<estimate_t> estimates;
  std::vector<contacts_t> contacts;
  log::LogReader reader(log::LogClock::kSent);
  reader.collect(channel::kEstimate, estimates);
  reader.collect(channel::kContacts, contacts);
  replay(scene, recording, {}, folder, kReplayPatience, reader);
  if (estimates.size() < 100) throw runs::RunFailed("the replay contains no hand poses");
  const log::PlantPoints points(log::assemble(recording.truth.truth_chunks), units);
  const log::PlantMotion motion(recording.truth.truths);
  const std::int64_t begin = estimates.front().utime, end = estimates.back().utime;
  std::vector<Eigen::VectorXd> in[2], out[2];
  Eigen::Matrix3Xd plant;
  for (std::int64_t t = begin; t < end; t += static_cast<std::int64_t>(kEvery * 1e6)) {
    const contacts_t* felt = log::latest(contacts, t);
    if (felt == nullptr || felt->count < 1 || !motion.at(t, plant)) continue;
    Eigen::VectorXd input(LearnedShape::input_count(inputs));
    LearnedShape::gather(inputs, Eigen::Map<const Eigen::Vector3d>(felt->wrench[0]),
                         grasp_of(*log::latest(estimates, t)), object.body.grasps[0].X_OG_rest,
                         input);
    const Eigen::Matrix3Xd moved = points.at(plant) - units;
    const double place =
        kBlocks * static_cast<double>(t - begin) / static_cast<double>(end - begin);
    const int held = place - std::floor(place) < kValidation ? 1 : 0;
    in[held].push_back(input);
    out[held].emplace_back(moved.reshaped());
  }
  const auto columns = [](const std::vector<Eigen::VectorXd>& all) {
    if (all.empty()) throw runs::RunFailed("the recording gives no samples");
    Eigen::MatrixXd matrix(all.front().size(), static_cast<Eigen::Index>(all.size()));
    for (std::size_t i = 0; i < all.size(); ++i) matrix.col(static_cast<Eigen::Index>(i)) = all[i];
    return matrix;
  };
  return {columns(in[0]), columns(out[0]), columns(in[1]), columns(out[1])};
}

double mean_error(const baselines::ShapeNetwork& net, const Samples& samples) {
  Eigen::VectorXd room(net.hidden.rows()), result(net.outputs());
  double sum = 0;
  for (Eigen::Index i = 0; i < samples.held_inputs.cols(); ++i) {
    net.evaluate(samples.held_inputs.col(i), room, result);
    sum += (result - samples.held_outputs.col(i))
               .reshaped(3, net.outputs() / 3)
               .colwise()
               .norm()
               .mean();
  }
  return sum / static_cast<double>(samples.held_inputs.cols());
}

nlohmann::json row_by_row(const Eigen::MatrixXd& matrix) {
  nlohmann::json all = nlohmann::json::array();
  for (Eigen::Index r = 0; r < matrix.rows(); ++r)
    for (Eigen::Index c = 0; c < matrix.cols(); ++c)
      all.push_back(std::round(matrix(r, c) * 1e7) / 1e7);
  return all;
}

void write_model(const LearnedShape::Model& model, const std::string& card, const fs::path& file) {
  std::ofstream out(file);
  const baselines::ShapeNetwork& net = model.network;
  out << "card: " << nlohmann::json(card).dump()
      << "\ninputs: " << (model.inputs == LearnedShape::Inputs::kAngle ? "angle" : "position")
      << "\nunits: " << model.units.cols() << "\nhidden: " << net.hidden.rows() << '\n';
  const std::pair<const char*, Eigen::MatrixXd> parts[] = {
      {"places", model.units.transpose()}, {"input_mean", net.input_mean},
      {"input_scale", net.input_scale},    {"hidden_weights", net.hidden},
      {"output_weights", net.output},      {"output_mean", net.output_mean},
      {"output_scale", net.output_scale}};
  for (const auto& [key, matrix] : parts) out << key << ": " << row_by_row(matrix).dump() << '\n';
  if (!out) throw runs::RunFailed(file.string() + " cannot be written");
}

}  // namespace

std::optional<int> TrainSensingCommand::run(const fs::path& root, std::ostream& out) {
  if (!command_->parsed()) return std::nullopt;
  const Options& o = *options_;
  const config::Node plan = config::Node::load_file(
      (o.plan.empty() ? root / "tools/lab/studies/published_sensing_training.yaml" : o.plan)
          .string());
  const int seed = plan.integer("seed", {0, 1e9});
  baselines::NeuralGasOptions gas;
  gas.units = plan.integer("units", {2, 300}, gas.units);
  baselines::ShapeTrainingOptions training;
  training.hidden = plan.integer("hidden", {1, 500}, training.hidden);
  training.epochs = plan.integer("epochs", {1, 1e6}, training.epochs);
  common::catch_interruptions();
  common::Table table(
      {"object", "inputs", "samples", "mean error on blocks not trained on, mm", "model"});
  for (const config::Node& node : plan.list("objects")) {
    const std::string name = node.text("name");
    SensingScene scene;
    scene.scene = root / node.text("scene");
    scene.configuration = root / node.text("configuration");
    scene.scene_overrides = {random_motion(node.child("motion"), seed),
                             "seed=" + std::to_string(seed)};
    const fs::path folder = fs::absolute(o.output) / common::file_name(name);
    const SensingRecording recording = record_sensing(scene, folder);
    const config::Node configuration = config::Node::load_file(scene.configuration.string());
    const registry::Object object =
        registry::read_object(configuration, registry::read_frames(configuration));
    const Eigen::Matrix3Xd surface = object.body.mesh.nodes(Eigen::all, object.surface.nodes);
    for (const LearnedShape::Inputs inputs :
         {LearnedShape::Inputs::kPosition, LearnedShape::Inputs::kAngle}) {
      LearnedShape::Model model;
      model.inputs = inputs;
      const math::Random random(static_cast<std::uint64_t>(seed), name);
      model.units = baselines::grow_neural_gas(surface, gas, random.split("gas")).units;
      const Samples samples = gather(scene, recording, object, model.units, inputs, folder);
      model.network =
          baselines::train_shape_network(samples.inputs, samples.outputs, samples.held_inputs,
                                         samples.held_outputs, training, random.split("network"));
      const bool by_angle = inputs == LearnedShape::Inputs::kAngle;
      const fs::path file =
          fs::absolute(o.output) /
          (common::file_name(name) + (by_angle ? "_angle" : "_position") + ".yaml");
      const double error = mean_error(model.network, samples);
      write_model(model,
                  "palpate-evaluate train-sensing, " + name + ", seed " + std::to_string(seed) +
                      ", version " PALPATE_VERSION ", mean error " +
                      common::number(error * 1e3, 2) + " mm on blocks that it was not trained on",
                  file);
      table.add({name, by_angle ? "angle" : "position",
                 std::to_string(samples.inputs.cols() + samples.held_inputs.cols()),
                 common::number(error * 1e3, 2), file.filename().string()});
    }
  }
  plan.check_all_used();
  table.print(out);
  return 0;
}

}  // namespace palpate::studies
