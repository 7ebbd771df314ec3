#pragma once

#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

namespace palpate::config {

/// Folder of the running program.
inline std::filesystem::path program_folder() {
  return std::filesystem::read_symlink("/proc/self/exe").parent_path();
}

/// Folder that contains scenes, examples and presets as in the source tree ("sim/scenes",
/// "rt/config/examples", "tools/fit/presets"): the source tree itself for a program in its build
/// folder, named by the file palpate.source next to it, otherwise share/palpate of the installation
/// prefix, wherever that has been moved. Throws std::runtime_error if neither exists.
inline std::filesystem::path data_folder() {
  const std::filesystem::path here = program_folder();
  std::ifstream named(here / "palpate.source");
  std::string source;
  if (std::getline(named, source) && std::filesystem::is_directory(source)) return source;
  const std::filesystem::path shared = (here / "../share/palpate").lexically_normal();
  if (std::filesystem::is_directory(shared)) return shared;
  throw std::runtime_error("palpate's scenes and presets are missing: there is no folder " +
                           shared.string());
}

/// Library or helper program that belongs to the running one: next to it in a build folder, in
/// lib/palpate of the prefix after installation.
inline std::filesystem::path companion(const std::string& name) {
  const std::filesystem::path here = program_folder();
  if (std::filesystem::exists(here / name)) return here / name;
  return (here / "../lib/palpate" / name).lexically_normal();
}

}  // namespace palpate::config
