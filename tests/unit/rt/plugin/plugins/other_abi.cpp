// A library built for another version of palpate or of its interface.

#include "rt/plugin/plugin.hpp"

extern "C" {
__attribute__((visibility("default"))) extern const palpate::plugin::PluginAbi palpate_plugin_abi;
__attribute__((visibility("default"))) void palpate_plugin_register(
    palpate::plugin::PluginRegistrar&);

const palpate::plugin::PluginAbi palpate_plugin_abi = [] {
  palpate::plugin::PluginAbi abi = palpate::plugin::kPluginAbi;
#ifdef OTHER_INTERFACE
  abi.interface = 1;
#else
  abi.version[0] = '9';
#endif
  return abi;
}();

/// Must not be called.
void palpate_plugin_register(palpate::plugin::PluginRegistrar&) { std::abort(); }
}
