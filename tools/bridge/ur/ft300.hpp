#pragma once

#include <array>
#include <functional>
#include <memory>
#include <string>

#include "tools/bridge/common/protocol.hpp"
#include "tools/bridge/common/stream.hpp"

namespace palpate::ur_bridge {

/// Finds "(Fx , Fy , Fz , Mx , My , Mz)", in N and N m, in a stream of text.
class WrenchText {
 public:
  /// Takes one character. True if it has completed a reading, of six finite numbers.
  bool take(char character, math::Wrench& wrench);
  /// The text continues in another place.
  void restart() { is_inside_ = false; }
  std::int64_t malformed() const { return malformed_; }

 private:
  bool parse(math::Wrench& wrench) const;

  std::string text_;  // since the last "("
  bool is_inside_ = false;
  std::int64_t malformed_ = 0;
};

/// The stream of a Robotiq FT 300 or FT 300-S whose software runs on the controller; connects again
/// after every failure.
class Ft300 final : public bridge::WrenchInput {
 public:
  /// `polarity`: 1 if the sensor reports its wrench on the hand, -1 if that of the hand on it.
  /// `now_ns`: any steady clock.
  Ft300(std::unique_ptr<bridge::Stream> stream, double polarity,
        std::function<std::int64_t()> now_ns);

  bool take(math::Wrench& wrench_S) override;
  std::int64_t readings() const { return readings_; }
  std::int64_t malformed() const { return text_.malformed(); }

 private:
  void connect(std::int64_t now_ns);

  std::unique_ptr<bridge::Stream> stream_;
  double polarity_;
  std::function<std::int64_t()> now_ns_;
  WrenchText text_;
  std::int64_t again_ns_ = 0, heard_ns_ = 0;
  std::array<std::uint8_t, 1024> received_{};
  int begin_ = 0, end_ = 0;  // of received_, what has not been taken
  std::int64_t readings_ = 0;
};

}  // namespace palpate::ur_bridge
