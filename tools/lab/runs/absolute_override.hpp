#pragma once

#include <filesystem>
#include <string>

namespace palpate::runs {

/// "path.to.key=value" for a relative change of what the file (with its bases) says:
/// "path.to.key*=factor" of a number or of each in a list, where whole numbers stay whole and at
/// least 1 (numbers of cells), or "path.to.key+=step" of a number. Anything else is returned as it
/// is. Throws config::Error where the file has no such number.
std::string absolute_override(const std::string& item, const std::filesystem::path& file);

}  // namespace palpate::runs
