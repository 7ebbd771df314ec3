#include "core/mesh/mesh_writer.hpp"
#include "tools/fit/simulators/simulator_files.hpp"

namespace palpate::fit {

void write_sofa(const SoftObject& object, const std::string& mesh_file, std::ostream& out) {
  using mesh::shortest;
  if (object.materials.size() > 1)
    throw config::Error(object.configuration +
                        ": object.material.regions: the scene of SOFA has one material; allowed: "
                        "--mjcf");
  const elasticity::Material& material = object.materials.front();
  out << "<?xml version=\"1.0\"?>\n<!--\n";
  for (const std::string& line : remarks(object)) out << "  " << line << '\n';
  out << "  Law: linear, co-rotated by the polar decomposition of each tetrahedron, palpate's.\n"
         "  Solver: implicit Euler with a direct solver. From SOFA 24.06.\n-->\n"
      << "<Node name=\"root\" dt=\"0.01\" gravity=\"" << words(object.gravity_W)
      << "\">\n  <RequiredPlugin name=\"Sofa.Component\"/>\n  <DefaultAnimationLoop/>\n"
      << "  <Node name=\"object\">\n    <EulerImplicitSolver rayleighStiffness=\""
      << shortest(object.damping.stiffness_factor) << "\" rayleighMass=\""
      << shortest(object.damping.mass_factor)
      << "\"/>\n    <SparseLDLSolver template=\"CompressedRowSparseMatrixMat3x3d\"/>\n"
      << "    <MeshVTKLoader name=\"loader\" filename=\"" << mesh_file
      << "\"/>\n    <TetrahedronSetTopologyContainer src=\"@loader\"/>\n"
      << "    <TetrahedronSetGeometryAlgorithms template=\"Vec3d\"/>\n"
      << "    <MechanicalObject template=\"Vec3d\" src=\"@loader\"/>\n"
      << "    <TetrahedronFEMForceField method=\"polar\" youngModulus=\""
      << shortest(material.young_modulus) << "\" poissonRatio=\""
      << shortest(material.poisson_ratio) << "\"/>\n    <MeshMatrixMass massDensity=\""
      << shortest(material.density)
      << "\" lumping=\"true\"/>\n    <FixedProjectiveConstraint indices=\"";
  for (const int node : object.fixed) out << node << ' ';
  out << "\"/>\n  </Node>\n</Node>\n";
}

}  // namespace palpate::fit
