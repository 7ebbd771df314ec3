#include "tools/lab/shapes/shapes_command.hpp"

#include <algorithm>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>

#include "rt/config/node.hpp"
#include "tools/common/output_files.hpp"
#include "tools/common/process.hpp"
#include "tools/common/progress.hpp"
#include "tools/common/table.hpp"
#include "tools/lab/shapes/beam_score.hpp"
#include "tools/lab/shapes/recording_folders.hpp"
#include "tools/lab/shapes/sagging_cylinder.hpp"
#include "tools/lab/shapes/sponge_score.hpp"

namespace palpate::shapes {
namespace {

/// "NAME=KPA" to Pa. Throws config::Error.
std::pair<std::string, double> parse_modulus(const std::string& text) {
  const auto equals = text.rfind('=');
  double value = 0;
  if (equals != std::string::npos && equals > 0 &&
      CLI::detail::lexical_cast(text.substr(equals + 1), value) && value >= 1e-3 && value <= 1e9)
    return {text.substr(0, equals), 1e3 * value};
  throw config::Error("--modulus: '" + text +
                      "' is not NAME=KPA; allowed: a material of the recording and a number from "
                      "0.001 to 1e9 kPa");
}

}  // namespace

struct ShapesCommand::Options {
  std::string data, json, output;
  std::vector<std::string> moduli, overrides;

  std::map<std::string, double> given() const {
    std::map<std::string, double> values;
    for (const std::string& text : moduli) values.insert(parse_modulus(text));
    return values;
  }

  void write(const std::vector<ShapeResult>& results, std::ostream& out) const {
    nlohmann::json all{{"shapes", nlohmann::json::array()}};
    for (const ShapeResult& result : results) all["shapes"].push_back(shapes::to_json(result));
    if (!json.empty()) common::write_json(all, json);
    if (output.empty()) return;
    std::filesystem::create_directories(output);
    const std::filesystem::path file = std::filesystem::path(output) / "shapes.json";
    common::write_json(all, file);
    try {
      out << common::run_python("tools/lab/report/report_shapes", {file.string()});
    } catch (const std::runtime_error& error) {
      std::cerr << "no page: " << error.what() << '\n';
    }
  }

  int run(const std::filesystem::path& folder, std::ostream& out) const {
    const std::map<std::string, double> values = given();
    if (!std::filesystem::is_directory(folder)) {
      out << "recorded shapes: absent, there is no folder " << folder.string() << '\n';
      return 0;
    }
    const ShapeFiles files = find_shapes(folder);
    if (files.empty()) {
      std::cerr << "error: " << folder.string()
                << ": holds no recorded shape, nor do the folders directly below it; allowed: YAML "
                   "with cases and geometry_mm (beams) or with radius_mm and length_mm (a "
                   "cylinder), TRIAL_frames.csv with TRIAL_contour.csv (a sponge)\n";
      return 1;
    }
    std::vector<ShapeResult> results;
    const auto add = [&results](std::vector<ShapeResult> more) {
      std::move(more.begin(), more.end(), std::back_inserter(results));
    };
    for (std::size_t i = 0; i < files.cylinders.size(); ++i) {
      const SaggingCylinder cylinder = read_sagging_cylinder(files.cylinders[i]);
      common::Progress progress(static_cast<int>(i) + 1, static_cast<int>(files.cylinders.size()),
                                cylinder.name);
      add(score_sagging_cylinder(cylinder));
      progress.finish(true);
    }
    std::vector<HangingBeams> beams;
    for (const std::filesystem::path& file : files.beams)
      beams.push_back(read_hanging_beams(file, overrides));
    add(score_hanging_beams(beams, values));
    for (std::size_t i = 0; i < files.sponges.size(); ++i) {
      const PushedSponge sponge = read_pushed_sponge(files.sponges[i]);
      common::Progress progress(static_cast<int>(i) + 1, static_cast<int>(files.sponges.size()),
                                sponge.recording);
      results.push_back(score_pushed_sponge(sponge));
      progress.finish(true);
    }
    print_shapes(results, out);
    write(results, out);
    return std::all_of(results.begin(), results.end(),
                       [](const ShapeResult& result) { return result.met(); })
               ? 0
               : 1;
  }
};

ShapesCommand::ShapesCommand(CLI::App& app) : options_(std::make_unique<Options>()) {
  command_ = app.add_subcommand(
      "shapes",
      "real objects, predicted and compared with their measured shape: clamped beams under their "
      "weight (Young's modulus is fitted to the drop of the end block alone), a cylinder of known "
      "modulus (nothing is fitted), and sponges pushed by a finger (fitted to 20 % depth, scored "
      "to 40 %); exit code 1 where a goal is missed");
  command_->add_option("--data", options_->data,
                       "folder of a recording, or of such folders (default: PALPATE_DATA or "
                       "../shared/data)");
  command_->add_option("--json", options_->json, "write the result to this file");
  command_->add_option("--output", options_->output,
                       "folder for shapes.json and the page report.html with pictures");
  command_
      ->add_option("--modulus", options_->moduli,
                   "NAME=KPA: Young's modulus of a beam's material, instead of a fit (repeatable)")
      ->allow_extra_args(false);
  command_
      ->add_option("--set", options_->overrides,
                   "key of the beams' YAML file to override, such as "
                   "cases.NAME.material=FIRST+SECOND (repeatable)")
      ->allow_extra_args(false);
}

ShapesCommand::~ShapesCommand() = default;

std::optional<int> ShapesCommand::run(const std::filesystem::path& data, std::ostream& out) {
  if (!command_->parsed()) return std::nullopt;
  return options_->run(options_->data.empty() ? data : std::filesystem::path(options_->data), out);
}

}  // namespace palpate::shapes
