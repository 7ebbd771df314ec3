#pragma once

#include <filesystem>
#include <string>

namespace palpate::runs {

/// "path.to.key=value" for a relative change of the file's value (with its bases):
/// "path.to.key*=factor" of a number or of each in a list, where integers stay integers and at
/// least 1 (numbers of cells), or "path.to.key+=step" of a number. Anything else is returned
/// unchanged. Throws config::Error if the file has no such number.
std::string absolute_override(const std::string& item, const std::filesystem::path& file);

}  // namespace palpate::runs
