#include "rt/config/key_file.hpp"

#include <stdexcept>

namespace palpate::config {

std::optional<bus::Key> read_key(const Node& root) {
  if (!root.has("access")) return {};
  const Node access =
      root.child({"access", "", "Key file for commands; absent: commands need no authentication"});
  const std::string path =
      access.path({"key_file", "",
                   "key that commands in and out are sealed with (palpate-command --make-key)"});
  try {
    return bus::read_key_file(path);
  } catch (const std::runtime_error& error) {
    access.fail("key_file", error.what());
  }
}

}  // namespace palpate::config
