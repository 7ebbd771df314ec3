#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "rt/config/declarations.hpp"

namespace palpate::reference {

/// What reads a document.
enum class Reader { kDaemon, kScene, kTrain, kFit, kStudy };

/// A document to be read, with keys set otherwise.
struct Exploration {
  std::string file;
  std::vector<std::string> overrides;
};

/// Everything that was asked of it.
using Declarations = std::vector<config::Declaration>;

/// Reads it as palpated, palpate-sim, palpate-train, palpate-fit or palpate-evaluate does before it
/// begins. Throws config::Error
/// where they would refuse it.
Declarations read(Reader reader, const Exploration& exploration);

/// Those of explorations.yaml; `models` is a folder to write to, for models that they name. Throws
/// config::Error.
std::vector<Exploration> explorations(Reader reader, const std::filesystem::path& models);

}  // namespace palpate::reference
