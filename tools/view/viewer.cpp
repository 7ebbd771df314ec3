#include "tools/view/viewer.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "core/sensing/biotac_geometry.hpp"
#include "tools/view/obstacles.hpp"

namespace palpate::view {

using nlohmann::json;

namespace {

json describe_slots() {
  json slots = json::array();
  for (const SlotChoices& slot : slot_choices()) {
    json choices = json::array();
    for (const Choice& choice : slot.choices)
      choices.push_back({{"key", choice.key}, {"names", choice.names}});
    slots.push_back({{"slot", slot.slot}, {"instances", slot.has_instances}, {"choices", choices}});
  }
  return slots;
}

json describe_configured(const std::vector<Configured>& configured) {
  json list = json::array();
  for (const Configured& one : configured) {
    json chosen = json::object();
    for (const auto& [key, name] : one.chosen) chosen[key] = name;
    list.push_back({{"slot", one.slot}, {"instance", one.instance}, {"chosen", chosen}});
  }
  return list;
}

template <class Vector>
json list_of(const Vector& v) {
  json list = json::array();
  for (Eigen::Index i = 0; i < v.size(); ++i) list.push_back(v[i]);
  return list;
}

json describe_robot(const drawing::RobotDrawing& drawing) {
  json shapes = json::array();
  for (const drawing::LinkShape& shape : drawing.shapes()) {
    const Eigen::Quaterniond q(shape.X_LV.linear());
    shapes.push_back({{"link", shape.link},
                      {"kind", shape.kind},
                      {"size", list_of(shape.size)},
                      {"at", list_of(Eigen::Vector3d(shape.X_LV.translation()))},
                      {"quaternion", list_of(Eigen::Vector4d(q.coeffs()))},
                      {"colour", list_of(shape.colour)}});
  }
  return {{"links", drawing.link_count()}, {"shapes", shapes}};
}

/// Positions of the electrodes E1 to E19 on the unrolled skin, mm: along the finger towards the
/// tip, and around it.
json describe_electrodes() {
  json list = json::array();
  for (int i = 0; i < sensing::kElectrodeCount; ++i) {
    const Eigen::Vector3d position = sensing::electrode_positions().col(i);
    // Along the radius to the skin: a cylinder up to the tip's sphere, on which circles of latitude
    // shrink.
    const double from_axis = std::hypot(position.y(), position.z());
    const double latitude = std::atan2(std::fmax(position.x(), 0), from_axis);
    const double around = std::atan2(position.y(), -position.z());
    list.push_back({1e3 * (std::fmin(position.x(), 0) + sensing::kSkinRadius * latitude),
                    1e3 * sensing::kSkinRadius * std::cos(latitude) * around});
  }
  return list;
}

json describe_log(const LogSource& log) {
  json series = json::array();
  for (const Series& one : log.series())
    series.push_back(
        {{"name", one.name}, {"unit", one.unit}, {"time", one.time_s}, {"value", one.value}});
  return {{"duration", log.duration()},
          {"begin_us", log.begin_us()},
          {"series", series},
          {"marks", log.marks()}};
}

}  // namespace

Viewer::Viewer(Options options, serve::Token token)
    : options_(std::move(options)), token_(std::move(token)), rate_(options_.rate) {}

void Viewer::show_live(std::unique_ptr<LiveSource> source) { live_ = std::move(source); }

void Viewer::show_log(std::unique_ptr<LogSource> source) {
  log_ = std::move(source);
  log_->go_to(0, scene_);
}

void Viewer::advance(std::int64_t now_us) {
  if (live_) live_->receive(scene_);
  if (log_) {
    const double passed = played_us_ == 0 ? 0 : static_cast<double>(now_us - played_us_) * 1e-6;
    played_us_ = now_us;
    // After a suspension of the machine, playback does not skip the time in between.
    constexpr double kLongestStep = 0.5;
    if (playing_) log_->go_to(log_->time() + rate_ * std::clamp(passed, 0.0, kLongestStep), scene_);
    if (log_->time() >= log_->duration()) playing_ = false;
  }
  if (daemon_) daemon_->service(now_us);
}

void Viewer::prepare(std::int64_t now_us) {
  scene_.refresh();
  ++frames_;
  parcels_.clear();
  if (live_) history_.sample(scene_, now_us);
  list_messages(now_us);
  if (scene_.shape.count != painted_count_) repaint(estimate_, scene_.shape.get());
  if (scene_.truth.count != painted_truth_count_) repaint(truth_, scene_.truth.get());
  painted_count_ = scene_.shape.count;
  painted_truth_count_ = scene_.truth.count;
  // The mesh may become known only after shapes of it.
  for (auto [painted, shape] :
       {std::pair{&estimate_, scene_.shape.get()}, std::pair{&truth_, scene_.truth.get()}})
    if (shape && !painted->evaluator) repaint(*painted, shape);
  const shape_t *shape = scene_.shape.get(), *truth = scene_.truth.get();
  if (shape && truth && estimate_.evaluator && truth_.evaluator &&
      shape->mesh_hash == estimate_.hash && truth->mesh_hash == truth_.hash)
    shape_error_.take(estimate_.evaluator->mesh(), *shape, truth_.evaluator->mesh(), *truth);
}

void Viewer::list_messages(std::int64_t now_us) {
  constexpr std::int64_t kInterval = 250'000;  // us, for legibility
  if (scene_.described().types().empty() || now_us - messages_us_ < kInterval) return;
  messages_us_ = now_us;
  messages_ =
      serve::dump({{"type", "messages"},
                   {"messages", to_json(scene_.described(), log_ ? log_time_us() : now_us)}});
  ++messages_number_;
}

/// The shape has changed: all values are outdated, and with another mesh everything is.
void Viewer::repaint(Painted& painted, const shape_t* shape) {
  painted.done.clear();
  if (!shape) return;
  if (painted.evaluator && painted.hash == shape->mesh_hash) return;
  painted.evaluator.reset();
  const auto mesh = scene_.meshes().find(shape->mesh_hash);
  if (!mesh) return;
  painted.hash = shape->mesh_hash;
  painted.evaluator = std::make_unique<FieldEvaluator>(mesh);
}

/// nullptr if the field cannot be computed for this shape.
const std::vector<float>* Viewer::paint(Painted& painted, const shape_t& shape, Field field) {
  const bool is_truth = &painted == &truth_;
  if (field == Field::kUncertainty)
    return is_truth || shape.deviation.empty() ? nullptr : &shape.deviation;
  std::vector<float>& values = painted.values[static_cast<std::size_t>(field)];
  if (painted.done.count(field) > 0) return values.empty() ? nullptr : &values;
  values.clear();
  painted.done.insert(field);
  const bool has_elements = painted.evaluator->has_elements();
  switch (field) {
    case Field::kDisplacement:
      painted.evaluator->displacement(shape.xyz, values);
      break;
    case Field::kStrain:
      if (has_elements) painted.evaluator->strain(shape.xyz, values);
      break;
    case Field::kStress: {
      // Ground-truth material is not published.
      const estimate_t* estimate = scene_.estimate.get();
      if (is_truth || !has_elements || !estimate) break;
      const double E = std::exp(estimate->log_young_modulus), nu = estimate->poisson_ratio;
      if (!std::isfinite(E) || !(E > 0 && nu > -1 && nu < 0.4999)) break;
      try {
        painted.evaluator->stress(shape.xyz, E, nu, values);
      } catch (const std::invalid_argument&) {
        values.clear();  // a mesh without a valid body
      }
      break;
    }
    case Field::kUncertainty:
      break;
  }
  return values.empty() ? nullptr : &values;
}

std::string Viewer::greeting(std::int64_t now_us) const {
  json robots = json::array();
  for (const auto& robot : options_.cell.robots) robots.push_back(describe_robot(robot->drawing));
  json hello = {{"type", "hello"},
                {"version", PALPATE_VERSION},
                {"mode", log_ ? "log" : "live"},
                {"control", options_.control && daemon_ != nullptr},
                {"max_force", options_.max_force},
                {"slots", describe_slots()},
                {"configured", describe_configured(options_.cell.configured)},
                {"robots", robots},
                {"electrodes", describe_electrodes()},
                {"history", history_.to_json(now_us)}};
  if (options_.cell.X_WO) {
    const math::Pose X_OW = options_.cell.X_WO->inverse();
    hello["base"] = {{"at", list_of(Eigen::Vector3d(X_OW.translation()))},
                     {"quaternion", list_of(Eigen::Quaterniond(X_OW.linear()).coeffs())}};
  }
  if (log_) hello["log"] = describe_log(*log_);
  return serve::dump(hello);
}

void Viewer::add_meshes(ViewerClient& client, serve::Delivery& delivery) const {
  const auto add = [&](const Painted& painted, const char* role, std::int64_t& sent) {
    if (!painted.evaluator || sent == painted.hash) return;
    delivery.parcels.push_back(
        std::make_shared<const std::string>(encode_mesh(role, painted.evaluator->mesh())));
    sent = painted.hash;
  };
  add(estimate_, "estimate", client.mesh);
  add(truth_, "truth", client.truth_mesh);
}

void Viewer::add_obstacles(ViewerClient& client, serve::Delivery& delivery) const {
  if (client.has_obstacles) return;
  client.has_obstacles = true;
  const std::vector<drawing::ObstacleDrawing>& obstacles = options_.cell.obstacles;
  for (std::size_t i = 0; i < obstacles.size(); ++i)
    delivery.parcels.push_back(
        std::make_shared<const std::string>(encode_obstacle(static_cast<int>(i), obstacles[i])));
}

serve::Delivery Viewer::deliver(serve::Client& page, std::int64_t now_us) {
  auto& client = static_cast<ViewerClient&>(page);
  serve::Delivery delivery;
  json events = json::array();
  for (const NumberedEvent& event : scene_.events())
    if (event.number > client.events) events.push_back(to_json(event));
  const bool reset = client.generation != scene_.generation();
  client.generation = scene_.generation();
  if (!events.empty()) client.events = scene_.events().back().number;
  if (!events.empty() || reset)
    delivery.texts.push_back(
        serve::dump({{"type", "events"}, {"reset", reset}, {"events", events}}));
  if (client.messages != messages_number_) delivery.texts.push_back(messages_);
  client.messages = messages_number_;
  add_meshes(client, delivery);
  add_obstacles(client, delivery);
  delivery.frame = frames_;
  const bool with_health = client.health != scene_.health.count;
  client.health = scene_.health.count;
  auto& parcel = parcels_[{client.field, with_health}];
  if (!parcel)
    parcel = std::make_shared<const std::string>(frame(client.field, with_health, now_us));
  delivery.parcels.push_back(parcel);
  return delivery;
}

std::int64_t Viewer::log_time_us() const {
  return log_->begin_us() + static_cast<std::int64_t>(log_->time() * 1e6);
}

json Viewer::state(bool with_health, std::int64_t now_us) const {
  const std::int64_t shown_us = log_ ? log_time_us() : now_us;
  json head = {{"type", "frame"}, {"frame", frames_}, {"time_us", shown_us}};
  const auto age = [&](const auto& latest) {
    return static_cast<double>(std::max<std::int64_t>(shown_us - latest.time_us, 0) / 1000);
  };
  if (const shape_t* shape = scene_.shape.get())
    head["shape"] = {{"status", shape->status},
                     {"age_ms", age(scene_.shape)},
                     {"count", scene_.shape.count},
                     {"deviations", shape->deviation_count > 0},
                     {"delay_ms", static_cast<double>(scene_.shape.time_us - shape->utime) * 1e-3}};
  constexpr double kShown = 300;  // ms, low-pass filtered
  if (const auto* m = scene_.contacts.get(); m && age(scene_.contacts) < kShown) {
    head["contacts"] = to_json(*m);
    if (m->obstacle_count > 0) head["predicted"] = predicted_json(*m);
  }
  if (const auto* m = scene_.estimate.get()) head["estimate"] = to_json(*m);
  if (const auto* m = scene_.discrepancy.get(); m && m->test >= 0 && age(scene_.discrepancy) < kOld)
    head["discrepancy"] = to_json(*m);
  if (const auto* m = scene_.feature.get()) head["feature"] = to_json(*m);
  if (const auto* m = scene_.truth_contact.get(); m && age(scene_.truth_contact) < kShown)
    head["truth_contacts"] = to_json(*m);
  if (const auto* m = scene_.manual.get(); m && age(scene_.manual) < kShown)
    head["push"] = {{"at", m->rest_point}, {"force", m->force}};
  if (const auto* m = scene_.twist.get(); m && age(scene_.twist) < kShown)
    head["twist"] = {{"valid", m->valid == 1}, {"twist", m->twist}};
  if (const auto* m = scene_.health.get()) {
    head["health_age_ms"] = age(scene_.health);
    if (with_health) head["health"] = to_json(*m);
  }
  if (const auto& error = shape_error_.last();
      error && age(scene_.shape) < kOld && age(scene_.truth) < kOld)
    head["shape_error"] = {{"mean", error->mean},
                           {"rms", error->rms},
                           {"largest", error->largest},
                           {"by_arrival", error->by_arrival}};
  for (const Fingertip& fingertip : scene_.fingertips) {
    const biotac_t* m = fingertip.get();
    if (!m) continue;
    json one = to_json(*m);
    one["channel"] = fingertip.channel;
    one["age_ms"] = age(fingertip);
    head["fingertips"].push_back(std::move(one));
  }
  if (log_)
    head["player"] = {{"time", log_->time()},
                      {"duration", log_->duration()},
                      {"playing", playing_},
                      {"rate", rate_}};
  return head;
}

std::string Viewer::frame(Field field, bool with_health, std::int64_t now_us) {
  json head = state(with_health, now_us);
  const shape_t* shape = scene_.shape.get();
  const shape_t* truth = scene_.truth.get();
  const bool has_shape =
      shape && estimate_.evaluator && shape->node_count == estimate_.evaluator->mesh().node_count;
  const bool has_truth =
      truth && truth_.evaluator && truth->node_count == truth_.evaluator->mesh().node_count;
  head["field"] = name(field);
  if (has_shape) head["mesh"] = serve::hash_text(estimate_.hash);
  if (has_truth) head["truth_mesh"] = serve::hash_text(truth_.hash);
  const Cell& cell = options_.cell;
  std::vector<float> obstacle_poses;  // until the parcel is finished, as all arrays
  if (cell.X_WO && !cell.obstacles.empty())
    head["obstacles"] =
        describe_places(cell.obstacles, *cell.X_WO, scene_, head["time_us"], obstacle_poses);
  serve::Parcel parcel(std::move(head));
  if (has_shape) {
    parcel.add("x", shape->xyz);
    if (const auto* values = paint(estimate_, *shape, field)) parcel.add("values", *values);
  }
  if (has_truth) {
    parcel.add("truth_x", truth->xyz);
    if (const auto* values = paint(truth_, *truth, field)) parcel.add("truth_values", *values);
  }
  if (!obstacle_poses.empty()) parcel.add("obstacle_poses", obstacle_poses);
  std::array<std::vector<float>, 2> links;
  for (std::size_t arm = 0; arm < cell.robots.size(); ++arm) {
    const robot_state_t* robot = scene_.robot[arm].get();
    if (!robot) continue;
    const hand_state_t* hand = scene_.hand[arm].get();
    const PlacedRobot& placed = *cell.robots[arm];
    placed.drawing.place(placed.X_OW, robot->q, robot->joint_count, hand ? hand->q : nullptr,
                         hand ? hand->joint_count : 0, links[arm]);
    parcel.add(arm == 0 ? "links" : "links_1", links[arm]);
  }
  std::vector<float> points;
  if (const auto* seen = scene_.observation.get();
      seen && seen->count > 0 && cell.X_WO &&
      (log_ || now_us - scene_.observation.time_us < 1'000'000)) {
    const math::Pose X_OW = cell.X_WO->inverse();
    for (int i = 0; i < seen->count; ++i) {
      const Eigen::Vector3d p = X_OW * Eigen::Vector3f::Map(seen->points[i]).cast<double>();
      for (const double c : {p.x(), p.y(), p.z()}) points.push_back(static_cast<float>(c));
    }
    parcel.add("seen", points);
  }
  for (const Fingertip& fingertip : scene_.fingertips)
    if (!fingertip.pac.empty()) parcel.add(fingertip.channel + std::string("_pac"), fingertip.pac);
  return parcel.finish();
}

}  // namespace palpate::view
