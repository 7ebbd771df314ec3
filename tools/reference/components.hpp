#pragma once

#include <iosfwd>
#include <string>

namespace palpate::reference {

/// The components of a library of plug-ins, by slot, with a table of the keys of each. Returns
/// false, and names the key on standard error, if one has no description. Throws config::Error if
/// the library cannot be loaded.
bool write_components(std::ostream& out, const std::string& library);

}  // namespace palpate::reference
