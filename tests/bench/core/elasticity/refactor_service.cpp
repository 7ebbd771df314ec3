#include "tests/bench/core/elasticity/refactor_service.hpp"

#include <stdexcept>

namespace palpate::bench {

RefactorPolicy RefactorPolicy::parse(const std::string& text) {
  if (text == "background") return {kBackground, 0};
  if (text == "never") return {kNever, 0};
  const std::string every = "every-";
  if (text.rfind(every, 0) == 0) {
    const std::string digits = text.substr(every.size());
    if (!digits.empty() && digits.size() < 7 &&
        digits.find_first_not_of("0123456789") == std::string::npos && std::stoi(digits) >= 1) {
      return {kDelayed, std::stoi(digits)};
    }
  }
  throw std::invalid_argument("refactor \"" + text + "\": allowed: background, every-N, never");
}

std::string RefactorPolicy::text() const {
  if (kind == kBackground) return "background";
  return kind == kNever ? "never" : "every-" + std::to_string(delay);
}

void RefactorService::Job::run() noexcept {
  const double wall_begin = wall_time(), cpu_begin = thread_time();
  work->run();
  wall = wall_time() - wall_begin;
  cpu = thread_time() - cpu_begin;
}

RefactorService::RefactorService(const RefactorPolicy& policy) : policy_(policy) {
  if (policy_.kind == RefactorPolicy::kBackground) worker_.emplace();
}

void RefactorService::install(elasticity::DeformationModel& model) {
  model.install(*job_.work);
  job_.work = nullptr;
  snapshot_in_use_ = job_.snapshot;
  ++installed_;
  wall_.add(job_.wall);
  cpu_.add(job_.cpu);
}

void RefactorService::collect(elasticity::DeformationModel& model, long step) {
  if (worker_) {
    if (worker_->finished() != nullptr) install(model);
  } else if (job_.work != nullptr && step >= job_.snapshot + policy_.delay) {
    install(model);
  }
}

void RefactorService::request(elasticity::DeformationModel& model, long step) {
  if (policy_.kind == RefactorPolicy::kNever || job_.work != nullptr) return;
  job_.work = model.wanted_refactorisation();
  if (job_.work == nullptr) return;
  job_.snapshot = step;
  is_run_ = false;
  if (worker_) {
    worker_->submit([](void* job) noexcept { static_cast<Job*>(job)->run(); }, &job_);
  }
}

void RefactorService::run_here() {
  if (worker_ || job_.work == nullptr || is_run_) return;
  job_.run();
  is_run_ = true;
}

}  // namespace palpate::bench
