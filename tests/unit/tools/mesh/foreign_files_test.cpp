// Files of other programs: gmsh, tetgen and meshio, each run here. Their files are read, and files
// written here are read by them, with the same nodes and volume.

#include <gmock/gmock.h>

#include "core/mesh/report.hpp"
#include "rt/config/mesh_file.hpp"
#include "tests/unit/tools/mesh/mesh_folder.hpp"
#include "tools/mesh/faults.hpp"
#include "tools/mesh/mesh_files.hpp"

namespace palpate::mesh_tool {
namespace {

class ForeignFiles : public MeshFolder {
 protected:
  int run_python(const std::string& script, const std::vector<std::string>& arguments) {
    write("script.py", script);
    // The package's interpreter, regardless of other Python installations.
    std::vector<std::string> command{"/usr/bin/python3", path("script.py")};
    for (const std::string& name : arguments) command.push_back(path(name));
    return run_other(command);
  }

  /// Contents of files as read by meshio, by name: nodes, tetrahedra of either order, signed
  /// volume.
  nlohmann::json meshio(std::vector<std::string> names) {
    names.insert(names.begin(), "look.json");
    EXPECT_EQ(run_python("import json, os, sys, meshio, numpy as np\n"
                         "out = {}\n"
                         "for f in sys.argv[2:]:\n"
                         "  m = meshio.read(f)\n"
                         "  t = np.vstack([c.data[:, :4] for c in m.cells\n"
                         "                 if c.type in ('tetra', 'tetra10')])\n"
                         "  x = m.points[t]\n"
                         "  v = np.einsum('ij,ij->i', x[:,1]-x[:,0],\n"
                         "                np.cross(x[:,2]-x[:,0], x[:,3]-x[:,0])) / 6\n"
                         "  out[os.path.basename(f)] = {'nodes': len(m.points),\n"
                         "      'tetrahedra': len(t), 'volume': v.sum(),\n"
                         "      'sum': m.points.sum(axis=0).tolist()}\n"
                         "open(sys.argv[1], 'w').write(json.dumps(out))\n",
                         names),
              0)
        << output();
    return nlohmann::json::parse(text_of("look.json"));
  }

