// A library of a palpate whose Eigen keeps other alignments.

#include "rt/component/plugin.hpp"

extern "C" {
__attribute__((
    visibility("default"))) extern const palpate::component::PluginAbi palpate_plugin_abi;
__attribute__((visibility("default"))) void palpate_plugin_register(
    palpate::component::PluginRegistrar&);

const palpate::component::PluginAbi palpate_plugin_abi = [] {
  palpate::component::PluginAbi abi = palpate::component::kPluginAbi;
  abi.alignment = 32;
  abi.version[0] = '9';
  return abi;
}();

/// Must not be called.
void palpate_plugin_register(palpate::component::PluginRegistrar&) { std::abort(); }
}
