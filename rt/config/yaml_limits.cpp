#include "rt/config/yaml_limits.hpp"

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <vector>

#include "rt/config/node.hpp"

namespace palpate::config {
namespace {

class Inspector final : public YAML::EventHandler {
 public:
  Inspector(const std::string& name, const YamlLimits& limits) : name_(name), limits_(limits) {}
  void OnDocumentStart(const YAML::Mark&) override {}
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    charge(mark, kScalar);
    close(kScalar, anchor);
  }
  void OnScalar(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                const std::string&) override {
    OnNull(mark, anchor);
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    if (!limits_.aliases) fail(mark, "has an alias (*name); allowed: none");
    const auto found = anchored_.find(anchor);
    if (found == anchored_.end()) fail(mark, "has an alias (*name) of what it is a part of");
    charge(mark, found->second);
    close(found->second, 0);
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    charge(mark, kEmptyList);
    open_.push_back({kEmptyList, anchor});
  }
  void OnSequenceEnd() override {
    const Open closed = open_.back();
    open_.pop_back();
    close(closed.extent, closed.anchor);
  }
  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value style) override {
    OnSequenceStart(mark, tag, anchor, style);
  }
  void OnMapEnd() override { OnSequenceEnd(); }

 private:
  /// Extent of a node including all nodes below it.
  struct Extent {
    int items;
    int depth;
  };
  static constexpr Extent kScalar{1, 0}, kEmptyList{1, 1};
  struct Open {
    Extent extent;
    YAML::anchor_t anchor;
  };

  void charge(const YAML::Mark& mark, const Extent& extent) {
    if (static_cast<int>(open_.size()) + extent.depth > limits_.depth)
      fail(mark, "is nested more than " + std::to_string(limits_.depth) + " deep");
    if (extent.items > limits_.items - items_)
      fail(mark, "has more than " + std::to_string(limits_.items) + " items");
    items_ += extent.items;
  }

  /// A node is complete: aliases may refer to it, and its parent grows by its extent.
  void close(const Extent& extent, YAML::anchor_t anchor) {
    if (anchor != 0) anchored_[anchor] = extent;
    if (open_.empty()) return;
    Extent& around = open_.back().extent;
    around.items += extent.items;
    around.depth = std::max(around.depth, extent.depth + 1);
  }

  [[noreturn]] void fail(const YAML::Mark& mark, const std::string& problem) const {
    throw Error(name_ + ":" + std::to_string(mark.line + 1) + ": the " + limits_.what + " " +
                problem);
  }

  const std::string& name_;
  const YamlLimits& limits_;
  int items_ = 0;
  std::vector<Open> open_;
  std::map<YAML::anchor_t, Extent> anchored_;
};

}  // namespace

void check_limits(const std::string& text, const std::string& name, const YamlLimits& limits) {
  try {
    std::istringstream stream(text);
    YAML::Parser parser(stream);
    Inspector inspector(name, limits);
    while (parser.HandleNextDocument(inspector)) {
    }
  } catch (const YAML::Exception& error) {
    const std::string line = error.mark.is_null() ? "" : ":" + std::to_string(error.mark.line + 1);
    throw Error(name + line + ": not valid YAML: " + error.msg);
  }
}

std::string read_text(const std::string& path, std::size_t largest) {
  std::ifstream file(path);
  if (!file || std::filesystem::is_directory(path)) throw Error(path + ": cannot be read");
  std::string text(largest + 1, '\0');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(file.gcount()));
  if (text.size() > largest)
    throw Error(path + ": has more than " + std::to_string(largest) + " bytes");
  return text;
}

}  // namespace palpate::config
