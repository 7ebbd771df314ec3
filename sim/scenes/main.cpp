// palpate-sim: arm, hand, soft object and sensors, on the channels of real hardware.

#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <atomic>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <lcm/lcm-cpp.hpp>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "rt/bus/authentication.hpp"
#include "rt/bus/instance_lock.hpp"
#include "rt/config/command_line.hpp"
#include "sim/scenes/pacing.hpp"
#include "sim/scenes/run_recorder.hpp"
#include "sim/scenes/simulation.hpp"
#include "sim/scenes/soft_box_plant.hpp"

namespace {

namespace bus = palpate::bus;
using palpate::scenes::LockStep;
using palpate::scenes::RealTimePacer;
using palpate::scenes::RunRecorder;
using palpate::scenes::Simulation;
using Clock = std::chrono::steady_clock;

std::atomic<bool> stop{false};
static_assert(std::atomic<bool>::is_always_lock_free);

struct Options {
  std::string scene;
  std::vector<std::string> overrides;
  std::string json;
  std::string record;   // folder; empty: messages go to the network
  double duration = 0;  // s, 0: until a signal
  bool fast = false;
};

/// Where the messages of a run go to.
class Buses {
 public:
  Buses(const Options& options, const palpate::scenes::Scene& scene) {
    const palpate::scenes::BusUrls& urls = scene.bus;
    const bool has_clouds = scene.camera && scene.camera->cloud_stride > 0;
    if (!options.record.empty()) {
      recorder_.emplace(options.record, has_clouds);
      name_channels(urls.channels);
      return;
    }
    lock_.emplace(urls.control, "palpate-sim");
    control_ = bus::make_lcm_bus(urls.control);
    housekeeping_ = bus::make_lcm_bus(urls.housekeeping);
    name_channels(urls.channels);
    if (!has_clouds) return;
    clouds_ = std::make_unique<lcm::LCM>(urls.clouds);
    if (!clouds_->good())
      throw std::runtime_error("bus.clouds: liblcm cannot open " + urls.clouds +
                               "; its message is above");
  }

  bus::MessageBus& control() { return recorder_ ? recorder_->control() : *control_; }
  bus::MessageBus& housekeeping() { return recorder_ ? recorder_->housekeeping() : *housekeeping_; }
  palpate::scenes::CloudSink clouds() {
    return [this](const std::string& channel, const std::vector<std::uint8_t>& message,
                  std::int64_t utime) {
      if (recorder_) return recorder_->write_cloud(channel, message, utime);
      // A cloud that is lost is as one that the network loses.
      clouds_->publish(channel, message.data(), static_cast<unsigned>(message.size()));
    };
  }
  /// nullptr: messages go to the network.
  RunRecorder* recorder() { return recorder_ ? &*recorder_ : nullptr; }

 private:
  void name_channels(const bus::ChannelNames& names) {
    control().set_channel_names(names);
    housekeeping().set_channel_names(names);
  }

