#include "tools/lab/cases/case_file.hpp"

#include <algorithm>
#include <fstream>

#include "rt/config/node.hpp"
#include "tools/lab/cases/case_formula.hpp"
#include "tools/recordings/csv_reader.hpp"

namespace palpate::cases {
namespace {

using config::Node;
using Eigen::Vector3d;

constexpr double kMost = 1e15;  // of any quantity

Eigen::AlignedBox3d read_box(const Node& node) {
  const Vector3d lower = node.vector3("min"), upper = node.vector3("max");
  if ((lower.array() > upper.array()).any()) node.fail("max", "lies below min");
  return {lower, upper};
}

CaseRegion read_region(const Node& node, const std::string& group) {
  CaseRegion region;
  region.group = node.text("group", group);
  const Node box = node.child_or_empty("box");
  if (!box.keys().empty()) region.box = read_box(box);
  return region;
}

/// Absent keys are taken from `otherwise`.
elasticity::Material read_material(const Node& node, const elasticity::Material& otherwise) {
  constexpr double kTiny = 1e-12;
  return {node.number("E", {kTiny, kMost}, otherwise.young_modulus),
          node.number("nu", {-1 + kTiny, 0.5 - kTiny}, otherwise.poisson_ratio),
          node.number("rho", {0, kMost}, otherwise.density)};
}

CaseLoad read_load(const Node& node) {
  CaseLoad load;
  load.region = read_region(node, "load");
  if (node.flag("follower", false))
    node.fail("follower", "only dead loads are known; allowed: false");
  const char* const kind = node.has("total_force") ? "total_force_uniform_traction"
                           : node.has("traction")  ? "uniform_traction"
                                                   : "traction_field";
  const std::string type = node.choice(
      "type", {"total_force_uniform_traction", "uniform_traction", "traction_field"}, kind);
  if (type == "total_force_uniform_traction") {
    load.total_force = node.vector3("total_force", {-kMost, kMost});
  } else if (type == "uniform_traction") {
    load.traction = [t = node.vector3("traction", {-kMost, kMost})](const Vector3d&) { return t; };
  } else {
    try {
      load.traction = VectorFormula(node.text("formula"), [&node](const std::string& name) {
        return node.number(name, {-kMost, kMost});
      });
    } catch (const std::invalid_argument& error) {
      node.fail("formula", error.what());
    }
  }
  return load;
}

Eigen::Matrix3d read_rotation(const Node& node) {
  Eigen::Matrix3d from_angle = Eigen::Matrix3d::Identity();
  const bool has_angle = node.has("rotation_deg");
  if (has_angle) {
    const double angle = node.number("rotation_deg", {-360, 360}) * M_PI / 180;
    const Vector3d axis = node.vector3("rotation_axis", {-kMost, kMost}, Vector3d::Zero());
    if (angle != 0 && axis.norm() < 1e-12) node.fail("rotation_axis", "has no direction");
    if (angle != 0) from_angle = math::exp_rotation(angle * axis.normalized());
  }
  if (!node.has("rotation_matrix")) return from_angle;
  const std::vector<Vector3d> rows = node.points("rotation_matrix");
  if (rows.size() != 3) node.fail("rotation_matrix", "must have three rows");
  Eigen::Matrix3d rotation;
  for (int r = 0; r < 3; ++r) rotation.row(r) = rows[r].transpose();
  constexpr double kRounding = 1e-6;
  if (!(rotation * rotation.transpose()).isIdentity(kRounding) || rotation.determinant() < 0)
    node.fail("rotation_matrix", "is no rotation");
  if (has_angle && !rotation.isApprox(from_angle, kRounding))
    node.fail("rotation_matrix", "is another rotation than rotation_axis and rotation_deg");
  return rotation;
}

CaseGrasp read_grasp(const Node& node) {
  CaseGrasp grasp;
  grasp.region = read_region(node, "grasp");
  const Vector3d centre = node.vector3("centre", {-kMost, kMost});
  grasp.X_OG_rest.translation() = centre;
  grasp.X_OG = math::make_pose(
      read_rotation(node), centre + node.vector3("translation", {-kMost, kMost}, Vector3d::Zero()));
  return grasp;
}

/// If only a part has a density the rest is given a negligible one; if nothing has one, weight is
/// off and any mass serves.
void replace_missing_density(CaseFile& c) {
  constexpr double kAnyDensity = 1000;  // kg/m^3
  double largest = c.material.density;
  for (const MaterialOverride& o : c.overrides) largest = std::max(largest, o.material.density);
  if (largest == 0) c.gravity.setZero();
  const double stand_in = largest == 0 ? kAnyDensity : 1e-9 * largest;
  const auto replace = [stand_in](elasticity::Material& m) {
    if (m.density == 0) m.density = stand_in;
  };
  replace(c.material);
  for (MaterialOverride& o : c.overrides) replace(o.material);
}

void read_definition(const Node& root, CaseFile& c) {
  c.name = root.text("name", c.folder.filename().string());
  const Node geometry = root.child_or_empty("geometry");
  if (geometry.text("type", "") == "box" && geometry.has("min"))
    c.boxes.push_back(read_box(geometry));
  for (const Node& box : geometry.list("boxes")) c.boxes.push_back(read_box(box));
  const Node material = root.child("material");
  material.number("E", {});
  material.number("nu", {});
  c.material = read_material(material, {1, 0, 0});
  for (const Node& node : root.list("material_overrides"))
    c.overrides.push_back({read_box(node.child("box")), read_material(node, c.material)});
  c.gravity = root.vector3("gravity", {-kMost, kMost}, Vector3d::Zero());
  const auto is_given = [&root](const char* key) {
    return !root.child_or_empty(key).keys().empty();
  };
  if (is_given("fixed")) c.fixed = read_region(root.child("fixed"), "fixed");
  for (const Node& node : root.list("loads")) c.loads.push_back(read_load(node));
  if (is_given("grasp")) c.grasp = read_grasp(root.child("grasp"));
  if (!c.fixed && !c.grasp) root.fail("fixed", "is missing, and there is no grasp either");
  replace_missing_density(c);

  const Node files = root.child_or_empty("files");
  const std::string prefix = "mesh_";
  for (const std::string& key : files.keys())
    if (key.rfind(prefix, 0) == 0) c.meshes[key.substr(prefix.size())] = files.path(key);
  if (c.meshes.empty()) {
    for (const auto& entry : std::filesystem::directory_iterator(c.folder)) {
      const std::string stem = entry.path().stem().string();
      if (entry.path().extension() == ".msh" && stem.rfind(prefix, 0) == 0)
        c.meshes[stem.substr(prefix.size())] = entry.path();
    }
  }
}

std::vector<CaseProbe> read_probes(const std::filesystem::path& file) {
  try {
    recordings::CsvReader csv(file.string());
    std::array<int, 6> columns{};
    const char* const names[] = {"x", "y", "z", "ux", "uy", "uz"};
    for (int i = 0; i < 6; ++i) columns[i] = csv.column(names[i]);
    const auto vector = [&](int first) {
      return Vector3d(csv.number(columns[first]), csv.number(columns[first + 1]),
                      csv.number(columns[first + 2]));
    };
    std::vector<CaseProbe> probes;
    while (csv.next()) probes.push_back({vector(0), vector(3)});
    return probes;
  } catch (const recordings::CsvError& error) {
    throw config::Error(error.what());
  }
}

}  // namespace

double CaseFile::largest_reference() const {
  double largest = 0;
  for (const CaseProbe& probe : probes) largest = std::max(largest, probe.displacement.norm());
  return largest;
}

void CaseFile::fail(const std::string& key, const std::string& what) const {
  throw config::Error((folder / "case.yaml").string() + ": " + key + ": " + what);
}

CaseFile read_case(const std::filesystem::path& folder) {
  CaseFile c;
  c.folder = folder;
  if (!c.folder.has_filename()) c.folder = c.folder.parent_path();
  const Node root = Node::load_file((c.folder / "case.yaml").string());
  read_definition(root, c);
  const Node files = root.child_or_empty("files");
  c.probes = read_probes(files.has("probes") ? std::filesystem::path(files.path("probes"))
                                             : c.folder / "probes.csv");
  const std::filesystem::path summary = files.has("summary")
                                            ? std::filesystem::path(files.path("summary"))
                                            : c.folder / "summary.json";
  if (std::ifstream in(summary); in) {
    try {
      c.summary = nlohmann::json::parse(in);
    } catch (const nlohmann::json::exception& error) {
      throw config::Error(summary.string() + ": " + error.what());
    }
    if (!c.summary.is_object()) throw config::Error(summary.string() + ": is no JSON object");
  }
  return c;
}

}  // namespace palpate::cases
