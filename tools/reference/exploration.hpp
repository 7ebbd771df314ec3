#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tools/reference/catalogue.hpp"

namespace palpate::reference {

/// The program that reads a document.
enum class Reader { kDaemon, kScene, kTrain, kFit, kRecording };

/// A document to be read, with overridden keys.
struct Exploration {
  std::string file;  // empty: it is `text`
  std::vector<std::string> overrides;
  std::string text = "";  // YAML
  std::string kind = "";  // of a recording
  /// The section to keep of a document that is rejected after that has been read; empty: all of one
  /// that is valid.
  std::string only = "";
};

/// Reads it as palpated, palpate-sim, palpate-train or palpate-fit does before it starts; a
/// recording as palpate-fit does. Throws config::Error if they would reject it.
Declarations read(Reader reader, const Exploration& exploration);

/// The documents of explorations.yaml; `models` is a folder for models and recordings that they
/// name. Throws config::Error.
std::vector<Exploration> explorations(Reader reader, const std::filesystem::path& models);

}  // namespace palpate::reference