  std::optional<RunRecorder> recorder_;
  std::optional<bus::InstanceLock> lock_;
  std::unique_ptr<bus::MessageBus> control_, housekeeping_;
  std::unique_ptr<lcm::LCM> clouds_;  // sends alone: what receives through liblcm can be crashed
};

nlohmann::json run_real_time(Simulation& simulation, bus::MessageBus& control, std::int64_t ticks) {
  simulation.let_camera_lag();
  RealTimePacer pacer(1000 * Simulation::kPeriodUs);
  while (!stop && simulation.tick() < ticks) {
    pacer.wait();
    control.receive(0);
    simulation.step();
  }
  return {{"mode", "real time"},
          {"overruns", pacer.overruns()},
          {"worst_lateness_ms", 1e-6 * pacer.worst_lateness_ns()},
          {"time_lost_ms", 1e-6 * pacer.lost_ns()}};
}

/// Computes a tick while the daemon processes the previous one. Commands are taken between its
/// answer and the next tick's messages, so that the answer to tick k acts in tick k + 2 regardless
/// of the machine's speed, and a tick's messages are sent after the daemon has finished with the
/// previous ones.
nlohmann::json run_fast(Simulation& simulation, LockStep& lock_step, std::int64_t ticks) {
  if (simulation.tick() < ticks) simulation.advance();
  while (!stop) {
    const std::int64_t tick = simulation.tick();
    simulation.publish();
    lock_step.send(tick, Simulation::kPeriodUs, simulation.utime());
    simulation.publish_truth();
    if (tick < ticks) simulation.advance();
    const LockStep::Answer answer = lock_step.wait(stop);
    if (answer == LockStep::Answer::kNone)
      throw std::runtime_error("no answer to SIM_TICK " + std::to_string(tick) + " for " +
                               std::to_string(LockStep::kPatience) +
                               " s: is palpated running with --stepped on " +
                               simulation.scene().bus.control + "?");
    if (tick == ticks) break;
    simulation.obey();
  }
  return {{"mode", "lock-step"}, {"ticks_sent_again", lock_step.repeats()}};
}

/// Without a daemon, as fast as it goes.
nlohmann::json run_recorded(Simulation& simulation, RunRecorder& recorder, std::int64_t ticks) {
  while (!stop && simulation.tick() < ticks) {
    simulation.step();
    recorder.write(simulation.utime());
  }
  return {{"mode", "recorded"}};
}

void report(const Simulation& simulation, const nlohmann::json& result) {
  std::printf("simulated %.3f s in %.3f s, real-time factor %.3f",
              result["simulated_s"].get<double>(), result["wall_s"].get<double>(),
              result["real_time_factor"].get<double>());
  if (result.contains("overruns"))
    std::printf(", %lld overruns, at most %.1f ms late, %.1f ms lost",
                result["overruns"].get<long long>(), result["worst_lateness_ms"].get<double>(),
                result["time_lost_ms"].get<double>());
  std::printf("\ncommands: %lld accepted, %lld rejected (%lld without access), %lld lost\n",
              static_cast<long long>(simulation.commands().accepted()),
              static_cast<long long>(simulation.commands().rejected()),
              static_cast<long long>(simulation.commands().unauthorised()),
              static_cast<long long>(simulation.commands().lost()));
  if (simulation.camera() != nullptr)
    std::printf("camera: %lld pictures left out because one was still being drawn\n",
                static_cast<long long>(simulation.camera()->left_out()));
}

int run(const Options& options) {
  const auto node = palpate::config::Node::load_file(options.scene, options.overrides);
  const palpate::scenes::Scene scene = palpate::scenes::read_scene(node);
  if (!options.record.empty() && !scene.motion)
    throw palpate::config::Error(options.scene + ": --record needs a scene with a motion");
  Buses buses(options, scene);
  const palpate::scenes::Origin origin{bus::random_session(), 0};
  Simulation simulation(node, buses.control(), buses.housekeeping(), origin, buses.clouds());
  LockStep lock_step(buses.control(), origin.session);
  buses.control().start_without_thread();  // the housekeeping bus is only written
  spdlog::info("palpate-sim {}: {} nodes, {}", PALPATE_VERSION,
               simulation.object().positions().cols(),
               simulation.scene().motion ? "moves by itself" : "obeys commands");
  for (const std::string& remark : simulation.robot().remarks()) spdlog::warn("{}", remark);
  for (const std::string& remark : simulation.object().remarks()) spdlog::warn("{}", remark);
  spdlog::info("DART's arm: {}", simulation.robot().effective_options());
  if (const auto* soft = dynamic_cast<const palpate::scenes::SoftBoxPlant*>(&simulation.object())) {
    spdlog::info("DART's soft body: {}", soft->effective_options());
  }
  if (simulation.scene().motion)
    spdlog::info("its motion takes {:.1f} s", simulation.scene().motion->duration());

  const auto begin = Clock::now();
  // Values derived from time stamps depend on them down to the last bit, through rounding.
  const bool in_virtual_time = options.fast || buses.recorder() != nullptr;
  simulation.start_clock(in_virtual_time ? 0 : bus::wall_clock_us());
  std::int64_t ticks = std::numeric_limits<std::int64_t>::max();
  if (options.duration > 0)
    ticks = std::llround(options.duration / Simulation::kPeriod);
  else if (buses.recorder() != nullptr)
    ticks = std::llround(scene.motion->duration() / Simulation::kPeriod);
  nlohmann::json result;
  if (buses.recorder() != nullptr)
    result = run_recorded(simulation, *buses.recorder(), ticks);
  else if (options.fast)
    result = run_fast(simulation, lock_step, ticks);
  else
    result = run_real_time(simulation, buses.control(), ticks);
  const double wall = std::chrono::duration<double>(Clock::now() - begin).count();
  buses.control().stop();

  result["version"] = PALPATE_VERSION;
  result["scene"] = options.scene;
  result["ticks"] = simulation.tick();
  result["substeps"] = simulation.object().substeps();
  result["simulated_s"] = simulation.time();
  result["wall_s"] = wall;
  result["real_time_factor"] = wall > 0 ? simulation.time() / wall : 0.0;
  result["commands_accepted"] = simulation.commands().accepted();
  result["commands_rejected"] = simulation.commands().rejected();
  result["commands_unauthorised"] = simulation.commands().unauthorised();
  result["commands_lost"] = simulation.commands().lost();
  if (simulation.camera() != nullptr)
    result["camera_pictures_left_out"] = simulation.camera()->left_out();
  result["torque_limited_ticks"] = simulation.robot().torque_limited_steps();
  report(simulation, result);
  if (options.fast && simulation.commands().lost() > 0)
    spdlog::warn("commands were lost: another run with the same seed may differ");
  if (!options.json.empty()) {
    std::ofstream file(options.json);
    file << result.dump(2) << '\n';
    if (!file) throw std::runtime_error(options.json + ": cannot be written");
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "palpate-sim simulates arm, hand, soft object and sensors, and publishes the channels that "
      "real\n"
      "hardware would.");
  Options options;
  app.add_option("scene", options.scene, "YAML file, see sim/scenes")->required();
  app.add_option("--set", options.overrides,
                 "override a key: path.to.key=value (repeatable), e.g. "
                 "object.material.young_modulus=60e3")
      ->allow_extra_args(false);
  app.add_flag("--fast", options.fast,
               "as fast as it goes, tick by tick with a daemon that runs with --stepped");
  app.add_option("--record", options.record,
                 "without a daemon, as fast as it goes: the messages go to sensors.log and "
                 "truth.log (and clouds.log) in this folder, for palpate-replay; the scene must "
                 "have a motion")
      ->excludes("--fast");
  app.add_option("--duration", options.duration,
                 "simulated seconds; without it until a signal, or the end of the motion with "
                 "--record")
      ->check(CLI::PositiveNumber);
  app.add_option("--json", options.json, "write the summary to this file at the end");
  app.set_version_flag("--version", PALPATE_VERSION);
  app.footer(
      "Example:\n"
      "  palpate-sim scene.yaml --duration 30 --set seed=2\n"
      "  palpate-sim sim/scenes/bar_long_soft_six_poses.yaml --record out/six_poses");
  if (const auto code = palpate::config::parse(
          app, argc, argv, {{{0, "ended by a signal or after --duration"}, {78, "wrong scene"}}}))
    return *code;

  struct sigaction action {};
  action.sa_handler = [](int) { stop = true; };
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  spdlog::set_pattern("%H:%M:%S.%e %^%l%$ %v");
  try {
    return run(options);
  } catch (const palpate::config::Error& error) {
    spdlog::error("{}", error.what());
    return palpate::config::kExitCode;
  } catch (const std::exception& error) {
    spdlog::error("{}", error.what());
    return 1;
  }
}
