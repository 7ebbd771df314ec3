#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <palpate/component_event_t.hpp>
#include <palpate/discrepancy_t.hpp>
#include <palpate/health_t.hpp>
#include <string>
#include <string_view>

#include "tools/record/listener.hpp"

namespace palpate::top {

inline constexpr int kPhases = 10;
/// In the order of health_t.
extern const std::array<const char*, kPhases> kPhaseNames;

/// Text of a char array of a message, as far as it is printable.
std::string printable(const std::uint8_t* field, int size);

/// The last HEALTH, COMPONENT_EVENT and DISCREPANCY of palpated.
class DaemonWatch {
 public:
  void take(const record::Heard& heard);

  const std::optional<health_t>& health() const noexcept { return health_; }
  double health_age(std::int64_t now_ns) const noexcept;  // s
  /// Number of daemons that published within the last two seconds.
  int daemons(std::int64_t now_ns) const noexcept;
  /// The last event, in one line; empty if there was none.
  const std::string& event() const noexcept { return event_; }
  /// The last test of the wrenches; nullptr if there was none within the last two seconds.
  const discrepancy_t* discrepancy(std::int64_t now_ns) const noexcept;

 private:
  std::optional<health_t> health_;
  std::int64_t health_ns_ = 0;
  std::map<std::int64_t, std::int64_t> heard_;  // by session: when
  std::string event_;
  std::optional<discrepancy_t> discrepancy_;
  std::int64_t discrepancy_ns_ = 0;
};

}  // namespace palpate::top
