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

/// Folder below which scenes, examples and presets lie as in the source tree ("sim/scenes",
/// "rt/config/examples", "tools/fit/presets"): the source tree itself for a program in its build
/// folder, which the file palpate.source beside it names, or else share/palpate of the prefix that
/// the program was installed to, wherever that has been moved. Throws std::runtime_error where
/// there is neither.
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

/// A library or helper program that comes with the running one: beside it in a build folder, in
/// lib/palpate of the prefix after installation.
inline std::filesystem::path companion(const std::string& name) {
  const std::filesystem::path here = program_folder();
  if (std::filesystem::exists(here / name)) return here / name;
  return (here / "../lib/palpate" / name).lexically_normal();
}

}  // namespace palpate::config
