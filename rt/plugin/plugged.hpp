#pragma once

#include <memory>
#include <string>
#include <utility>

#include "rt/plugin/supervision.hpp"

namespace palpate::plugin {

inline constexpr char kOutOfBounds[] = "the plug-in wrote past its output";

/// A plug-in's component that is called through guards. After an exception, a write out of bounds
/// or a missed deadline its state is undefined: it is not called again before recover().
template <class Component>
class Plugged {
 public:
  /// `name`: for messages, e.g. "control law 'mine' of libmine.so".
  Plugged(std::unique_ptr<Component> component, std::string name)
      : component_(std::move(component)), name_(std::make_shared<const std::string>(name)) {}

  /// Runs `call(component)`, which refers to nothing on the caller's stack while a SetupScope is
  /// active. False if it has not ended well; why() is the reason.
  template <class Call>
  bool call(const Call& call) const noexcept {
    if (why_ != nullptr) return false;
    try {
      if (SetupScope::is_active()) {
        within_deadline(*name_, [component = component_, call] { call(*component); });
      } else {
        const InCall mark(name_->c_str());
        call(*component_);
      }
      return true;
    } catch (const Hung& hung) {
      fail("the plug-in does not return");
      hung_ = true;
      SetupScope::note(hung.what());
    } catch (const std::exception& error) {
      fail("the plug-in threw an exception");
      if (SetupScope::is_active()) SetupScope::note(*name_ + ": " + error.what());
    } catch (...) {
      fail("the plug-in threw an exception");
      if (SetupScope::is_active()) SetupScope::note(*name_ + ": threw no std::exception");
    }
    return false;
  }

  /// Calls at set-up: always with the deadline; exceptions are passed on.
  template <class Call>
  void set_up(const Call& call) const {
    within_deadline(*name_, [component = component_, call] { call(*component); });
  }

  /// Fails, and repairs the guard words (fence.hpp), if an output was written out of bounds.
  template <class... Outputs>
  void check(Outputs&... outputs) const noexcept {
    if ((outputs.is_intact() && ...)) return;
    (outputs.repair(), ...);
    fail(kOutOfBounds);
  }

  /// `why`: a string literal.
  void fail(const char* why) const noexcept { why_ = why; }
  /// nullptr: sound.
  const char* why() const noexcept { return why_; }
  /// Allows calls again, unless one has not returned.
  void recover() noexcept {
    if (!hung_) why_ = nullptr;
  }
  /// recover() and reset() of the component.
  void reset() noexcept {
    recover();
    call([](Component& component) { component.reset(); });
  }
  const std::string& name() const noexcept { return *name_; }

 private:
  std::shared_ptr<Component> component_;
  std::shared_ptr<const std::string> name_;
  mutable const char* why_ = nullptr;
  mutable bool hung_ = false;
};

}  // namespace palpate::plugin
