#include "tools/view/assets.hpp"

#include <fstream>
#include <sstream>
#include <stdexcept>

namespace palpate::view {
namespace {

std::string type_of(const std::string& name) {
  const std::string suffix = name.substr(name.rfind('.') + 1);
  if (suffix == "html") return "text/html; charset=utf-8";
  if (suffix == "css") return "text/css; charset=utf-8";
  if (suffix == "svg") return "image/svg+xml";
  return "text/javascript; charset=utf-8";
}

std::string read(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  if (!file || text.str().empty())
    throw std::runtime_error(path +
                             ": cannot be read; apt-get install libjs-three, or name the folder "
                             "of three.min.js by --three");
  return text.str();
}

}  // namespace

Assets::Assets(const std::string& three) {
  for (const auto& [name, body] : page_files()) assets_["/" + name] = {type_of(name), body};
  assets_["/"] = assets_.at("/index.html");
  const std::string script = type_of(".js");
  assets_["/three.js"] = {script, read(three + "/three.min.js")};
  assets_["/orbit_controls.js"] = {script, read(three + "/examples/js/controls/OrbitControls.js")};
}

const Asset* Assets::find(std::string_view path) const {
  const auto found = assets_.find(path);
  return found == assets_.end() ? nullptr : &found->second;
}

}  // namespace palpate::view
