#include "tools/lab/sensor_models/observer.hpp"

namespace palpate::sensor_models {

ObserverCommand::ObserverCommand(CLI::App& app) {
  options_.output = "out/observer";
  command_ = app.add_subcommand(
      "observer",
      "the wrist observer on the simulated payload arm: records, trains, runs the daemon; residual "
      "without contact and a collision");
  command_->add_option("--output", options_.output, "folder for everything that it writes")
      ->capture_default_str();
  command_
      ->add_option("--models", options_.models,
                   "newton_euler, newton_euler_smooth, ft_rnnob, thesis")
      ->check(CLI::IsMember({"newton_euler", "newton_euler_smooth", "ft_rnnob", "thesis"}));
  command_->add_option("--motions", options_.motions, "manual, rotation_y, rotation_z, collision")
      ->check(CLI::IsMember({"manual", "rotation_y", "rotation_z", "collision"}));
  command_->add_option("--executor", options_.executor, "of the learned models")
      ->check(CLI::IsMember({"torch", "compiled"}))
      ->capture_default_str();
  command_->add_option("--iterations", options_.iterations, "of training (default: presets')")
      ->check(CLI::Range(1, 1000000));
  command_
      ->add_option("--recordings", options_.recordings,
                   "to learn from, of slow and quick motion each")
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
  command_->add_flag("--keep", options_.keep,
                     "use the recordings and models that the folder holds already");
  command_->add_option("--longest", options_.longest, "s, at which recordings are cut off")
      ->check(CLI::Range(5.0, 3600.0));
  command_->add_option("--json", options_.json, "write the result to this file");
}

std::optional<int> ObserverCommand::run(const std::filesystem::path& root, std::ostream& out) {
  if (!command_->parsed()) return {};
  options_.root = root;
  return run_observer(options_, out);
}

}  // namespace palpate::sensor_models
