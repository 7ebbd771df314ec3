// palpate-baselines.so: published methods as components, which a configuration loads by
//   plugins: [{library: palpate-baselines.so}]
// They implement the interfaces of the built-in components and are called directly.

#include "tools/lab/baselines/components.hpp"

PALPATE_PLUGIN(registrar) {
  palpate::baselines::add_providers(registrar);
  palpate::baselines::add_estimators(registrar);
  palpate::baselines::add_deformation_models(registrar);
}
