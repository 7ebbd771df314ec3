#include "tools/evaluate/case_commands.hpp"

#include <nlohmann/json.hpp>

#include "tools/evaluate/case_mesh.hpp"
#include "tools/evaluate/case_report.hpp"
#include "tools/evaluate/report.hpp"

namespace palpate::evaluate {
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
  bool all = false;
  std::string json;
  ScoreCaseOptions score;
  DynamicOptions dynamic;
  double mass_damping = 0;

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
        ->check(CLI::Range(1, 1000));
    command.add_option("--cut", cut, "tetrahedra of a cell of our own mesh: five or six")
        ->check(CLI::IsMember({"five", "six"}))
        ->capture_default_str();
    command.add_flag("--all", all, "every mesh of the case with both elements");
    command.add_option("--json", json, "write one object, or a list of several, to this file");
  }

  std::vector<CaseScore> score_folder(const CaseFile& c) const {
    std::vector<CaseScore> scores;
    if (!own_mesh.empty()) {
      const mesh::MeshWithGroups grid =
          make_case_mesh(c, {own_mesh[0], own_mesh[1], own_mesh[2]}, kCuts.at(cut));
      scores.push_back(score_case(c, "own", grid, kElements.at(element), score));
      return scores;
    }
    for (const auto& [name, file] : c.meshes) {
      if (!all && name != mesh) continue;
      const mesh::MeshWithGroups read = read_case_mesh(c, name);
      for (const auto& [title, order] : kElements)
        if (all || title == element) scores.push_back(score_case(c, name, read, order, score));
    }
    if (scores.empty()) read_case_mesh(c, mesh);  // says what is there
    return scores;
  }

  int run(std::ostream& out) const {
    std::vector<CaseFile> cases;
    for (const std::string& folder : folders) cases.push_back(read_case(folder));
    std::vector<CaseScore> scores;
    for (const CaseFile& c : cases)
      for (CaseScore& s : score_folder(c)) scores.push_back(std::move(s));
    print_cases(scores, out);
    nlohmann::json results = nlohmann::json::array();
    bool converged = true;
    for (const CaseScore& s : scores) {
      results.push_back(to_json(s));
      converged = converged && s.converged();
    }
    if (!json.empty()) write_json(results.size() == 1 ? results[0] : results, json);
    return converged ? 0 : 1;
  }
};

CaseCommands::CaseCommands(CLI::App& app) : options_(std::make_unique<Options>()) {
  static_command_ = app.add_subcommand(
      "static", "solves reference cases of nonlinear statics; errors, wrenches, time per step");
  options_->add_to(*static_command_);
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
}

CaseCommands::~CaseCommands() = default;

std::optional<int> CaseCommands::run(const std::filesystem::path&, std::ostream& out) {
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

}  // namespace palpate::evaluate
