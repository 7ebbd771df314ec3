// A library of one control law, which never moves anything, with the registration of a variant.

#include <chrono>
#include <memory>
#include <stdexcept>
#include <thread>

#include "rt/plugin/plugin.hpp"

#ifndef LAW_NAME
#define LAW_NAME "resting"
#endif

namespace {

struct Options {};

class Resting : public palpate::plugin::PluginControlLaw {
 public:
  void configure_for(const palpate::shape::Feature&) override {}
  void compute(const palpate::control::LawInputs&, palpate::plugin::PluginLawOutput&) override {}
};

}  // namespace

PALPATE_PLUGIN(registrar) {
  registrar.control_laws.add(LAW_NAME, palpate::config::OptionTable<Options>(),
                             [](const Options&, const palpate::plugin::PluginCell&) {
                               return std::make_unique<Resting>();
                             });
#if defined(REGISTRATION_THROWS)
  throw std::runtime_error("there is no licence for it");
#elif defined(REGISTRATION_HANGS)
  for (;;) std::this_thread::sleep_for(std::chrono::hours(1));
#endif
}
