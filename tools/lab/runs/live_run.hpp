#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <palpate/twist_command_t.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "rt/client/client.hpp"
#include "tools/common/process.hpp"
#include "tools/common/progress.hpp"
#include "tools/lab/runs/experiments.hpp"

namespace palpate::runs {

/// URLs of one run, with ports that nothing else on this machine uses.
struct Urls {
  std::string control;
  std::string housekeeping;
  std::string pictures;
};
Urls private_urls();

/// Messages of a target; throws as client::make_target() does.
std::vector<shape_target_t> messages_of(const ControlTarget& target);

/// A run was not completed: what() gives the reason, with the last output of the program at fault.
class RunFailed : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Source of the daemon's input: the simulator with a scene, or the player with a log.
struct Source {
  std::filesystem::path scene;
  std::vector<std::string> scene_overrides;
  double duration = 0;        // s, simulated, after which the simulator ends; 0: never
  std::filesystem::path log;  // log of the control URL; if set, it is played and nothing simulated
};

struct RunPlan {
  std::string name;  // names the folder of the run
  Source source;
  std::filesystem::path configuration;  // of palpated
  std::vector<std::string> overrides;
  double duration = 10;  // s from the activation of the daemon, at most
  std::optional<ControlTarget> target;
  double settled = 3;    // s after which a run with a target ends early, once at rest
  bool recorded = true;  // one logger per URL
  /// Simulator and daemon tick by tick instead of in real time, to the end of the source, whose
  /// duration must be set: the result does not depend on the machine's load.
  bool lock_step = false;
  double standstill =
      120;  // s without progress of simulated time, after which such a run is aborted
};

struct RunFiles {
  std::filesystem::path control;       // log of the control URL
  std::filesystem::path housekeeping;  // log of the housekeeping URL
  std::filesystem::path simulator;     // summary of palpate-sim, JSON
  std::filesystem::path daemon;        // statistics of palpated, JSON
};

/// The programs of one run over LCM on private ports: two loggers, the daemon, its source. All of
/// them end with this object. In lock-step the daemon receives its start event and target before
/// the simulator's first tick, so that every run receives them at the same one.
class LiveRun {
 public:
  /// Starts everything and activates the daemon; logs go to `folder`. Throws RunFailed.
  LiveRun(const RunPlan& plan, const std::filesystem::path& folder);

  /// Runs to the end of the plan: its duration, the end of the source, or a target reached and
  /// kept.
  void complete(common::Progress& progress);

  /// Ends everything in order and checks the exit codes; throws RunFailed.
  RunFiles finish();

  void set_target(const ControlTarget& target);
  /// Handles arriving messages for `seconds`; throws Interrupted.
  void spin(double seconds);

  const client::Client& client() const { return client_; }
  pid_t daemon_pid() const { return daemon_->pid(); }
  /// Throws RunFailed if a program has ended unexpectedly. False once the source has finished.
  bool check_programs();

 private:
  void start_lock_step();
  void complete_lock_step(common::Progress& progress);
  void await_loggers();
  void activate();
  void watch_commands();
  std::string reason() const;  // of the daemon's last known state
  double settled() const;
  [[noreturn]] void fail(const std::string& what, const common::Process* at_fault) const;

  const RunPlan& plan_;
  RunFiles files_;
  Urls urls_ = private_urls();
  std::unique_ptr<bus::MessageBus> control_ = bus::make_lcm_bus(urls_.control),
                                   housekeeping_ = bus::make_lcm_bus(urls_.housekeeping);
  bus::TypedSubscription<twist_command_t> commands_;
  client::Client client_{*control_, *housekeeping_};
  std::int64_t still_since_ = 0;  // us; 0: the daemon moves the hand, or does not follow our target
  std::vector<common::Process> loggers_;
  std::unique_ptr<common::Process> daemon_;
  std::unique_ptr<common::Process> source_;
};

/// Starts, completes and finishes a plan.
RunFiles run_live(const RunPlan& plan, const std::filesystem::path& folder,
                  common::Progress& progress);

}  // namespace palpate::runs
