#include "tools/lab/studies/shard.hpp"

#include <sstream>
#include <stdexcept>

namespace palpate::studies {

Shard read_shard(const std::string& text) {
  std::istringstream in(text);
  long index = 0, count = 0;
  char slash = 0, more = 0;
  if (!(in >> index >> slash >> count) || slash != '/' || in >> more || index < 1 || index > count)
    throw std::invalid_argument("a shard is I/N with 1 <= I <= N, such as 2/8; not \"" + text +
                                "\"");
  return {static_cast<std::size_t>(index), static_cast<std::size_t>(count)};
}

}  // namespace palpate::studies
