#include "tools/common/discrepancy_text.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "tools/common/table.hpp"

namespace palpate::common {
namespace {

constexpr double kDegrees = 57.29577951308232;  // 1/rad

double norm(const double* v) { return std::hypot(v[0], v[1], v[2]); }

std::string place(const double* p) {
  return formatted("near (%.3f, %.3f, %.3f) m", p[0], p[1], p[2]);
}

std::string displacement(const double* value) {
  return formatted("by %.1f mm, %.1f deg", 1e3 * norm(value), kDegrees * norm(value + 3));
}

}  // namespace

int explanation_count(const discrepancy_t& message) {
  return std::clamp(static_cast<int>(message.cause_count), 0,
                    static_cast<int>(std::size(message.cause)));
}

const char* cause_text(int cause) {
  switch (cause) {
    case discrepancy_t::CAUSE_CONTACT:
      return "external contact";
    case discrepancy_t::CAUSE_SLIP:
      return "slip in the hand";
    case discrepancy_t::CAUSE_CLAMP_PLACE:
      return "displaced clamp";
    case discrepancy_t::CAUSE_CLAMP_COMPLIANCE:
      return "compliant clamp";
    case discrepancy_t::CAUSE_UNEVEN_STIFFNESS:
      return "uneven stiffness";
    case discrepancy_t::CAUSE_WEIGHT:
      return "additional weight";
    case discrepancy_t::CAUSE_SENSOR_BIAS:
      return "sensor bias";
    default:
      return "none of the known causes";
  }
}

std::string explanation_text(const discrepancy_t& message, int rank) {
  const double* value = message.value[rank];
  const int hand = message.cause_hand[rank];
  std::string text = cause_text(message.cause[rank]);
  switch (message.cause[rank]) {
    case discrepancy_t::CAUSE_CONTACT:
    case discrepancy_t::CAUSE_WEIGHT:
      text += " " + place(message.location[rank]) + formatted(", %.2f N", norm(value));
      break;
    case discrepancy_t::CAUSE_SLIP:
      text = formatted("slip in hand %d ", hand) + displacement(value);
      break;
    case discrepancy_t::CAUSE_CLAMP_PLACE:
      text = "clamp displaced " + displacement(value);
      break;
    case discrepancy_t::CAUSE_CLAMP_COMPLIANCE:
      text += formatted(", %.2f mm/N, %.2f deg/(N m)", 1e3 * value[0], kDegrees * value[1]);
      break;
    case discrepancy_t::CAUSE_UNEVEN_STIFFNESS:
      text += formatted(", %.2f times nominal at the clamp, %.2f times at the hand",
                        std::exp(value[0]), std::exp(value[1]));
      break;
    case discrepancy_t::CAUSE_SENSOR_BIAS:
      text += formatted(" of hand %d, %.2f N, %.1f mN m", hand, norm(value), 1e3 * norm(value + 3));
      break;
    default:
      break;
  }
  return text;
}

std::string component_text(const discrepancy_t& message) {
  const int axis = std::clamp(static_cast<int>(message.axis), 0, 5);
  return formatted("%s of hand %d %s %c", axis < 3 ? "force" : "torque", message.hand,
                   axis < 3 ? "along" : "about", "xyz"[axis % 3]);
}

}  // namespace palpate::common
