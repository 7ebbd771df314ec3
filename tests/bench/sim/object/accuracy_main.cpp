// Error of the scenes' meshes relative to a converged one, and their cost.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "rt/config/command_line.hpp"
#include "tests/bench/sim/object/mesh_accuracy.hpp"

namespace palpate::object {
namespace {

std::string mesh_name(const PlantOptions& options) {
  const std::array<int, 3>& n = options.elements;
  std::string name = std::to_string(n[0]);
  for (const int axis : {1, 2}) name += "x" + std::to_string(n[axis]);
  return name;
}

/// One line of the table.
void compare(const MeshCase& load, const std::vector<Equilibrium>& best, double best_dent) {
  const std::vector<Equilibrium> found = equilibria(load, best);
  const std::array<double, 3> off = differences(found, best);
  const HyperelasticPlant plant(load.options);
  const StepCost cost = step_cost(load);
  std::printf("| %s | %.2f | %d | %.3f | %.0f | %.0f | %.2f | %.2f | %.2f |",
              mesh_name(load.options).c_str(), load.options.grading,
              static_cast<int>(plant.positions().cols()), 1e3 * plant.critical_step(),
              cost.substeps, cost.microseconds, off[0], off[1], off[2]);
  if (load.dented) std::printf(" %.1f |", 100 * (dent_force(load) - best_dent) / best_dent);
  for (std::size_t i = 0; i < found.size(); ++i)
    if (!found[i].converged) std::printf(" (pose %zu does not settle)", i + 1);
  std::printf("\n");
  std::fflush(stdout);
}

void compare_scene(const std::string& file, const std::vector<std::string>& meshes,
                   const std::string& fine_mesh) {
  const auto set_mesh = [](PlantOptions& options, const std::string& text) {
    int* const n = options.elements.data();
    options.grading = 1;
    if (std::sscanf(text.c_str(), "%dx%dx%d:%lf", n, n + 1, n + 2, &options.grading) < 3)
      throw std::invalid_argument("a mesh is NXxNYxNZ or NXxNYxNZ:GRADING, not " + text);
  };
  MeshCase load = read_case(file);
  MeshCase fine = load;
  fine.options = refined(load.options);
  if (!fine_mesh.empty()) set_mesh(fine.options, fine_mesh);
  const std::vector<Equilibrium> coarse = equilibria(load);
  const std::vector<Equilibrium> best = equilibria(fine, coarse);
  const double best_dent = load.dented ? dent_force(fine) : 0;
  std::printf("\n%s (E %g kPa, against %s, grading %.2f)\n\n",
              std::filesystem::path(file).stem().c_str(), 1e-3 * load.options.young_modulus,
              mesh_name(fine.options).c_str(), fine.options.grading);
  std::printf(
      "| elements | grading | nodes | critical step, ms | substeps | us a ms | shape, %% | force, "
      "%% | torque, %% |%s\n|---|---|---|---|---|---|---|---|---|%s\n",
      load.dented ? " dent, % |" : "", load.dented ? "---|" : "");
  compare(load, best, best_dent);
  for (const std::string& mesh : meshes) {
    set_mesh(load.options, mesh);
    compare(load, best, best_dent);
  }
}

/// Tip of the long soft bar that hangs from its clamp under its weight alone, as JSON.
void hang(const std::array<int, 3>& elements, double grading) {
  MeshCase load;
  PlantOptions& options = load.options;
  options.elements = elements;
  options.grading = grading;
  options.clamp = Box{{0, 0, 0}, {0, options.size.y(), options.size.z()}};
  options.gravity_O = {0, 0, -9.81};
  load.legs.resize(1);
  HyperelasticPlant plant(options);
  const HyperelasticPlant::Settling settled = plant.settle(60, 1e-6);
  const Eigen::Vector3d tip(options.size.x(), 0.5 * options.size.y(), 0.5 * options.size.z());
  nlohmann::json out;
  out["size"] = {options.size.x(), options.size.y(), options.size.z()};
  out["young_modulus"] = options.young_modulus;
  out["poisson_ratio"] = options.poisson_ratio;
  out["density"] = options.density;
  out["elements"] = elements;
  out["nodes"] = plant.positions().cols();
  out["critical_step"] = plant.critical_step();
  out["microseconds"] = step_cost(load).microseconds;
  out["tip_sag"] = tip.z() - plant.position_at(tip).z();
  out["converged"] = settled.converged;
  std::printf("%s\n", out.dump(2).c_str());
}

}  // namespace
}  // namespace palpate::object

int main(int argc, char** argv) {
  CLI::App app(
      "Tables of the plant's meshes: for every scene the difference of shape, force and torque of "
      "the hand from a mesh of twice the elements along each axis, the worst over the poses of the "
      "scene's motion; and the time of a step of 1 ms (processor time of one core).");
  std::vector<std::string> scenes, meshes;
  std::vector<int> hanging;
  std::string fine;
  double grading = 1;
  app.add_option("scenes", scenes, "scene files with a motion")->check(CLI::ExistingFile);
  app.add_option("--mesh", meshes, "further meshes, NXxNYxNZ or NXxNYxNZ:GRADING")
      ->allow_extra_args(false);
  app.add_option("--fine", fine, "the mesh to compare with");
  app.add_option("--hang", hanging, "instead: elements of the long soft bar; its sag as JSON")
      ->expected(3)
      ->check(CLI::PositiveNumber);
  app.add_option("--grading", grading, "of --hang")->check(CLI::Range(1., 3.));
  if (const auto code = palpate::config::parse(app, argc, argv)) return *code;
  try {
    if (!hanging.empty()) palpate::object::hang({hanging[0], hanging[1], hanging[2]}, grading);
    for (const std::string& scene : scenes) palpate::object::compare_scene(scene, meshes, fine);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
  return 0;
}
