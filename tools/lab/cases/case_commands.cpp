#include "tools/lab/cases/case_commands.hpp"

#include <algorithm>
#include <iterator>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tools/common/output_files.hpp"
#include "tools/common/table.hpp"
#include "tools/lab/cases/case_beam.hpp"
#include "tools/lab/cases/case_mesh.hpp"
#include "tools/lab/cases/case_report.hpp"
#include "tools/lab/cases/case_sweep.hpp"

namespace palpate::cases {
namespace {

using mesh::ElementOrder;

const std::map<std::string, ElementOrder> kElements{{"linear", ElementOrder::kLinear},
                                                    {"quadratic", ElementOrder::kQuadratic}};
const std::map<std::string, mesh::CellCut> kCuts{{"five", mesh::CellCut::kFive},
                                                 {"six", mesh::CellCut::kSix}};

}  // namespace

struct CaseCommands::Options {
  std::vector<std::string> folders;
  std::string element = "quadratic";
  std::string mesh = "coarse";
  std::vector<int> own_mesh;
  std::string cut = "five";
  double grading = 1;
  bool all = false;
  bool sweep = false;
  std::string plot;
  std::string json;
  ScoreCaseOptions score;
  DynamicOptions dynamic;
  double mass_damping = 0;
  BeamOptions beam;

  void add_to(CLI::App& command) {
    command.add_option("case", folders, "folders with case.yaml, probes.csv and meshes")
        ->required();
    command.add_option("--element", element, "linear or quadratic")
        ->check(CLI::IsMember({"linear", "quadratic"}))
        ->capture_default_str();
    command.add_option("--mesh", mesh, "NAME of the case's mesh_NAME.msh")->capture_default_str();
    command.add_option("--own-mesh", own_mesh, "nx,ny,nz: cells of our own mesh of boxes instead")
        ->delimiter(',')
        ->expected(3)
        ->allow_extra_args(false)
        ->check(CLI::Range(1, 1000));
    command.add_option("--cut", cut, "tetrahedra of a cell of our own mesh: five or six")
        ->check(CLI::IsMember({"five", "six"}))
        ->capture_default_str();
    command
        .add_option("--grading", grading,
                    "own mesh: distances from the clamp go by this power; above 1: finer there")
        ->check(CLI::Range(0.5, 4.0))
        ->capture_default_str();
    command.add_flag("--all", all, "every mesh of the case with both elements");
    command.add_option("--json", json, "write one object, or a list of several, to this file");
  }

  std::vector<CaseScore> score_folder(const CaseFile& c) const {
    std::vector<CaseScore> scores;
    if (!own_mesh.empty()) {
      const CaseGrid grid{{own_mesh[0], own_mesh[1], own_mesh[2]}, kCuts.at(cut), grading};
      scores.push_back(
          score_case(c, grid.text(), make_case_mesh(c, grid), kElements.at(element), score));
      return scores;
    }
    for (const auto& [name, file] : c.meshes) {
      if (!all && name != mesh) continue;
      const mesh::MeshWithGroups read = read_case_mesh(c, name);
      for (const auto& [title, order] : kElements)
        if (all || title == element) scores.push_back(score_case(c, name, read, order, score));
    }
    if (scores.empty()) read_case_mesh(c, mesh);  // lists the available items
    return scores;
  }

  int run(std::ostream& out) const {
    std::vector<CaseFile> cases;
    for (const std::string& folder : folders) cases.push_back(read_case(folder));
    if (sweep) return run_sweep(cases, out);
    std::vector<CaseScore> scores;
    for (const CaseFile& c : cases)
      for (CaseScore& s : score_folder(c)) scores.push_back(std::move(s));
    print_cases(scores, out);
    return write(scores);
  }

  int write(const std::vector<CaseScore>& scores) const {
    nlohmann::json results = nlohmann::json::array();
    bool converged = true;
    for (const CaseScore& s : scores) {
      results.push_back(to_json(s));
      converged = converged && s.converged();
    }
    if (!json.empty()) common::write_json(results.size() == 1 ? results[0] : results, json);
    return converged ? 0 : 1;
  }

