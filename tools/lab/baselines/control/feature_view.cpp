#include "tools/lab/baselines/control/feature_view.hpp"

#include <stdexcept>
#include <string>

namespace palpate::baselines {

void check_plain(const shape::Feature& feature) {
  if (feature.value_count() != feature.dimension())
    throw std::invalid_argument(std::string("a feature of kind ") + feature.kind() +
                                " cannot be learnt: its error is no difference of values");
}

void check_points(const shape::Feature& feature) {
  const std::string kind = feature.kind();
  check_plain(feature);
  if (kind != "point" && kind != "points")
    throw std::invalid_argument("a feature of kind " + kind + " is no point and no set of points");
}

void PlainView::resize(const shape::Feature& feature) {
  check_plain(feature);
  rows_ = feature.dimension();
}

}  // namespace palpate::baselines
