#include "rt/plugin/supervision.hpp"

#include <chrono>
#include <future>
#include <thread>

#include "rt/loop/real_time.hpp"

namespace palpate::plugin {
namespace {

thread_local CallRecord* thread_record = nullptr;
thread_local SetupScope* thread_scope = nullptr;

constexpr char kClaimed[] = "claimed";

std::atomic<int> abandoned{0};

[[noreturn]] void sleep_for_ever() noexcept {
  for (;;) std::this_thread::sleep_for(std::chrono::hours(1));
}

}  // namespace

RecordCalls::RecordCalls(CallRecord& record) noexcept { thread_record = &record; }
RecordCalls::~RecordCalls() { thread_record = nullptr; }

const char* CallRecord::component() const noexcept {
  const char* name = component_.load(std::memory_order_acquire);
  return name == kClaimed ? nullptr : name;
}

bool CallRecord::claim(const char* component) noexcept {
  return component_.compare_exchange_strong(component, kClaimed, std::memory_order_acq_rel);
}

InCall::InCall(const char* component) noexcept : record_(thread_record), component_(component) {
  if (record_ == nullptr) return;
  outer_ = record_->component_.exchange(component, std::memory_order_acq_rel);
  if (outer_ == kClaimed) sleep_for_ever();
}

InCall::~InCall() {
  if (record_ == nullptr) return;
  const char* own = component_;
  if (!record_->component_.compare_exchange_strong(own, outer_, std::memory_order_acq_rel))
    sleep_for_ever();
}

void within_deadline(const std::string& component, std::function<void()> call, double deadline) {
  std::packaged_task<void()> task(std::move(call));
  std::future<void> done = task.get_future();
  loop::start_helper_thread("palpate-plugin", std::move(task)).detach();
  if (done.wait_for(std::chrono::duration<double>(deadline)) != std::future_status::ready) {
    ++abandoned;
    throw Hung(component + " has not returned within " +
               std::to_string(static_cast<int>(deadline)) + " s");
  }
  done.get();
}

int abandoned_calls() noexcept { return abandoned; }

SetupScope::SetupScope() noexcept : outer_(thread_scope) { thread_scope = this; }
SetupScope::~SetupScope() { thread_scope = outer_; }
bool SetupScope::is_active() noexcept { return thread_scope != nullptr; }
void SetupScope::note(const std::string& failure) {
  if (thread_scope != nullptr && thread_scope->failure_.empty()) thread_scope->failure_ = failure;
}

}  // namespace palpate::plugin
