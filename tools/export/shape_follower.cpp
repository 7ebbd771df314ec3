#include "tools/export/shape_follower.hpp"

#include <algorithm>
#include <cmath>
#include <iostream>
#include <palpate/channels.hpp>
#include <stdexcept>

#include "rt/bus/checked_decode.hpp"
#include "rt/bus/text.hpp"

namespace palpate::exporting {
namespace {

/// How long a shape waits for the ground truth of its time.
constexpr std::int64_t kPatience = 200'000;  // us
constexpr double kSilence = 1;               // s

template <class T>
bool decoded(const Message& message, T& into) {
  return bus::decode(into, message.event.data, message.event.size);
}

template <class T>
void keep(const Message& message, std::optional<T>& into) {
  T value;
  if (decoded(message, value)) into = value;
}

void keep_moved(const Message& message, std::vector<world_state_t>& moved) {
  constexpr std::size_t kMost = contacts_t::MOST_OBSTACLES;
  world_state_t value;
  if (!decoded(message, value)) return;
  const std::string name = bus::get_text(value.name);
  const auto same = std::find_if(moved.begin(), moved.end(), [&](const world_state_t& one) {
    return name == bus::get_text(one.name);
  });
  if (same != moved.end()) moved.erase(same);
  if (moved.size() >= kMost) moved.erase(moved.begin());
  moved.push_back(value);
}

/// Entry of a channel with shapes, of the present or the former type; nullptr if there is none.
const ChannelSurvey* shapes_of(const Source& source, const std::string& channel) {
  for (const ChannelSurvey& entry : source.found().channels)
    if (entry.channel == channel && entry.type && entry.messages > entry.broken &&
        (entry.type->name == "shape_t" || entry.type->name == "shape_v1_t"))
      return &entry;
  return nullptr;
}

/// nullptr, with a warning, if the mesh cannot be evaluated.
std::unique_ptr<ShapeEvaluator> evaluator_of(const shape_mesh_t& mesh, const std::string& channel,
                                             Law law) {
  if (mesh.element_kind == shape_mesh_t::QUADRATIC_TETRAHEDRA && mesh.element_size == 4)
    std::cerr << "warning: " << channel
              << ": a former log, with the corner nodes of quadratic elements only: strain, stress "
                 "and forces are those of linear elements"
              << std::endl;
  try {
    if (mesh.elements.empty()) throw std::runtime_error("a mesh without elements");
    return std::make_unique<ShapeEvaluator>(log::mesh_of(mesh), law);
  } catch (const std::exception& error) {
    std::cerr << "warning: " << channel << ": " << error.what() << ": left out" << std::endl;
    return nullptr;
  }
}

}  // namespace

ShapeFollower::ShapeFollower(Source& source, const FollowerOptions& options)
    : source_(&source), options_(options) {
  has_estimate_ = shapes_of(source, channel::kShape) != nullptr;
  has_truth_ = shapes_of(source, channel::kTruthShape) != nullptr;
  if (!has_estimate_ && !has_truth_)
    throw std::runtime_error(
        "the log holds no shape (neither SHAPE nor TRUTH_SHAPE): was the log of the housekeeping "
        "URL given?");
  if (const ChannelSurvey* shapes = shapes_of(source, channel::kShape))
    has_deviation_ = shapes->widths[static_cast<std::size_t>(shapes->type->field("deviation"))] > 0;
  read_meshes(source);
  if (has_truth_ && truths_.empty()) {
    std::cerr << "warning: TRUTH_SHAPE without a complete TRUTH_MESH: the truth is left out\n";
    has_truth_ = false;
  }
  if (has_estimate_ && estimates_.empty()) {
    std::cerr << "warning: SHAPE without a complete SHAPE_MESH: the estimate is left out\n";
    has_estimate_ = false;
  }
  if (!has_estimate_ && !has_truth_)
    throw std::runtime_error("the log holds shapes but no complete mesh for them");
}

void ShapeFollower::read_meshes(Source& source) {
  bus::MeshAssembler estimates, truths;
  source.each_of(
      "reading meshes", {channel::kShapeMesh, channel::kTruthMesh}, [&](const Message& message) {
        shape_mesh_t chunk;
        if (!decoded(message, chunk)) return;
        const bool is_truth = message.event.channel == channel::kTruthMesh;
        bus::MeshAssembler& assembler = is_truth ? truths : estimates;
        auto& into = is_truth ? truths_ : estimates_;
        if (into.count(chunk.mesh_hash) > 0 || !assembler.add(chunk)) return;
        auto evaluator = evaluator_of(*assembler.find(chunk.mesh_hash), message.event.channel,
                                      is_truth ? Law::kNeoHookean : Law::kCorotational);
        if (evaluator) into[chunk.mesh_hash] = std::move(evaluator);
      });
  for (const auto* assembler : {&estimates, &truths})
    if (assembler->rejected() > 0)
      std::cerr << "warning: " << (assembler == &truths ? channel::kTruthMesh : channel::kShapeMesh)
                << ": " << assembler->rejected() << " inconsistent chunks: left out" << std::endl;
}

bool ShapeFollower::is_possible(const Source& source) {
  return shapes_of(source, channel::kShape) != nullptr ||
         shapes_of(source, channel::kTruthShape) != nullptr;
}

const std::vector<std::string>& ShapeFollower::channels() {
  static const std::vector<std::string> kChannels{
      channel::kShape,        channel::kTruthShape, channel::kContacts,    channel::kFeature,
      channel::kTruthContact, channel::kEstimate,   channel::kShapeTarget, channel::kRobotState,
      channel::kWorldState,   channel::kObstacles};
  return kChannels;
}

void ShapeFollower::begin() {
  latest_ = {};
  shape_chunks_ = truth_chunks_ = {};
  waiting_.clear();
  last_truth_.reset();
}

void ShapeFollower::end(const Take& take) {
  for (Instant& instant : waiting_) give(instant, take);
  waiting_.clear();
}

void ShapeFollower::each(const std::string& title, const Take& take) {
  begin();
  source_->each_of(title, channels(), [&](const Message& message) { follow(message, take); });
  end(take);
}

void ShapeFollower::follow(const Message& message, const Take& take) {
  const std::string& channel = message.event.channel;
  if (channel == channel::kShape || channel == channel::kTruthShape) {
    const bool is_truth = channel == channel::kTruthShape;
    shape_t chunk;
    if (!decoded(message, chunk)) return;
    const shape_t* shape = (is_truth ? truth_chunks_ : shape_chunks_).add(std::move(chunk));
    if (shape == nullptr) return;
    if (is_truth) {
      add_truth(*shape, message, take);
    } else {
      add_shape(*shape, message);
      settle(message.utime, take);
    }
  } else if (channel == channel::kContacts) {
    keep(message, latest_.contacts);
  } else if (channel == channel::kEstimate) {
    keep(message, latest_.estimated);
  } else if (channel == channel::kTruthContact) {
    keep(message, latest_.truth_contact);
  } else if (channel == channel::kFeature) {
    keep(message, latest_.feature);
  } else if (channel == channel::kShapeTarget) {
    keep(message, latest_.target);
  } else if (channel == channel::kObstacles) {
    keep(message, latest_.obstacles);
  } else if (channel == channel::kWorldState) {
    keep_moved(message, latest_.moved);
  } else {
    keep(message, latest_.robot);
  }
}

void ShapeFollower::add_shape(const shape_t& shape, const Message& message) {
  const auto mesh = estimates_.find(shape.mesh_hash);
  if (mesh == estimates_.end() ||
      3 * mesh->second->mesh().nodes.cols() != static_cast<Eigen::Index>(shape.xyz.size()))
    return;
  Instant instant = latest_;
  instant.time = message.time;
  instant.utime = message.utime;
  instant.received_utime = message.event.utime;
  instant.estimate_mesh = mesh->second.get();
  instant.estimate = log::positions(shape);
  instant.status = shape.status;
  if (static_cast<Eigen::Index>(shape.deviation.size()) == instant.estimate.cols())
    instant.node_deviation =
        Eigen::Map<const Eigen::VectorXf>(shape.deviation.data(), instant.estimate.cols())
            .cast<double>();
  waiting_.push_back(std::move(instant));
}

void ShapeFollower::add_truth(const shape_t& shape, const Message& message, const Take& take) {
  const auto mesh = truths_.find(shape.mesh_hash);
  if (mesh == truths_.end() ||
      3 * mesh->second->mesh().nodes.cols() != static_cast<Eigen::Index>(shape.xyz.size()))
    return;
  Truth truth{message.utime, message.event.utime, shape.mesh_hash, log::positions(shape)};
  if (!has_estimate_) {
    Instant instant = latest_;
    instant.time = message.time;
    instant.utime = truth.utime;
    instant.received_utime = truth.received_utime;
    instant.truth_mesh = mesh->second.get();
    instant.truth = truth.positions;
    give(instant, take);
    return;
  }
  while (!waiting_.empty() && waiting_.front().utime <= truth.utime) {
    if (last_truth_ && last_truth_->mesh == truth.mesh &&
        last_truth_->utime <= waiting_.front().utime &&
        truth.utime - last_truth_->utime <= kPatience)
      put_truth(waiting_.front(), *last_truth_, truth);
    give(waiting_.front(), take);
    waiting_.pop_front();
  }
  last_truth_ = std::move(truth);
}

/// Shapes whose waiting time has passed are output without truth.
void ShapeFollower::settle(std::int64_t now, const Take& take) {
  while (!waiting_.empty() && (!has_truth_ || waiting_.front().utime < now - kPatience)) {
    give(waiting_.front(), take);
    waiting_.pop_front();
  }
}

void ShapeFollower::put_truth(Instant& instant, const Truth& before, const Truth& after) {
  const auto span = static_cast<double>(after.utime - before.utime);
  const double s = span > 0 ? static_cast<double>(instant.utime - before.utime) / span : 1;
  instant.truth_mesh = truths_.at(after.mesh).get();
  instant.truth = (1 - s) * before.positions + s * after.positions;
  auto& places = places_[{instant.estimate_mesh->mesh().hash, after.mesh}];
  if (!places)
    places = std::make_unique<log::PlantPoints>(instant.truth_mesh->mesh(),
                                                instant.estimate_mesh->mesh().nodes);
  instant.deviation = instant.estimate - places->at(instant.truth);
}

void ShapeFollower::give(Instant& instant, const Take& take) {
  if (!source_->is_in_time(instant.time)) return;
  instant.stiffness = options_.stiffness;
  instant.truth_stiffness = options_.truth_stiffness;
  if (!instant.stiffness && instant.estimated && instant.estimated->log_young_modulus > 0)
    instant.stiffness =
        Stiffness{std::exp(instant.estimated->log_young_modulus), instant.estimated->poisson_ratio};
  take(instant);
}

void ShapeFollower::sample(const std::string& title, double rate, const Take& take) {
  if (!(rate > 0)) {
    each(title, take);
    return;
  }
  std::optional<Instant> held;
  double begin = 0;
  std::int64_t number = 0;
  // Outputs the pending shapes for times before `end`.
  const auto hand_out = [&](double end) {
    while (held && begin + static_cast<double>(number) / rate < end) {
      const double time = begin + static_cast<double>(number++) / rate;
      if (time > held->time + kSilence) continue;
      Instant shown = *held;
      shown.time = time;
      take(shown);
    }
  };
  each(title, [&](const Instant& instant) {
    if (!held) begin = std::max(instant.time, source_->options().from);
    hand_out(instant.time);
    held = instant;
  });
  if (held) hand_out(held->time + 1e-9);
}

QuantityText text_of(Quantity quantity) {
  static const QuantityText kTexts[] = {{},
                                        {"displacement", "mm", 1e3},
                                        {"deviation from truth", "mm", 1e3},
                                        {"standard deviation", "mm", 1e3},
                                        {"equivalent strain", "%", 100},
                                        {"von Mises stress", "kPa", 1e-3}};
  return kTexts[static_cast<std::size_t>(quantity)];
}

Eigen::VectorXd values_at_nodes(const Instant& instant, Quantity quantity) {
  const bool is_estimate = instant.estimate_mesh != nullptr;
  const ShapeEvaluator* evaluator = is_estimate ? instant.estimate_mesh : instant.truth_mesh;
  if (evaluator == nullptr) return {};
  const Eigen::Matrix3Xd& x = is_estimate ? instant.estimate : instant.truth;
  const auto& stiffness = is_estimate ? instant.stiffness : instant.truth_stiffness;
  switch (quantity) {
    case Quantity::kDisplacement:
      return (x - evaluator->mesh().nodes).colwise().norm();
    case Quantity::kDeviation:
      return instant.deviation.colwise().norm();
    case Quantity::kUncertainty:
      return instant.node_deviation;
    case Quantity::kStrain:
      return evaluator->at_nodes(evaluator->at(x, {}).equivalent_strain);
    case Quantity::kStress:
      if (!stiffness) return {};
      return evaluator->at_nodes(evaluator->at(x, stiffness).von_mises);
    case Quantity::kNone:
      break;
  }
  return {};
}

bool has_quantity(const Instant& instant, Quantity quantity) {
  const bool is_estimate = instant.estimate_mesh != nullptr;
  switch (quantity) {
    case Quantity::kDeviation:
      return instant.deviation.cols() > 0;
    case Quantity::kUncertainty:
      return instant.node_deviation.size() > 0;
    case Quantity::kStress:
      return (is_estimate ? instant.stiffness : instant.truth_stiffness).has_value();
    default:
      return true;
  }
}

}  // namespace palpate::exporting
