#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <iostream>
#include <set>

#include "rt/config/command_line.hpp"
#include "tests/bench/core/elasticity/element_rows.hpp"
#include "tests/support/recordings.hpp"
#include "tools/lab/cases/case_sweep.hpp"

namespace palpate::bench {
namespace {

using mesh::ElementOrder;

struct Arguments {
  std::string cases;
  std::vector<std::string> only;
  int most_linear = 1000, most_quadratic = 700;
  bool all = false;
};

void note(const ElementRow& row) {
  std::cerr << row.body << ", " << row.element << ", " << row.mesh << " done\n";
}

/// The supplied meshes, then a series of generated ones.
void measure_cases(const Arguments& a, const std::string& folder, std::vector<ElementRow>& rows) {
  const cases::CaseFile c = cases::read_case(folder);
  const auto add = [&](const std::string& name, const mesh::MeshWithGroups& mesh,
                       const std::string& element) {
    if (const auto row = measure_case(c, name, mesh, element)) {
      rows.push_back(*row);
      note(*row);
    } else {
      std::cerr << c.name << ", " << element << ", " << name << ": no equilibrium found\n";
    }
  };
  for (const std::string element : {kLinear, kAveragedLinear, kQuadratic}) {
    const bool quadratic = element == kQuadratic;
    for (const auto& [name, file] : c.meshes) {
      if (!quadratic || name == "coarse") add(name, cases::read_case_mesh(c, name), element);
    }
    if (c.boxes.empty()) continue;
    const ElementOrder order = quadratic ? ElementOrder::kQuadratic : ElementOrder::kLinear;
    for (const cases::CaseGrid& grid :
         cases::grid_ladder(c, order, quadratic ? a.most_quadratic : a.most_linear)) {
      add(grid.text(), cases::make_case_mesh(c, grid), element);
    }
  }
}

struct RoundMesh {
  std::string name;
  std::function<RoundBody(ElementOrder, Sides)> make;
};

/// Two curved quadratic meshes, the second finer by `ratio`, from which displacements are
/// extrapolated with convergence of `order`, as found for the body over several sizes.
struct Extrapolation {
  RoundMesh coarse, fine;
  double ratio, order;

  Eigen::Matrix3Xd find(const std::string& body) const {
    const auto near = solve_round(coarse.make(ElementOrder::kQuadratic, Sides::kCurved));
    const auto nearest = solve_round(fine.make(ElementOrder::kQuadratic, Sides::kCurved));
    if (!near || !nearest) throw std::runtime_error(body + ": the reference does not converge");
    const Eigen::Matrix3Xd correction = (*nearest - *near) / (std::pow(ratio, order) - 1);
    std::cerr << body << ": reference extrapolated by "
              << 100 * correction.colwise().norm().maxCoeff() / nearest->colwise().norm().maxCoeff()
              << " %\n";
    return *nearest + correction;
  }
};

void measure_round_body(const std::string& body, const std::vector<RoundMesh>& linear,
                        const std::vector<RoundMesh>& quadratic, const Extrapolation& extrapolation,
                        std::vector<ElementRow>& rows) {
  const Eigen::Matrix3Xd reference = extrapolation.find(body);
  const auto add = [&](const RoundMesh& mesh, ElementOrder order, Sides sides,
                       const std::string& element) {
    if (const auto row =
            measure_round(mesh.make(order, sides), body, mesh.name, element, reference)) {
      rows.push_back(*row);
      note(*row);
    }
  };
  for (const auto& [sides, element] :
       {std::pair{Sides::kStraight, kLinear}, {Sides::kInflated, kInflatedLinear}}) {
    for (const RoundMesh& mesh : linear) add(mesh, ElementOrder::kLinear, sides, element);
  }
  for (const auto& [sides, element] : {std::pair{Sides::kStraight, kQuadratic},
                                       {Sides::kInflated, kInflatedQuadratic},
                                       {Sides::kCurved, kCurvedQuadratic}}) {
    for (const RoundMesh& mesh : quadratic) add(mesh, ElementOrder::kQuadratic, sides, element);
  }
}

RoundMesh cylinder(int rings, int layers) {
  return {
      std::to_string(rings) + " rings x " + std::to_string(layers),
      [=](ElementOrder order, Sides sides) { return make_cylinder(rings, layers, order, sides); }};
}
RoundMesh ellipsoid(int m) {
  return {"icosahedron / " + std::to_string(m),
          [=](ElementOrder order, Sides sides) { return make_ellipsoid(m, order, sides); }};
}

int run(const Arguments& a) {
  const auto wanted = [&a](const std::string& name) {
    return a.only.empty() || std::find(a.only.begin(), a.only.end(), name) != a.only.end();
  };
  std::vector<ElementRow> rows;
  if (std::filesystem::is_directory(a.cases)) {
    std::set<std::filesystem::path> folders;
    for (const auto& entry : std::filesystem::directory_iterator(a.cases)) {
      if (entry.is_directory() && wanted(entry.path().filename())) folders.insert(entry.path());
    }
    for (const auto& folder : folders) measure_cases(a, folder, rows);
  } else {
    std::cerr << a.cases << " is no folder: round bodies only\n";
  }
  if (wanted("cylinder")) {
    measure_round_body(
        "cylinder",
        {cylinder(2, 8), cylinder(2, 16), cylinder(3, 16), cylinder(4, 16), cylinder(4, 24)},
        {cylinder(1, 4), cylinder(1, 8), cylinder(1, 12), cylinder(2, 8), cylinder(2, 12)},
        {cylinder(2, 16), cylinder(3, 24), 1.5, 2}, rows);
  }
  if (wanted("ellipsoid")) {
    measure_round_body("ellipsoid", {ellipsoid(2), ellipsoid(3), ellipsoid(4), ellipsoid(6)},
                       {ellipsoid(1), ellipsoid(2), ellipsoid(3)},
                       {ellipsoid(3), ellipsoid(6), 2, 1}, rows);
  }
  print_rows(a.all ? rows : unbeaten(rows), std::cout);
  std::cout << '\n';
  print_least_times(rows, std::cout);
  return 0;
}

}  // namespace
}  // namespace palpate::bench

int main(int argc, char** argv) {
  CLI::App app{
      "Compares elements: error against a reference, size of the factor, and thread time of a "
      "correction of the loop (one pass over the elements and one solve). Of averaged and curved "
      "elements the pass is timed as that of the plain element, which is less than they would "
      "take."};
  palpate::bench::Arguments arguments;
  arguments.cases = (palpate::support::recordings() / "fem_cases").string();
  app.add_option("--cases", arguments.cases, "folder of reference cases")->capture_default_str();
  app.add_option("--only", arguments.only, "names of cases, cylinder, ellipsoid");
  app.add_option("--most-linear", arguments.most_linear, "nodes of linear meshes at most")
      ->capture_default_str();
  app.add_option("--most-quadratic", arguments.most_quadratic, "nodes of quadratic meshes at most")
      ->capture_default_str();
  app.add_flag("--all", arguments.all, "print every mesh, not only the best of each size");
  if (const auto code = palpate::config::parse(app, argc, argv)) return *code;
  try {
    return palpate::bench::run(arguments);
  } catch (const std::exception& error) {
    std::cerr << "bench_elements: " << error.what() << '\n';
    return palpate::config::kExitError;
  }
}