  /// A ball cut off by a box, by gmsh; two named parts.
  void run_gmsh(const std::string& name, const std::vector<std::string>& options) {
    write("body.geo",
          "SetFactory(\"OpenCASCADE\");\nBox(1) = {0, 0, 0, 0.1, 0.06, 0.06};\n"
          "Cylinder(2) = {0.1, 0.03, 0.03, 0.05, 0, 0, 0.02};\n"
          "BooleanFragments{ Volume{1}; Delete; }{ Volume{2}; Delete; }\n"
          "Physical Volume(\"box\") = {1};\nPhysical Volume(\"rod\") = {2};\n"
          "Mesh.MeshSizeMax = 0.02;\n");
    std::vector<std::string> command{"gmsh", path("body.geo"), "-3", "-nt", "1", "-o", path(name)};
    command.insert(command.end(), options.begin(), options.end());
    ASSERT_EQ(run_other(command), 0) << output();
  }
};

TEST_F(ForeignFiles, OfGmshInEveryFormAreTheSameMesh) {
  struct Form {
    const char* format;
    bool binary;
    const char* order;
  };
  for (const Form& form : {Form{"msh2", false, "1"}, Form{"msh2", true, "2"},
                           Form{"msh41", false, "2"}, Form{"msh41", true, "1"}}) {
    std::vector<std::string> options{"-format", form.format, "-order", form.order};
    if (form.binary) options.emplace_back("-bin");
    run_gmsh("a.msh", options);
    const mesh::MeshWithGroups read = read_volume(path("a.msh"), 1);
    EXPECT_FALSE(has_errors(find_faults(read))) << form.format << text(find_faults(read));
    const nlohmann::json other = meshio({"a.msh"})["a.msh"];
    EXPECT_EQ(read.mesh.tetrahedron_count(), other["tetrahedra"]) << form.format;
    EXPECT_NEAR(mesh::check(read.mesh).volume, other["volume"], 1e-15);
    if (form.order[0] == '1') {
      EXPECT_EQ(read.mesh.node_count(), other["nodes"]);
    }
    EXPECT_EQ(read.middles.empty(), form.order[0] == '1');
    ASSERT_EQ(read.groups.count("box"), 1u) << form.format;
    EXPECT_EQ(read.groups.at("box").tetrahedra.size() + read.groups.at("rod").tetrahedra.size(),
              static_cast<std::size_t>(read.mesh.tetrahedron_count()));
    // The daemon's loader gives quadratic elements the volume of their curved sides.
    const double exact = 0.1 * 0.06 * 0.06 + EIGEN_PI * 0.02 * 0.02 * 0.05;
    const double loaded = mesh::check(config::load_mesh(path("a.msh"))).volume;
    EXPECT_NEAR(loaded, exact, (form.order[0] == '1' ? 0.02 : 2e-3) * exact);
  }
}

TEST_F(ForeignFiles, WhatIsWrittenHereGmshReads) {
  for (const std::string version : {"2.2", "4.1"}) {
    for (const std::string order : {"1", "2"}) {
      for (const bool binary : {false, true}) {
        std::vector<std::string> arguments{"cylinder", path("rod.msh"), "--radius", "0.02",
                                           "--length", "0.1",           "--edge",   "0.01",
                                           "--msh",    version,         "--order",  order};
        if (binary) arguments.emplace_back("--binary");
        ASSERT_EQ(run(arguments), 0) << output();
        const mesh::MeshWithGroups ours = read_volume(path("rod.msh"), 1);
        // Gmsh reads it and writes it in another format.
        ASSERT_EQ(
            run_other({"gmsh", path("rod.msh"), "-save", "-format",
                       version == "2.2" ? "msh41" : "msh2", "-save_all", "-o", path("again.msh")}),
            0)
            << output();
        EXPECT_THAT(output(), ::testing::Not(::testing::HasSubstr("Error")));
        const mesh::MeshWithGroups theirs = read_volume(path("again.msh"), 1);
        EXPECT_EQ(theirs.mesh.node_count(), ours.mesh.node_count()) << version << order << binary;
        EXPECT_EQ(theirs.mesh.tetrahedron_count(), ours.mesh.tetrahedron_count());
        EXPECT_EQ(theirs.middles.empty(), order == "1");
        EXPECT_NEAR(mesh::check(theirs.mesh).volume, mesh::check(ours.mesh).volume, 1e-15);
      }
    }
  }
}

TEST_F(ForeignFiles, OfTetgenAndBack) {
  ASSERT_EQ(run({"box", path("box.stl"), "--size", "0.1", "0.06", "0.04", "--edge", "0.02"}), 0);
  ASSERT_EQ(run_other({"tetgen", "-pqa2e-6", path("box.stl")}), 0) << output();
  const mesh::MeshWithGroups read = read_volume(path("box.1.node"), 1);
  EXPECT_FALSE(has_errors(find_faults(read))) << text(find_faults(read));
  EXPECT_NEAR(mesh::check(read.mesh).volume, 2.4e-4, 1e-12);
  EXPECT_EQ(mesh::hash(config::load_mesh(path("box.1.ele"))), mesh::hash(read.mesh));
  for (const std::string first : {"0", "1"}) {
    ASSERT_EQ(run({"convert", path("box.1.ele"), path("ours.node"), "--first", first}), 0);
    // Reconstructs the mesh and refines it.
    ASSERT_EQ(run_other({"tetgen", "-rqa1e-6", path("ours.node")}), 0) << output();
    const mesh::MeshWithGroups finer = read_volume(path("ours.1.ele"), 1);
    EXPECT_GT(finer.mesh.tetrahedron_count(), read.mesh.tetrahedron_count());
    EXPECT_NEAR(mesh::check(finer.mesh).volume, 2.4e-4, 1e-12);
  }
}

TEST_F(ForeignFiles, OfMeshioAndBack) {
  run_gmsh("a.msh", {"-format", "msh41"});
  const mesh::MeshWithGroups ours = read_volume(path("a.msh"), 1);
  // Its writer of Gmsh 4.1 needs the entities returned by its reader, and therefore all cells.
  ASSERT_EQ(run_python("import meshio, os, sys, numpy as np\n"
                       "m = meshio.read(sys.argv[1])\n"
                       "os.chdir(os.path.dirname(sys.argv[1]))\n"
                       "t = meshio.Mesh(m.points, [('tetra', np.vstack([c.data for c in\n"
                       "    m.cells if c.type == 'tetra']))])\n"
                       "meshio.write('zlib.vtu', t)\n"
                       "meshio.write('plain.vtu', t, compression=None)\n"
                       "meshio.write('text.vtu', t, binary=False)\n"
                       "meshio.write('two.msh', t, file_format='gmsh22')\n"
                       "meshio.write('two_text.msh', t, file_format='gmsh22', binary=False)\n"
                       "meshio.write('four.msh', m, file_format='gmsh')\n"
                       "meshio.write('four_text.msh', m, file_format='gmsh', binary=False)\n"
                       "meshio.write('pair.node', t)\n",
                       {"a.msh"}),
            0)
      << output();
  for (const std::string name : {"zlib.vtu", "plain.vtu", "text.vtu", "two.msh", "two_text.msh",
                                 "four.msh", "four_text.msh", "pair.node"}) {
    const mesh::MeshWithGroups theirs = read_volume(path(name), 1);
    EXPECT_NEAR(mesh::check(theirs.mesh).volume, mesh::check(ours.mesh).volume, 1e-13) << name;
    ASSERT_EQ(theirs.mesh.tetrahedron_count(), ours.mesh.tetrahedron_count()) << name;
    // It renumbers nodes, by entity.
    if (name.rfind("four", 0) == 0) continue;
    EXPECT_EQ(theirs.mesh.tetrahedra, ours.mesh.tetrahedra) << name;
    // Text of meshio's .vtu has 12 digits.
    EXPECT_LT((theirs.mesh.nodes - ours.mesh.nodes).cwiseAbs().maxCoeff(),
              name == "text.vtu" ? 1e-12 : 1e-15)
        << name;
  }
  const std::vector<std::vector<std::string>> forms{{"a.vtu"},
                                                    {"b.vtu", "--binary"},
                                                    {"c.vtu", "--order", "2"},
                                                    {"d.msh"},
                                                    {"e.msh", "--binary"},
                                                    {"f.msh", "--msh", "2.2"},
                                                    {"g.msh", "--msh", "2.2", "--binary"},
                                                    {"h.node"},
                                                    {"i.node", "--first", "0"}};
  std::vector<std::string> names;
  for (const std::vector<std::string>& form : forms) {
    std::vector<std::string> arguments{"convert", path("a.msh"), path(form[0])};
    arguments.insert(arguments.end(), form.begin() + 1, form.end());
    ASSERT_EQ(run(arguments), 0) << output();
    names.push_back(form[0]);
  }
  const nlohmann::json all = meshio(names);
  ASSERT_EQ(all.size(), forms.size());
  for (const auto& [name, seen] : all.items()) {
    EXPECT_EQ(seen["tetrahedra"], ours.mesh.tetrahedron_count()) << name;
    EXPECT_NEAR(seen["volume"], mesh::check(ours.mesh).volume, 1e-15) << name;
    if (name == "c.vtu") continue;  // also contains midside nodes
    EXPECT_EQ(seen["nodes"], ours.mesh.node_count()) << name;
    EXPECT_NEAR(seen["sum"][0], ours.mesh.nodes.row(0).sum(), 1e-12) << name;
  }
}

}  // namespace
}  // namespace palpate::mesh_tool
