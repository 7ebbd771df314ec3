#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "core/mesh/mesh_writer.hpp"
#include "tools/common/output_files.hpp"
#include "tools/common/table.hpp"
#include "tools/mesh/commands.hpp"
#include "tools/mesh/options.hpp"
#include "tools/mesh/region_editor.hpp"
#include "tools/mesh/regions.hpp"

namespace palpate::mesh_tool {
namespace {

using Numbers = std::vector<double>;

struct RegionOptions {
  std::string input;
  double scale = 1;
  std::string group, of, output, picture, json;
  std::vector<std::string> removed;
  Numbers box, sphere, half_space, side, connected;
  double angle = 30;  // degrees
  bool all = false, add = false, remove = false, list = false, edit = false;
  int grow = 0;
  RegionEditorOptions editor;
};

Eigen::Vector3d vector_at(const Numbers& numbers, int first) {
  return Eigen::Vector3d(numbers[first], numbers[first + 1], numbers[first + 2]);
}

/// Members that all of the given options select.
class Selected {
 public:
  Selected(const Regions& regions, RegionKind kind)
      : selection_(regions.selection()), kind_(kind), members_(selection_.all(kind)) {}

  void keep(const std::vector<int>& members) {
    std::vector<int> both;
    std::set_intersection(members_.begin(), members_.end(), members.begin(), members.end(),
                          std::back_inserter(both));
    members_ = std::move(both);
  }
  void keep(const Space& space) { keep(selection_.inside(kind_, space)); }
  void keep_at(const std::vector<int>& faces) {
    keep(kind_ == RegionKind::kFaces ? faces : selection_.elements_at(faces));
  }
  void grow(int rounds) { members_ = selection_.grown(kind_, std::move(members_), rounds); }
  const std::vector<int>& members() const { return members_; }

