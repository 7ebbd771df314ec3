#pragma once

#include <string>
#include <vector>

#include "tools/lab/faults/transforms.hpp"

namespace palpate::faults {

/// The network between senders and a daemon in a loop that runs for hours: delivers each message
/// late, changed, several times or not at all, according to the active faults.
class FaultyWire {
 public:
  /// Activates one of the faults, from `begin` s on for up to 0.8 s; returns its name.
  std::string put_any(double begin, math::Random& random);
  /// End of the last fault, s, including messages still in transit then.
  double end() const { return end_; }

  /// Takes the sent messages and returns those that arrive by `now_ns`.
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
