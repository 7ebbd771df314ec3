#pragma once

#include <CLI/CLI.hpp>
#include <iostream>
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
  nlohmann::json more = nlohmann::json::object();  // further entries of the JSON
  std::string picture;                             // of faults, or of the mesh if there are none
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

/// The same for a rejected mesh, which is not written: always with an image, by default next to
/// the output.
template <typename Mesh>
int reject(const Mesh& mesh, const Outcome& outcome, const OutputOptions& output,
           ReportOptions options) {
  std::cerr << outcome.file << ": rejected, nothing is written\n";
  if (options.picture.empty()) options.picture = output.file + ".faults.png";
  options.histograms.clear();
  return report(mesh, outcome, options);
}

inline void write(const mesh::MeshWithGroups& mesh, const OutputOptions& output) {
  write_volume(mesh, output.file, output.format());
}
inline void write(const mesh::TriangleSurface& surface, const OutputOptions& output) {
  write_surface(surface, output.file);
}

/// Finds the faults of the result; writes it and reports, or rejects it if there are errors.
template <typename Mesh>
int finish(const Mesh& mesh, Outcome outcome, const OutputOptions& output,
           const ReportOptions& options) {
  outcome.faults = find_faults(mesh);
  if (has_errors(outcome.faults)) return reject(mesh, outcome, output, options);
  write(mesh, output);
  return report(mesh, outcome, options);
}

/// Stream of the text: with JSON, nothing else may be written to the standard output.
std::ostream& text_output(const ReportOptions& options);

/// "repaired: nodes merged ...: 2 (4, 7)", one line each.
std::string text(const std::vector<mesh::RepairStep>& steps);

}  // namespace palpate::mesh_tool
