#pragma once

#include <iosfwd>
#include <vector>

#include "tools/reference/catalogue.hpp"

namespace palpate::reference {

/// One table a section, its heading at `level`.
void write_markdown(std::ostream& out, const std::vector<Section>& sections, int level);

}  // namespace palpate::reference
