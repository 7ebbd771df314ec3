#pragma once

#include <memory>
#include <string>
#include <vector>

#include "rt/config/node.hpp"
#include "rt/plugin/plugin.hpp"

namespace palpate::plugin {

/// Components of the user's libraries in the list `plugins` of the configuration:
///   plugins:
///     - library: path/libmine.so   # relative to the configuration file
///     - library: palpate-baselines.so   # of palpate itself: next to the program or in lib/palpate
/// A library stays loaded until the process ends, because its components may live as long.
class Plugins {
 public:
  /// Loads the libraries and registers their components. Throws config::Error with file and key for
  /// a library that cannot be loaded, is not a plug-in, was built for another version of palpate,
  /// or whose registration throws, takes more than 4 s, or contains an invalid or repeated name of
  /// a component or key. Without the key there are no components.
  static std::shared_ptr<const Plugins> load(const config::Node& root);

  const PluginRegistrar& components() const noexcept { return components_; }

 private:
  void add(const std::string& path, const config::Node& item);

  PluginRegistrar components_;
};

/// Entry of that name; nullptr if no plug-in has it.
template <class Component>
const PluginEntry<Component>* find_plugin(const PluginList<Component>& list,
                                          const std::string& name) {
  for (const PluginEntry<Component>& entry : list.entries())
    if (entry.name == name) return &entry;
  return nullptr;
}

}  // namespace palpate::plugin
