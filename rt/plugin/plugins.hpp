#pragma once

#include <memory>
#include <string>
#include <vector>

#include "rt/config/node.hpp"
#include "rt/plugin/plugin.hpp"

namespace palpate::plugin {

/// The components of a user's own libraries, which the list `plugins` of the configuration names:
///   plugins:
///     - library: path/libmine.so   # relative to the file that says it
/// A library stays loaded until the process ends, since what it made may live as long.
class Plugins {
 public:
  /// Loads and registers. Throws config::Error with file and key: a library that cannot be loaded,
  /// is none of palpate's, was built for another palpate, or whose registration throws, or names a
  /// component or key wrongly or twice. No key: no components.
  static std::shared_ptr<const Plugins> load(const config::Node& root);

  const PluginRegistrar& components() const noexcept { return components_; }

 private:
  void add(const std::string& path, const config::Node& item);

  PluginRegistrar components_;
};

/// The built-in names, and after them those of plug-ins.
template <class Component>
std::vector<std::string> with_plugins(std::vector<std::string> names,
                                      const std::vector<PluginEntry<Component>>& entries) {
  for (const PluginEntry<Component>& entry : entries) names.push_back(entry.name);
  return names;
}

/// The entry of that name; nullptr where no plug-in has it.
template <class Component>
const PluginEntry<Component>* find_plugin(const std::vector<PluginEntry<Component>>& entries,
                                          const std::string& name) {
  for (const PluginEntry<Component>& entry : entries)
    if (entry.name == name) return &entry;
  return nullptr;
}

}  // namespace palpate::plugin
