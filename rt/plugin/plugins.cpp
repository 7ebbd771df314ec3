#include "rt/plugin/plugins.hpp"

#include <dlfcn.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <set>

#include "rt/plugin/built_in_names.hpp"

namespace palpate::plugin {
namespace {

constexpr int kLongestName = 31;  // capacity of the message field

[[noreturn]] void refuse(const config::Node& item, const std::string& path,
                         const std::string& what) {
  item.fail("library", path + ": " + what);
}

/// dlerror() also contains the path, or a library required by this one.
std::string why_not_loaded(const std::string& path) {
  const char* error = dlerror();
  std::string text = error == nullptr ? "unknown error" : error;
  if (text.rfind(path + ": ", 0) == 0) text.erase(0, path.size() + 2);
  return text;
}

/// Description of the difference; empty if there is none. Sizes are not compared if the structure
/// is too short.
std::string difference(const PluginAbi& theirs) {
  const PluginAbi& ours = kPluginAbi;
  if (theirs.magic != ours.magic) return "its palpate_plugin_abi is none";
  std::string text;
  const auto compare = [&text](const char* what, const auto& there, const auto& here) {
    if (there == here) return;
    text += std::string(text.empty() ? "" : ", ") + what + " " + std::to_string(there) + ", here " +
            std::to_string(here);
  };
  compare("plug-in interface", theirs.interface, ours.interface);
  if (!text.empty()) return text;
  compare("size of the description", theirs.size, ours.size);
  if (!text.empty()) return text;
  const std::string version(theirs.version, strnlen(theirs.version, sizeof theirs.version));
  if (version != ours.version) text = "palpate " + version + ", here " + ours.version;
  compare("C++ ABI", theirs.compiler, ours.compiler);
  compare("kind of std::string", theirs.strings, ours.strings);
  compare("Eigen", theirs.eigen, ours.eigen);
  compare("EIGEN_MAX_ALIGN_BYTES", theirs.alignment, ours.alignment);
  compare("size of sensing::Signals", theirs.signals, ours.signals);
  compare("size of sensing::ContactSet", theirs.contacts, ours.contacts);
  compare("size of control::LawInputs", theirs.inputs, ours.inputs);
  compare("size of control::LawOutput", theirs.outputs, ours.outputs);
  compare("size of PluginCell", theirs.cell, ours.cell);
  compare("size of elasticity::Body", theirs.model, ours.model);
  return text;
}

/// For names of components and keys.
bool is_name(const std::string& text) {
  const auto is_word = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
  };
  return !text.empty() && text.size() <= kLongestName && text[0] >= 'a' && text[0] <= 'z' &&
         std::all_of(text.begin(), text.end(), is_word);
}

std::string complaint(const Parameter& parameter) {
  static const std::set<std::string> kTaken = {"arm",      "command", "component", "fallback",
                                               "finger",   "law",     "moves",     "name",
                                               "provider", "sources"};
  const std::string key = "key '" + parameter.key + "' ";
  if (!is_name(parameter.key)) return key + "is no name of a-z, 0-9 and _, at most 31 characters";
  if (kTaken.count(parameter.key) != 0) return key + "is palpate's own";
  const auto within = [&parameter](double value) {
    return value >= parameter.lower && value <= parameter.upper;
  };
  bool good = true;
  switch (parameter.kind) {
    case Parameter::Kind::kNumber:
      good = std::holds_alternative<double>(parameter.otherwise) &&
             (parameter.required || within(std::get<double>(parameter.otherwise)));
      break;
    case Parameter::Kind::kInteger:
      good = std::holds_alternative<int>(parameter.otherwise) &&
             (parameter.required || within(std::get<int>(parameter.otherwise)));
      break;
    case Parameter::Kind::kFlag:
      good = std::holds_alternative<bool>(parameter.otherwise);
      break;
    case Parameter::Kind::kChoice: {
      const auto* text = std::get_if<std::string>(&parameter.otherwise);
      const auto& allowed = parameter.allowed;
      good =
          text != nullptr && !allowed.empty() &&
          (parameter.required || std::find(allowed.begin(), allowed.end(), *text) != allowed.end());
      break;
    }
    case Parameter::Kind::kNumbers: {
      const auto* list = std::get_if<std::vector<double>>(&parameter.otherwise);
      good = list != nullptr && static_cast<int>(list->size()) == parameter.count &&
             (parameter.required || std::all_of(list->begin(), list->end(), within));
      break;
    }
  }
  return good ? "" : key + "has a default that it does not allow";
}

/// "" or the error in one of `entries`, whose names must differ from those of `before`.
template <class Component, std::size_t kCount>
std::string complaint(const char* slot, const std::vector<PluginEntry<Component>>& entries,
                      const std::array<const char*, kCount>& built_in,
                      const std::vector<PluginEntry<Component>>& before) {
  std::set<std::string> names;
  for (const auto& other : before) names.insert(other.name);
  for (const PluginEntry<Component>& entry : entries) {
    const std::string which = std::string(slot) + " '" + entry.name + "' ";
    if (!is_name(entry.name)) return which + "is no name of a-z, 0-9 and _, at most 31 characters";
    if (std::find(built_in.begin(), built_in.end(), entry.name) != built_in.end())
      return which + "has the name of a built-in one";
    if (!names.insert(entry.name).second) return which + "is there twice";
    if (!entry.make) return which + "has no function that makes it";
    std::set<std::string> keys;
    for (const Parameter& parameter : entry.parameters) {
      const std::string wrong = complaint(parameter);
      if (!wrong.empty()) return which + wrong;
      if (!keys.insert(parameter.key).second)
        return which + "has the key '" + parameter.key + "' twice";
    }
  }
  return "";
}

template <class Entry>
void append(std::vector<Entry>& into, std::vector<Entry>& from) {
  into.insert(into.end(), std::make_move_iterator(from.begin()),
              std::make_move_iterator(from.end()));
}

}  // namespace

