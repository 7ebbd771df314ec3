#include "tools/export/shape_follower.hpp"

#include <algorithm>
#include <cmath>
#include <iostream>
#include <palpate/channels.hpp>
#include <stdexcept>

#include "rt/bus/checked_decode.hpp"

namespace palpate::exporting {
namespace {

/// How long a shape waits for the ground truth of its time.
constexpr std::int64_t kPatience = 200'000;  // us
constexpr double kSilence = 1;               // s

template <class T>
bool decoded(const Message& message, T& into) {
  return bus::checked_decode(into, message.event.data, message.event.size);
}

template <class T>
void keep(const Message& message, std::optional<T>& into) {
  T value;
  if (decoded(message, value)) into = value;
}

bool has(const Source& source, const std::string& channel, const std::string& type) {
  for (const ChannelSurvey& entry : source.found().channels)
    if (entry.channel == channel && entry.type && entry.type->name == type &&
        entry.messages > entry.broken)
      return true;
  return false;
}

/// Whether everything that a mesh refers to is available; logs may come from any source.
bool is_sound(const log::MeshMessage& mesh) {
  const auto count = static_cast<int>(mesh.nodes.cols());
  const auto is_node = [count](int node) { return node >= 0 && node < count; };
  return mesh.nodes.allFinite() && mesh.elements.cols() > 0 &&
         std::all_of(mesh.triangles.data(), mesh.triangles.data() + mesh.triangles.size(),
                     is_node) &&
         std::all_of(mesh.constrained.begin(), mesh.constrained.end(), is_node);
}

/// nullptr, with a warning, if the chunks do not form a mesh.
std::unique_ptr<ShapeEvaluator> evaluator_of(const std::vector<shape_mesh_t>& chunks,
                                             const std::string& channel, Law law) {
  constexpr int kMostNodes = 10'000'000;
  try {
    if (chunks.front().corner_count <= 0 || chunks.front().corner_count > kMostNodes)
      throw std::runtime_error("mesh message without nodes");
    const log::MeshMessage mesh = log::assemble(chunks);
    if (!is_sound(mesh)) throw std::runtime_error("mesh message that names nodes that it has not");
    return std::make_unique<ShapeEvaluator>(mesh, law);
  } catch (const std::exception& error) {
    std::cerr << "warning: " << channel << ": " << error.what() << ": left out" << std::endl;
    return nullptr;
  }
}

}  // namespace

ShapeFollower::ShapeFollower(Source& source, const FollowerOptions& options)
    : source_(&source), options_(options) {
  has_estimate_ = has(source, channel::kShape, "shape_t");
  has_truth_ = has(source, channel::kTruthShape, "shape_t");
  if (!has_estimate_ && !has_truth_)
    throw std::runtime_error(
        "the log holds no shape (neither SHAPE nor TRUTH_SHAPE): was the log of the housekeeping "
        "URL given?");
  for (const ChannelSurvey& channel : source.found().channels)
    if (channel.channel == channel::kShape && channel.type && channel.type->name == "shape_t")
      has_deviation_ =
          channel.widths[static_cast<std::size_t>(channel.type->field("deviation"))] > 0;
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
  using Chunks = std::map<std::int64_t, std::map<int, shape_mesh_t>>;
  Chunks estimates, truths;
  source.each_of("reading meshes", {channel::kShapeMesh, channel::kTruthMesh},
                 [&](const Message& message) {
                   shape_mesh_t chunk;
                   if (!decoded(message, chunk)) return;
                   const bool is_truth = message.event.channel == channel::kTruthMesh;
                   const auto& known = is_truth ? truths_ : estimates_;
                   if (known.count(chunk.mesh_hash) > 0) return;
                   Chunks& chunks = is_truth ? truths : estimates;
                   auto& parts = chunks[chunk.mesh_hash];
                   const int count = chunk.chunks;
                   parts[chunk.chunk] = std::move(chunk);
                   if (static_cast<int>(parts.size()) < count) return;
                   std::vector<shape_mesh_t> all;
                   for (auto& [number, part] : parts) all.push_back(part);
                   auto evaluator = evaluator_of(all, message.event.channel,
                                                 is_truth ? Law::kNeoHookean : Law::kCorotational);
                   auto& into = is_truth ? truths_ : estimates_;
                   if (evaluator)
                     into[all.front().mesh_hash] = std::move(evaluator);
                   else
                     parts.clear();
                 });
}

bool ShapeFollower::is_possible(const Source& source) {
  return has(source, channel::kShape, "shape_t") || has(source, channel::kTruthShape, "shape_t");
}

const std::vector<std::string>& ShapeFollower::channels() {
  static const std::vector<std::string> kChannels{
      channel::kShape,        channel::kTruthShape, channel::kContacts,    channel::kFeature,
      channel::kTruthContact, channel::kEstimate,   channel::kShapeTarget, channel::kRobotState};
  return kChannels;
}

void ShapeFollower::begin() {
  latest_ = {};
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
    shape_t shape;
    if (!decoded(message, shape)) return;
    if (channel == channel::kShape) {
      add_shape(shape, message);
      settle(message.utime, take);
    } else {
      add_truth(shape, message, take);
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
