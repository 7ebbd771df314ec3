#include <filesystem>
#include <fstream>
#include <functional>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "rt/config/node.hpp"
#include "tools/common/output_files.hpp"
#include "tools/common/table.hpp"
#include "tools/fit/simulators/simulator_files.hpp"

namespace palpate::fit {
namespace {

constexpr char kMesh[] = "model.vtk";

struct ExportArguments {
  std::string configuration;
  std::vector<std::string> overrides;
  std::string output;
  bool mjcf = false;
  bool drake = false;
  bool sofa = false;
  std::string grasp = "free";
  ExportOptions options;
};

void write_model(const std::filesystem::path& file,
                 const std::function<void(std::ostream&)>& write) {
  std::ofstream out(file);
  write(out);
  out.close();
  if (!out) throw std::runtime_error(file.string() + ": cannot be written");
  std::cout << "  " << file.string() << '\n';
}

nlohmann::json points(const Eigen::Matrix3Xd& positions) {
  nlohmann::json json = nlohmann::json::array();
  for (const auto& p : positions.colwise()) json.push_back({p.x(), p.y(), p.z()});
  return json;
}

/// What a simulator's own result can be compared with, in W, SI units.
nlohmann::json to_json(const SoftObject& object) {
  return {{"configuration", object.configuration},
          {"nodes", object.mesh.node_count()},
          {"tetrahedra", object.mesh.tetrahedron_count()},
          {"mass", object.masses().sum()},
          {"gravity", {object.gravity_W.x(), object.gravity_W.y(), object.gravity_W.z()}},
          {"fixed_nodes", object.fixed},
          {"grasped_nodes", object.grasped},
          {"farthest_node", object.farthest_node()},
          {"undeformed", points(object.mesh.nodes.leftCols(object.at_rest.cols()))},
          {"under_weight", points(object.at_rest)},
          {"left_out", object.left_out}};
}

int run(ExportArguments arguments) {
  if (!arguments.mjcf && !arguments.drake && !arguments.sofa)
    throw config::Error("export: no format; allowed: --mjcf, --drake-sdf, --sofa, or several");
  arguments.options.grasp = arguments.grasp == "held" ? ExportedGrasp::kHeld : ExportedGrasp::kFree;
  const SoftObject object =
      read_soft_object(config::Node::load_file(arguments.configuration, arguments.overrides),
                       arguments.configuration, arguments.options);
  const std::filesystem::path folder = arguments.output;
  std::filesystem::create_directories(folder);
  const Eigen::Vector3d way = 1e3 * object.largest_displacement();
  std::cout << object.mesh.node_count() << " nodes, " << object.mesh.tetrahedron_count()
            << " tetrahedra, " << common::formatted("%.4g", object.masses().sum()) << " kg, "
            << object.fixed.size() << " nodes fixed.\nBy palpate's statics, node "
            << object.farthest_node()
            << " moves farthest under the weight: " << common::formatted("%.3f", way.x()) << ", "
            << common::formatted("%.3f", way.y()) << ", " << common::formatted("%.3f", way.z())
            << " mm in the base.\n";
  for (const std::string& what : object.left_out) std::cout << "Left out: " << what << ".\n";
  std::cout << "Written:\n";
  if (arguments.mjcf)
    write_model(folder / "model.xml", [&](std::ostream& out) { write_mjcf(object, out); });
  if (arguments.drake)
    write_model(folder / "model.sdf",
                [&](std::ostream& out) { write_drake_sdf(object, kMesh, out); });
  if (arguments.sofa)
    write_model(folder / "model.scn", [&](std::ostream& out) { write_sofa(object, kMesh, out); });
  if (arguments.drake || arguments.sofa)
    write_model(folder / kMesh, [&](std::ostream& out) { write_vtk(object, out); });
  common::write_json(to_json(object), folder / "model.json");
  std::cout << "  " << (folder / "model.json").string() << '\n';
  return 0;
}

}  // namespace

void add_export_command(CLI::App& app, int& code) {
  const auto arguments = std::make_shared<ExportArguments>();
  CLI::App* command = app.add_subcommand(
      "export",
      "Models of a configuration's object, with its mesh and material, for MuJoCo, Drake and SOFA");
  command->add_option("configuration", arguments->configuration, "palpated's")->required();
  command->add_option("-o,--output", arguments->output, "Folder for the files")->required();
  command->add_flag("--mjcf", arguments->mjcf, "MuJoCo: model.xml");
  command->add_flag("--drake-sdf", arguments->drake, "Drake: model.sdf and model.vtk");
  command->add_flag("--sofa", arguments->sofa, "SOFA: model.scn and model.vtk");
  command
      ->add_option("--grasp", arguments->grasp,
                   "The grasped nodes move freely, or are held where they are at rest")
      ->check(CLI::IsMember({"free", "held"}))
      ->capture_default_str();
  command
      ->add_option("--refine", arguments->options.refinements,
                   "Times that each tetrahedron is divided into eight, since linear elements "
                   "converge slowly; quadratic ones are divided once in any case")
      ->check(CLI::Range(0, 4))
      ->capture_default_str();
  command->add_option("--set", arguments->overrides, "path.to.key=value over the configuration's")
      ->allow_extra_args(false);
  command->final_callback([arguments, &code] { code = run(*arguments); });
}

}  // namespace palpate::fit