 private:
  const RegionSelection& selection_;
  RegionKind kind_;
  std::vector<int> members_;
};

std::vector<int> selected_by(const RegionOptions& o, const Regions& regions, RegionKind kind) {
  Selected selected(regions, kind);
  const double angle = o.angle * EIGEN_PI / 180;
  if (!o.box.empty()) selected.keep(box_space(vector_at(o.box, 0), vector_at(o.box, 3)));
  if (!o.sphere.empty()) selected.keep(ball_space(vector_at(o.sphere, 0), o.sphere[3]));
  if (!o.half_space.empty())
    selected.keep(half_space(vector_at(o.half_space, 0), vector_at(o.half_space, 3)));
  const RegionSelection& of = regions.selection();
  if (!o.side.empty()) selected.keep_at(of.facing(vector_at(o.side, 0), angle));
  if (!o.connected.empty())
    selected.keep_at(of.connected(of.nearest_face(vector_at(o.connected, 0)), angle));
  if (!selected.members().empty()) selected.grow(o.grow);
  return selected.members();
}

std::string extent_of(const Regions& regions) {
  const Eigen::Matrix3Xd& nodes = regions.mesh().mesh.nodes;
  std::string text = "the mesh extends";
  for (int axis = 0; axis < 3; ++axis)
    text += common::formatted("%s %c from %.4g to %.4g", axis > 0 ? "," : "", "xyz"[axis],
                              nodes.row(axis).minCoeff(), nodes.row(axis).maxCoeff());
  return text + " m";
}

void edit_group(const RegionOptions& o, Regions& regions) {
  const bool has_selector = o.all || !o.box.empty() || !o.sphere.empty() || !o.half_space.empty() ||
                            !o.side.empty() || !o.connected.empty();
  if (!has_selector)
    throw std::runtime_error("--group " + o.group +
                             " needs a selection: --box, --sphere, --half-space, --side, "
                             "--connected or --all");
  const RegionKind kind = o.of.empty()         ? regions.kind_of(o.group)
                          : o.of == "elements" ? RegionKind::kElements
                                               : RegionKind::kFaces;
  const std::vector<int> members = selected_by(o, regions, kind);
  if (members.empty())
    throw std::runtime_error("--group " + o.group + ": the selection holds no " +
                             (kind == RegionKind::kFaces ? "whole face" : "element") + "; " +
                             extent_of(regions));
  regions.edit(o.group, kind,
               o.add      ? RegionEdit::kAdd
               : o.remove ? RegionEdit::kRemove
                          : RegionEdit::kReplace,
               members);
}

nlohmann::json to_json(const RegionSize& size) {
  return {{"nodes", size.nodes},
          {"faces", size.faces},
          {"elements", size.elements},
          {"area_m2", size.area},
          {"volume_m3", size.volume}};
}

nlohmann::json to_json(const Regions& regions, const std::string& file) {
  nlohmann::json groups = nlohmann::json::object();
  for (const auto& [name, group] : regions.groups()) groups[name] = to_json(regions.size(name));
  return {{"file", file}, {"whole", to_json(regions.whole())}, {"groups", groups}};
}

void print_regions(const Regions& regions, std::ostream& out) {
  common::Table table({"group", "nodes", "faces", "area, m^2", "elements", "volume, m^3"});
  const auto add = [&table](const std::string& name, const RegionSize& size) {
    table.add({name, std::to_string(size.nodes), std::to_string(size.faces),
               common::formatted("%.5g", size.area), std::to_string(size.elements),
               common::formatted("%.5g", size.volume)});
  };
  for (const auto& [name, group] : regions.groups()) add(name, regions.size(name));
  table.section("whole mesh, nodes inside included");
  add("", regions.whole());
  table.print(out);
  if (regions.groups().empty()) out << "no groups\n";
}

int run_regions(const RegionOptions& options) {
  if (!options.output.empty()) check_region_file(options.output);
  mesh::MeshWithGroups read = read_volume(options.input, options.scale);
  mesh::orient(read.mesh);
  const std::vector<Fault> faults = find_faults(read);
  if (has_errors(faults)) {
    std::cerr << options.input << ": rejected, nothing is written\n"
              << text(faults) << "palpate-mesh repair corrects many of these\n";
    return kBroken;
  }
  Regions regions(std::move(read));
  for (const std::string& name : options.removed) regions.erase(name);
  if (!options.group.empty()) edit_group(options, regions);
  if (options.edit) {
    RegionEditorOptions editor = options.editor;
    editor.file = options.output.empty() ? options.input : options.output;
    edit_regions_in_browser(regions, editor);
  } else if (!options.output.empty()) {
    if (const std::string conflict = regions.conflict(); !conflict.empty())
      throw std::runtime_error(conflict + "; nothing is written");
    write_regions(regions, options.output);
  }
  std::ostream& out = options.json == "-" ? std::cerr : std::cout;
  print_regions(regions, out);
  if (!options.output.empty() && !options.edit)
    out << options.output << ": written; in a configuration of palpated:\n"
        << regions.configuration(options.output) << '\n';
  const bool is_changed = !options.group.empty() || !options.removed.empty();
  if (is_changed && options.output.empty() && !options.edit)
    std::cerr << "not written: no --output\n";
  if (!options.picture.empty()) {
    draw_regions(regions, std::filesystem::path(options.input).filename().string(),
                 options.picture);
    out << "picture: " << options.picture << '\n';
  }
  if (!options.json.empty()) common::write_json(to_json(regions, options.input), options.json);
  return kGood;
}

void add_selectors(CLI::App& command, RegionOptions& o) {
  command.add_option("--box", o.box, "X0 Y0 Z0 X1 Y1 Z1: in this box, m")->expected(6);
  command.add_option("--sphere", o.sphere, "X Y Z RADIUS: in this sphere, m")->expected(4);
  command
      .add_option("--half-space", o.half_space,
                  "X Y Z NX NY NZ: beyond the plane through a point, m, in this direction")
      ->expected(6);
  command
      .add_option("--side", o.side,
                  "NX NY NZ: faces whose outward normal has this direction, within --angle")
      ->expected(3);
  command
      .add_option("--connected", o.connected,
                  "X Y Z: faces joined with the one nearest to this point by edges of at most "
                  "--angle")
      ->expected(3);
  command.add_option("--angle", o.angle, "degrees, of --side and --connected")
      ->check(CLI::Range(0.0, 180.0))
      ->capture_default_str();
  command.add_flag("--all", o.all, "all faces or elements");
  command.add_option("--grow", o.grow, "then add what shares a node with a selected one, N times")
      ->check(CLI::Range(0, 1000));
}

}  // namespace

void add_region_command(CLI::App& app, int& code) {
  auto options = std::make_shared<RegionOptions>();
  RegionOptions& o = *options;
  CLI::App* command = app.add_subcommand(
      "regions",
      "Names parts of a mesh as groups, for clamp, grasp, surface and material in palpated's "
      "configuration");
  command->add_option("input", o.input, "mesh of tetrahedra: .msh, .node or .ele, .veg, .vtu")
      ->required();
  command->add_flag("--list", o.list, "only print the groups, with numbers and sizes");
  CLI::Option* group = command->add_option(
      "--group", o.group,
      "group to be made of what is selected; clamp, grasp and second_grasp may not share nodes");
  command->add_option("--of", o.of, "what the group is made of (new groups: faces)")
      ->check(CLI::IsMember({"faces", "elements"}))
      ->needs(group);
  add_selectors(*command, o);
  CLI::Option* add = command->add_flag("--add", o.add, "add the selection to the group");
  command->add_flag("--remove", o.remove, "remove the selection from the group")
      ->excludes(add)
      ->needs(group);
  add->needs(group);
  for (const char* name :
       {"--box", "--sphere", "--half-space", "--side", "--connected", "--all", "--grow", "--angle"})
    command->get_option(name)->needs(group);
  command->add_option("--delete", o.removed, "remove this group (repeatable)")
      ->allow_extra_args(false);
  command->add_option("--output", o.output, "file to write: .msh, Gmsh 4.1 with physical groups");
  command->add_option("--picture", o.picture, "PNG of the mesh with its groups in colours");
  command->add_option("--json", o.json, "numbers and sizes as JSON; - for the standard output");
  add_scale_option(*command, o.scale);
  CLI::Option* edit = command->add_flag(
      "--edit", o.edit,
      "paint the groups in a browser, by the address that is printed; it saves to --output, or to "
      "the input");
  command->add_option("--port", o.editor.port, "of --edit, on 127.0.0.1; 0: any that is free")
      ->check(CLI::Range(0, 65535))
      ->capture_default_str()
      ->needs(edit);
  command->add_option("--three", o.editor.three, "of --edit: folder of three.min.js")
      ->capture_default_str()
      ->needs(edit);
  for (const char* name : {"--group", "--delete", "--output", "--edit"})
    command->get_option("--list")->excludes(command->get_option(name));
  command->footer(
      "What several options of one call select is what they have in common. A face is selected if "
      "all\nits corners are, an element if its centroid is. Examples:\n"
      "  palpate-mesh regions bar.msh --group clamp --box 0 0 0 0.05 1 1 --output bar.msh\n"
      "  palpate-mesh regions bar.msh --group surface --side 0 0 1 --output bar.msh\n"
      "  palpate-mesh regions egg.msh --group grasp --connected 0.05 0 0 --angle 15 --sphere 0.05 "
      "0 "
      "0 0.02 --output egg.msh\n"
      "  palpate-mesh regions bar.msh --group core --of elements --box 0.2 0 0 0.3 1 1 --output "
      "bar.msh\n"
      "  palpate-mesh regions bar.msh --edit");
  command->callback([&code, options] { code = run_regions(*options); });
}

}  // namespace palpate::mesh_tool
