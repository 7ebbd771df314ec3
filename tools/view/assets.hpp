#pragma once

#include <map>
#include <string>
#include <string_view>

namespace palpate::view {

struct Asset {
  std::string type;  // MIME
  std::string body;
};

/// Files that the server delivers: a fixed list of names, read at the start, so that no request can
/// name any other file.
class Assets {
 public:
  /// The page, which is embedded in the program, and three.js from the folder `three` of Debian's
  /// libjs-three. Throws std::runtime_error with the remedy if that is missing.
  explicit Assets(const std::string& three);

  /// nullptr if there is none; "/" is the page.
  const Asset* find(std::string_view path) const;
  const std::map<std::string, Asset, std::less<>>& all() const { return assets_; }

 private:
  std::map<std::string, Asset, std::less<>> assets_;
};

/// Files of tools/view/page, by name: embedded at build time.
const std::map<std::string, std::string>& page_files();

}  // namespace palpate::view