std::shared_ptr<const Plugins> Plugins::load(const config::Node& root) {
  auto plugins = std::make_shared<Plugins>();
  for (const config::Node& item :
       root.list({"plugins", "", "libraries with components of your own (tools/examples)"}))
    plugins->add(item.path({"library", "", "shared library, relative to this file"}), item);
  return plugins;
}

void Plugins::add(const std::string& path, const config::Node& item) {
  // without a slash the library would be searched for in the system's path
  const std::string place = path.find('/') == std::string::npos ? "./" + path : path;
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(place, ignored))
    refuse(item, path, "there is no such file");
  void* const library = dlopen(place.c_str(), RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
  if (library == nullptr)
    refuse(item, path, "cannot be loaded as a plug-in: " + why_not_loaded(place));
  const auto* abi = static_cast<const PluginAbi*>(dlsym(library, "palpate_plugin_abi"));
  using Register = void (*)(PluginRegistrar&);
  const auto enter = reinterpret_cast<Register>(dlsym(library, "palpate_plugin_register"));
  if (abi == nullptr || enter == nullptr)
    refuse(item, path,
           std::string("is no plug-in of palpate: it has no ") +
               (abi == nullptr ? "palpate_plugin_abi" : "palpate_plugin_register") +
               "; see PALPATE_PLUGIN in rt/plugin/plugin.hpp");
  const std::string differs = difference(*abi);
  if (!differs.empty())
    refuse(item, path, "was built for another palpate (" + differs + "); build it anew");

  PluginRegistrar incoming;
  try {
    enter(incoming);
  } catch (const std::exception& error) {
    refuse(item, path, std::string("its registration failed: ") + error.what());
  } catch (...) {
    refuse(item, path, "its registration threw something that is no std::exception");
  }
  PluginRegistrar& all = components_;
  for (const std::string& wrong :
       {complaint("sensor model", incoming.sensor_models, kSensorModels, all.sensor_models),
        complaint("force transformer", incoming.force_transformers, kForceTransformers,
                  all.force_transformers),
        complaint("Jacobian provider", incoming.jacobian_providers, kJacobianProviders,
                  all.jacobian_providers),
        complaint("control law", incoming.control_laws, kControlLaws, all.control_laws)})
    if (!wrong.empty()) refuse(item, path, wrong);
  append(all.sensor_models, incoming.sensor_models);
  append(all.force_transformers, incoming.force_transformers);
  append(all.jacobian_providers, incoming.jacobian_providers);
  append(all.control_laws, incoming.control_laws);
}

}  // namespace palpate::plugin
