#pragma once

#include <string>
#include <vector>

#include "tools/lab/faults/transforms.hpp"

namespace palpate::faults {

/// What lies between senders and a daemon in a loop that goes on for hours: hands each message on
/// late, changed, several times or not at all, as the faults say that are on it.
class FaultyWire {
 public:
  /// Puts one of the faults on, from `begin` s on for up to 0.8 s; returns its name.
  std::string put_any(double begin, math::Random& random);
  /// When the last of them ends, s, with what is still under way then.
  double end() const { return end_; }

  /// Takes what was sent and gives what arrives by `now_ns`.
  Stream pass(Stream sent, std::int64_t now_ns);

 private:
  /// Times of arrival may be moved into the future.
  using Change = std::function<Stream(const Stream&)>;
  struct Fault {
    double end;
    Change change;
  };
  std::vector<Fault> faults_;
  Stream under_way_;
  double end_ = 0;
};

}  // namespace palpate::faults
