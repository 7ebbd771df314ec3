#include "tools/lab/uncertainty/draws_command.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "tools/common/output_files.hpp"
#include "tools/common/table.hpp"
#include "tools/lab/uncertainty/drawn_error.hpp"

namespace palpate::uncertainty {
namespace {

namespace fs = std::filesystem;
using Levels = std::vector<runs::Mismatch>;

std::string rounded(double value) { return common::formatted("%.4g", value); }

/// One row per parameter, over all draws.
void print_parameters(const Levels& levels, std::ostream& out) {
  common::Table table({"parameter", "unit", "mean", "deviation", "least", "greatest"});
  for (std::size_t p = 0; p < levels.front().drawn.size(); ++p) {
    const double count = static_cast<double>(levels.size());
    double sum = 0, squares = 0, least = HUGE_VAL, greatest = -HUGE_VAL;
    for (const runs::Mismatch& level : levels) {
      const double value = level.drawn[p].value;
      sum += value / count;
      squares += value * value / count;
      least = std::min(least, value);
      greatest = std::max(greatest, value);
    }
    const runs::DrawnValue& first = levels.front().drawn[p];
    table.add({first.parameter, first.unit, rounded(sum),
               rounded(std::sqrt(std::max(0.0, squares - sum * sum))), rounded(least),
               rounded(greatest)});
  }
  table.print(out);
}

void print_draw(const runs::Mismatch& level, std::ostream& out) {
  common::Table table({"parameter", "unit", level.name});
  for (const runs::DrawnValue& value : level.drawn)
    table.add({value.parameter, value.unit, rounded(value.value)});
  table.print(out);
  out << "\nof the scene:\n";
  for (const std::string& setting : level.scene) out << "  --set '" << setting << "'\n";
  out << "of palpated:\n";
  for (const std::string& setting : level.daemon) out << "  --set '" << setting << "'\n";
}

/// One row per draw, RFC 4180.
void write_csv(const Levels& levels, const fs::path& file) {
  std::ofstream out(file, std::ios::binary);
  out << "draw";
  for (const runs::DrawnValue& value : levels.front().drawn)
    out << ',' << common::csv_cell(value.parameter + (value.unit.empty() ? "" : ", " + value.unit));
  out << "\r\n";
  for (std::size_t i = 0; i < levels.size(); ++i) {
    out << i + 1;
    for (const runs::DrawnValue& value : levels[i].drawn)
      out << ',' << common::formatted("%.9g", value.value);
    out << "\r\n";
  }
  out.close();
  if (!out) throw std::runtime_error("cannot write " + file.string());
}

nlohmann::json json_of(const runs::Mismatch& level) {
  nlohmann::json parameters = nlohmann::json::object();
  for (const runs::DrawnValue& value : level.drawn) parameters[value.parameter] = value.value;
  return {{"name", level.name},
          {"parameters", parameters},
          {"scene", level.scene},
          {"daemon", level.daemon}};
}

}  // namespace

fs::path distributions_file(const fs::path& root, const std::string& name) {
  return root / "tools/lab/uncertainty" / (name + ".yaml");
}

DrawsCommand::DrawsCommand(CLI::App& app)
    : command_(app.add_subcommand(
          "draws", "draws of the model error from a file of distributions, to check by eye")) {
  command_
      ->add_option("--distributions", distributions_,
                   "calibrated, uncalibrated, or a file of distributions")
      ->capture_default_str();
  command_->add_option("--draws", draws_, "number of draws, of one Latin hypercube")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  command_->add_option("--seed", seed_, "seed of the draws")->capture_default_str();
  command_->add_option("--draw", draw_, "one draw, from 1, with its settings of scene and palpated")
      ->check(CLI::PositiveNumber);
  command_
      ->add_option("--scene", scene_, "scene (default: sim/scenes/bar_long_soft_six_poses.yaml)")
      ->check(CLI::ExistingFile);
  command_
      ->add_option("--config", configuration_,
                   "configuration of palpated (default: rt/config/examples/bar_long_soft.yaml)")
      ->check(CLI::ExistingFile);
  command_->add_option("--csv", csv_, "file for the draws, one row each");
  command_->add_option("--json", json_, "file for the draws with their settings");
}

std::optional<int> DrawsCommand::run(const fs::path& root, std::ostream& out) const {
  if (!command_->parsed()) return std::nullopt;
  const fs::path named = distributions_file(root, distributions_);
  const Distributions distributions =
      read_distributions(fs::exists(named) ? named : fs::path(distributions_));
  const LatinHypercube sample(seed_, draws_);
  const fs::path scene = scene_.empty() ? root / "sim/scenes/bar_long_soft_six_poses.yaml" : scene_;
  const fs::path configuration =
      configuration_.empty() ? root / "rt/config/examples/bar_long_soft.yaml" : configuration_;
  if (draw_ > 0) {
    print_draw(draw_mismatch(distributions, sample, draw_, scene, configuration), out);
    return 0;
  }
  Levels levels;
  for (int i = 1; i <= draws_; ++i)
    levels.push_back(draw_mismatch(distributions, sample, i, scene, configuration));
  if (levels.front().drawn.empty())
    throw std::invalid_argument(distributions_ + ": draws nothing for this scene");
  print_parameters(levels, out);
  out << draws_ << " draws of " << distributions.name << ", seed " << seed_ << '\n';
  if (!csv_.empty()) write_csv(levels, csv_);
  if (!json_.empty()) {
    nlohmann::json json{
        {"distributions", distributions.name}, {"seed", seed_}, {"draws", nlohmann::json::array()}};
    for (const runs::Mismatch& level : levels) json["draws"].push_back(json_of(level));
    common::write_json(json, json_);
  }
  return 0;
}

}  // namespace palpate::uncertainty
