#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "core/mesh/repair.hpp"
#include "tools/mesh/faults.hpp"
#include "tools/mesh/mesh_files.hpp"

namespace palpate::mesh_tool {

/// Options shared by the commands that write a mesh.
struct OutputOptions {
  std::string file;
  int order = 1;
  std::string version = "4.1";
  bool binary = false;
  int first = 1;

  FileFormat format() const;
};

/// Outputs that every command can produce in addition.
struct ReportOptions {
  std::string json;
  std::string picture;  // of faults, or of the mesh if there are none
  std::string histograms;
  bool cost = false;
};

void add_output_options(CLI::App& command, OutputOptions& options);
void add_report_options(CLI::App& command, ReportOptions& options);

/// --scale: a factor, or the file's unit (m, dm, cm, mm, um, inch).
void add_scale_option(CLI::App& command, double& scale);

/// Repairs of a mesh, and its resulting state.
struct Outcome {
  std::string file;  // named in messages
  std::vector<mesh::RepairStep> steps;
  std::vector<Fault> faults;
};

/// Prints repairs and faults, then the quality of a mesh that has no errors (with the outputs
/// requested by the options) and writes JSON and images. Returns the exit code.
int report(const mesh::MeshWithGroups& mesh, const Outcome& outcome, const ReportOptions& options);
int report(const mesh::TriangleSurface& surface, const Outcome& outcome,
           const ReportOptions& options);

/// The same for a rejected mesh: always with an image, by default `picture`.
template <typename Mesh>
int refuse(const Mesh& mesh, const Outcome& outcome, ReportOptions options,
           const std::string& picture) {
  if (options.picture.empty()) options.picture = picture;
  options.histograms.clear();
  return report(mesh, outcome, options);
}

/// "repaired: nodes merged ...: 2 (4, 7)", one line each.
std::string text(const std::vector<mesh::RepairStep>& steps);

}  // namespace palpate::mesh_tool
