#include "rt/plugin/plugins.hpp"

#include <dlfcn.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <set>

#include "rt/config/installation.hpp"
#include "rt/plugin/built_in_names.hpp"
#include "rt/plugin/supervision.hpp"

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

/// clang reports version 2 whatever it implements, which is what gcc does from version 13 on.
bool is_same_cxx_abi(std::int32_t a, std::int32_t b) {
  constexpr std::int32_t kOfClang = 1002, kLikeClang = 1013;
  return a == b || (std::min(a, b) == kOfClang && std::max(a, b) >= kLikeClang);
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
  if (!is_same_cxx_abi(theirs.compiler, ours.compiler))
    compare("C++ ABI", theirs.compiler, ours.compiler);
  compare("kind of std::string", theirs.strings, ours.strings);
  compare("Eigen", theirs.eigen, ours.eigen);
  compare("EIGEN_MAX_ALIGN_BYTES", theirs.alignment, ours.alignment);
  compare("EIGEN_MAX_STATIC_ALIGN_BYTES", theirs.static_alignment, ours.static_alignment);
  compare("EIGEN_MALLOC_ALREADY_ALIGNED", theirs.malloc_aligned, ours.malloc_aligned);
  compare("size of sensing::Signals", theirs.signals, ours.signals);
  compare("size of sensing::ContactSet", theirs.contacts, ours.contacts);
  compare("size of control::LawInputs", theirs.inputs, ours.inputs);
  compare("size of PluginLawOutput", theirs.outputs, ours.outputs);
  compare("size of PluginCell", theirs.cell, ours.cell);
  compare("size of elasticity::Body", theirs.model, ours.model);
  compare("size of estimation::EstimationInputs", theirs.measurements, ours.measurements);
  compare("size of estimation::Estimate", theirs.estimate, ours.estimate);
  compare("size of elasticity::Sensitivity", theirs.sensitivity, ours.sensitivity);
  compare("size of config::Option", theirs.option, ours.option);
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

/// A name, or two of them: `section.key`.
bool is_key(const std::string& text) {
  const auto dot = text.find('.');
  return dot == std::string::npos ? is_name(text)
                                  : is_name(text.substr(0, dot)) && is_name(text.substr(dot + 1));
}

std::string complaint(const config::Option& option) {
  static const std::set<std::string> kTaken = {
      "arm", "command", "component", "discrepancy_speed", "fallback", "finger",
      "law", "moves",   "name",      "on_discrepancy",    "provider", "sources"};
  const std::string key = "key '" + option.key + "' ";
  if (!is_key(option.key)) return key + "is no name of a-z, 0-9 and _, at most 31 characters";
  if (kTaken.count(option.key) != 0) return key + "is palpate's own";
  const auto within = [&option](double value) {
    return value >= option.range.lower && value <= option.range.upper;
  };
  bool good = true;
  switch (option.kind) {
    case config::Option::Kind::kNumber:
      good = within(std::get<double>(option.otherwise));
      break;
    case config::Option::Kind::kInteger:
      good = within(std::get<int>(option.otherwise));
      break;
    case config::Option::Kind::kChoice: {
      const auto& choices = option.choices;
      good = std::find(choices.begin(), choices.end(), std::get<std::string>(option.otherwise)) !=
             choices.end();
      break;
    }
    case config::Option::Kind::kNumbers: {
      const auto& list = std::get<std::vector<double>>(option.otherwise);
      good = std::all_of(list.begin(), list.end(), within);
      break;
    }
    case config::Option::Kind::kFlag:
    case config::Option::Kind::kFile:
      break;
  }
  return good || option.required ? "" : key + "has a default that it does not allow";
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
    for (const config::Option& option : entry.options) {
      const std::string wrong = complaint(option);
      if (!wrong.empty()) return which + wrong;
      if (!keys.insert(option.key).second) return which + "has the key '" + option.key + "' twice";
    }
  }
  return "";
}

/// The library's file, for a path as configured: a name without a folder may be one of palpate's
/// own libraries.
std::string find_library(const config::Node& item) {
  const config::Key key("library", "",
                        "shared library, relative to this file, or the name of one of palpate's: "
                        "palpate-baselines.so");
  const std::string path = item.path(key), text = item.text(key);
  std::error_code ignored;
  if (text.find('/') != std::string::npos || std::filesystem::is_regular_file(path, ignored))
    return path;
  const std::filesystem::path own = config::companion(text);
  return std::filesystem::is_regular_file(own, ignored) ? own.string() : path;
}

}  // namespace

std::shared_ptr<const Plugins> Plugins::load(const config::Node& root) {
  auto plugins = std::make_shared<Plugins>();
  for (const config::Node& item :
       root.list({"plugins", "", "libraries with components of your own (tools/examples)"}))
    plugins->add(find_library(item), item);
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
    refuse(item, path, "was built for another palpate (" + differs + "); build it again");

  const auto incoming = std::make_shared<PluginRegistrar>();
  try {
    within_deadline("its registration", [enter, incoming] { enter(*incoming); });
  } catch (const Hung& hung) {
    refuse(item, path, hung.what());
  } catch (const std::exception& error) {
    refuse(item, path, std::string("its registration failed: ") + error.what());
  } catch (...) {
    refuse(item, path, "its registration threw something that is no std::exception");
  }
  const auto take = [&](const char* slot, const auto& built_in, auto& from, auto& all) {
    const std::string wrong = complaint(slot, from.entries(), built_in, all.entries());
    if (!wrong.empty()) refuse(item, path, wrong);
    for (auto& entry : from.entries()) {
      entry.library = std::filesystem::path(path).filename().string();
      all.entries().push_back(std::move(entry));
    }
  };
  PluginRegistrar& all = components_;
  take("sensor model", kSensorModels, incoming->sensor_models, all.sensor_models);
  take("force transformer", kForceTransformers, incoming->force_transformers,
       all.force_transformers);
  take("estimator", kEstimators, incoming->estimators, all.estimators);
  take("deformation model", kDeformationModels, incoming->deformation_models,
       all.deformation_models);
  take("feature", kFeatures, incoming->features, all.features);
  take("Jacobian provider", kJacobianProviders, incoming->jacobian_providers,
       all.jacobian_providers);
  take("control law", kControlLaws, incoming->control_laws, all.control_laws);
}

}  // namespace palpate::plugin