  int run_sweep(const std::vector<CaseFile>& cases, std::ostream& out) const {
    const SweepOptions options;
    std::vector<CaseScore> all_scores, best;
    std::vector<common::Plot> plots;
    std::ostringstream goals;
    bool met = true;
    for (const CaseFile& c : cases) {
      std::vector<CaseScore> scores = cases::sweep(c, ElementOrder::kLinear, options);
      for (CaseScore& s : cases::sweep(c, ElementOrder::kQuadratic, options))
        scores.push_back(std::move(s));
      plots.push_back(error_against_time(c.name, scores));
      met = print_goal(c, scores, options, goals) && met;
      for (const ElementOrder order : {ElementOrder::kLinear, ElementOrder::kQuadratic})
        for (const CaseScore* s : best_of(scores, order)) best.push_back(*s);
      std::move(scores.begin(), scores.end(), std::back_inserter(all_scores));
    }
    print_cases(best, out);
    out << "Shown are the meshes that no other one beats in both error and median time; a power is "
           "the grading.\n"
        << goals.str();
    if (!plot.empty()) common::try_draw(plots, plot);
    return std::max(write(all_scores), met ? 0 : 1);
  }

  static bool print_goal(const CaseFile& c, const std::vector<CaseScore>& scores,
                         const SweepOptions& options, std::ostream& out) {
    const auto describe = [](const CaseScore& s) {
      return s.mesh + ", " + std::to_string(s.nodes) + " nodes, RMS " +
             common::number(100 * s.figures.rms_share(), 2) + " %, p99 " +
             common::number(s.incremental->times.p99, 0) + " us";
    };
    const CaseScore* smallest = smallest_within_goal(scores, options);
    const CaseScore* best = most_accurate(scores, options);
    out << c.name << ": quadratic within " << common::number(100 * options.goal_rms_share, 0)
        << " %: "
        << (smallest ? describe(*smallest)
                     : "none of at most " + std::to_string(options.goal_nodes) + " nodes");
    if (best && best != smallest) out << "; most accurate: " << describe(*best);
    out << '\n';
    return smallest != nullptr;
  }
};

CaseCommands::CaseCommands(CLI::App& app) : options_(std::make_unique<Options>()) {
  static_command_ = app.add_subcommand(
      "static", "solves reference cases of nonlinear statics; errors, wrenches, time per step");
  options_->add_to(*static_command_);
  static_command_->add_flag("--sweep", options_->sweep,
                            "a ladder of our own meshes with both elements; exit 1 where no "
                            "quadratic one of at most 600 nodes is within 2 %");
  static_command_->add_option("--plot", options_->plot,
                              "sweep: draw error against time per tick to this PNG");
  static_command_
      ->add_option("--ticks", options_->score.ticks,
                   "steps of 1 ms over which the incremental model takes the load; 0: not run")
      ->check(CLI::Range(0, 1000000))
      ->capture_default_str();

  dynamic_command_ =
      app.add_subcommand("dynamic", "the same cases, by the dynamic model run to rest");
  options_->add_to(*dynamic_command_);
  dynamic_command_
      ->add_option("--mass-damping", options_->mass_damping,
                   "1/s (default: critical for the first mode, estimated)")
      ->check(CLI::NonNegativeNumber);
  dynamic_command_->add_option("--stiffness-damping", options_->dynamic.stiffness_damping, "s")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  dynamic_command_
      ->add_option("--rise", options_->dynamic.rise, "s over which the load comes; 0: at once")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  dynamic_command_->add_option("--seconds", options_->dynamic.seconds, "simulated at most")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();

  beam_command_ = app.add_subcommand(
      "beam", "fits one Young's modulus to a recorded silicone beam; errors at its tip");
  beam_command_->add_option("--own-mesh", options_->own_mesh, "nx,ny,nz: cells of the mesh")
      ->delimiter(',')
      ->expected(3)
      ->allow_extra_args(false)
      ->check(CLI::Range(1, 1000));
  beam_command_->add_option("--grading", options_->beam.grid.grading, "as for static")
      ->check(CLI::Range(0.5, 4.0))
      ->capture_default_str();
  beam_command_->add_option("--data", options_->beam.data,
                            "recordings (default: PALPATE_DATA or ../shared/data)");
  beam_command_->add_option("--json", options_->json, "write the result to this file");
}

CaseCommands::~CaseCommands() = default;

std::optional<int> CaseCommands::run(const std::filesystem::path& data, std::ostream& out) {
  if (beam_command_->parsed()) {
    BeamOptions& beam = options_->beam;
    if (beam.data.empty()) beam.data = data;
    if (!options_->own_mesh.empty())
      std::copy_n(options_->own_mesh.begin(), 3, beam.grid.cells.begin());
    beam.json = options_->json;
    return run_beam(beam, out);
  }
  if (dynamic_command_->parsed()) {
    if (dynamic_command_->count("--mass-damping") > 0)
      options_->dynamic.mass_damping = options_->mass_damping;
    options_->score.ticks = 0;
    options_->score.dynamic = options_->dynamic;
    return options_->run(out);
  }
  if (static_command_->parsed()) return options_->run(out);
  return std::nullopt;
}

}  // namespace palpate::cases
