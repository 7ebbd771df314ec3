#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "rt/config/declarations.hpp"

namespace palpate::reference {

/// What reads a document.
enum class Reader { kDaemon, kScene, kTrain, kFit, kRecording };

/// A document to be read, with keys set otherwise.
struct Exploration {
  std::string file;  // empty: it is `text`
  std::vector<std::string> overrides;
  std::string text = "";  // YAML
  std::string kind = "";  // of a recording
};

/// Everything that was asked of it.
using Declarations = std::vector<config::Declaration>;

/// Reads it as palpated, palpate-sim, palpate-train or palpate-fit does before it begins; a
/// recording as palpate-fit does. Throws config::Error where they would refuse it.
Declarations read(Reader reader, const Exploration& exploration);

/// What `read` asks of `file`, whose keys may be names that the document gives (NAME).
Declarations declared_by(const std::string& file, const std::function<void()>& read);

/// Those of explorations.yaml; `models` is a folder to write to, for models and recordings that
/// they name. Throws config::Error.
std::vector<Exploration> explorations(Reader reader, const std::filesystem::path& models);

}  // namespace palpate::reference
