#pragma once

#include <atomic>
#include <functional>
#include <stdexcept>
#include <string>

namespace palpate::plugin {

/// Time that construction, configuration and warm-up of a plug-in's component may take, per call:
/// one that hangs is refused within 5 s.
inline constexpr double kSetupDeadline = 4;  // s

/// The plug-in's component whose code a thread executes, for a watchdog in another thread.
class CallRecord {
 public:
  /// Name of the component; nullptr: none, or the thread has been claimed.
  const char* component() const noexcept;
  /// For the watchdog, of a thread that is in a call of `component`: from now on that thread does
  /// nothing but sleep, should the call end, so that another one can act in its place. False if it
  /// is no longer in that call.
  bool claim(const char* component) noexcept;

 private:
  friend class InCall;
  std::atomic<const char*> component_{nullptr};
};

/// During its lifetime, calls of plug-ins by this thread are noted in `record`.
class RecordCalls {
 public:
  explicit RecordCalls(CallRecord& record) noexcept;
  ~RecordCalls();
  RecordCalls(const RecordCalls&) = delete;
  RecordCalls& operator=(const RecordCalls&) = delete;
};

/// Notes a call of `component` (its name outlives the call) by this thread. Calls may be nested.
class InCall {
 public:
  explicit InCall(const char* component) noexcept;
  ~InCall();
  InCall(const InCall&) = delete;
  InCall& operator=(const InCall&) = delete;

 private:
  CallRecord* record_;
  const char* component_;
  const char* outer_ = nullptr;
};

/// A plug-in did not return in time.
class Hung : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Runs `call` in a thread of its own and returns when it has ended; exceptions are passed on.
/// Throws Hung after `deadline` seconds, naming `component`: the thread is then abandoned, since
/// none can be ended from outside, and all that `call` refers to must stay alive.
void within_deadline(const std::string& component, std::function<void()> call,
                     double deadline = kSetupDeadline);

/// Number of threads of this process that within_deadline() has abandoned.
int abandoned_calls() noexcept;

/// Calls that this thread makes during its lifetime have the deadline of set-up.
class SetupScope {
 public:
  SetupScope() noexcept;
  ~SetupScope();
  SetupScope(const SetupScope&) = delete;
  SetupScope& operator=(const SetupScope&) = delete;

  static bool is_active() noexcept;
  /// Keeps the first failure of a call that cannot throw, for failure().
  static void note(const std::string& failure);
  /// Of the plug-ins' calls since the scope began; "": none.
  const std::string& failure() const noexcept { return failure_; }

 private:
  SetupScope* outer_;
  std::string failure_;
};

}  // namespace palpate::plugin
