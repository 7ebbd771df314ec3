#include "rt/inference/torch_executor.hpp"

#include <pthread.h>
#include <semaphore.h>
#include <time.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cmath>
#include <stdexcept>
#include <thread>
#include <vector>

#include "rt/loop/fixed_rate_loop.hpp"
#include "rt/loop/handover_ring.hpp"
#include "rt/loop/real_time.hpp"

namespace palpate::inference {
namespace {

constexpr std::int64_t kSecond = 1000000000;
constexpr std::int64_t kWarmUpLimit = 30 * kSecond;

/// Item exchanged with the thread.
struct Parcel {
  std::int64_t number = 0;    // number of the sample
  std::int64_t sequence = 0;  // the state is reset when it changes
  bool good = true;
  std::vector<float> values;
};

/// Counting semaphore between two threads; waiting takes no lock and may be bounded.
class Bell {
 public:
  Bell() {
    if (sem_init(&semaphore_, 0, 0) != 0)
      throw std::runtime_error("the system has no semaphore left");
  }
  ~Bell() { sem_destroy(&semaphore_); }
  Bell(const Bell&) = delete;
  Bell& operator=(const Bell&) = delete;

  void ring() noexcept { sem_post(&semaphore_); }
  void wait() noexcept {
    while (sem_wait(&semaphore_) != 0 && errno == EINTR) {
    }
  }
  /// False on timeout; `deadline`: ns of the monotonic clock.
  bool wait_until(std::int64_t deadline) noexcept {
    const timespec time{static_cast<time_t>(deadline / kSecond),
                        static_cast<long>(deadline % kSecond)};
    for (;;) {
      if (sem_clockwait(&semaphore_, CLOCK_MONOTONIC, &time) == 0) return true;
      if (errno != EINTR) return false;
    }
  }

 private:
  sem_t semaphore_;
};

}  // namespace

struct TorchExecutor::Shared {
  Shared(std::unique_ptr<SequenceModel> m, int depth)
      : model(std::move(m)),
        state(model->sizes().states, 0.f),
        samples(depth, {0, 0, true, std::vector<float>(model->sizes().inputs)}),
        answers(depth, {0, 0, true, std::vector<float>(model->sizes().outputs)}) {}

  void warm_up(int steps) noexcept {
    const std::vector<float> zeros(model->sizes().inputs, 0.f);
    std::vector<float> output(model->sizes().outputs);
    for (int i = 0; i < steps && warm; ++i)
      warm = model->step(zeros.data(), state.data(), output.data());
    std::fill(state.begin(), state.end(), 0.f);
    ready.ring();
  }

  /// Sets the scheduling of this thread, as far as granted.
  void take_schedule(const TorchExecutorOptions& options) {
    if (options.cpu >= 0) refusals.push_back(loop::take_cpu(options.cpu));
    if (options.fifo_priority > 0) refusals.push_back(loop::take_fifo(options.fifo_priority));
  }

  void work(int fifo_priority) noexcept {
    std::int64_t sequence = 0;
    for (;;) {
      sample_bell.wait();
      if (stop.load(std::memory_order_acquire)) break;
      while (Parcel* sample = samples.take()) {
        if (sample->sequence != sequence) {
          sequence = sample->sequence;
          if (demoted.exchange(false)) loop::take_fifo(fifo_priority);
          std::fill(state.begin(), state.end(), 0.f);
        }
        Parcel& answer = answers.back();
        answer.number = sample->number;
        answer.sequence = sample->sequence;
        answer.good = model->step(sample->values.data(), state.data(), answer.values.data());
        answers.publish();
        answer_bell.ring();
      }
    }
    ended.ring();
  }

  std::unique_ptr<SequenceModel> model;
  std::vector<float> state;
  loop::HandoverRing<Parcel> samples;
  loop::HandoverRing<Parcel> answers;
  Bell sample_bell, answer_bell, ready, ended;
  std::vector<std::string> refusals;  // written before `ready` is posted
  std::atomic<bool> demoted{false};
  std::atomic<bool> warm{true};  // false if a step of the warm-up failed
  std::atomic<bool> stop{false};
  std::thread thread;
};

TorchExecutor::TorchExecutor(std::unique_ptr<SequenceModel> model,
                             const TorchExecutorOptions& options)
    : options_(options) {
  if (!(options.wait >= 0 && options.wait <= 10))
    throw std::invalid_argument("wait must be 0 to 10 s");
  if (!(options.patience >= options.wait && options.patience <= 100))
    throw std::invalid_argument("patience must not be below wait and at most 100 s");
  if (options.depth < 1 || options.depth > 1000)
    throw std::invalid_argument("depth must be 1 to 1000");
  if (options.warm_up < 0 || options.warm_up > 1000)
    throw std::invalid_argument("warm_up must be 0 to 1000");
  last_.assign(model->sizes().outputs, 0.f);
  shared_ = std::make_shared<Shared>(std::move(model), options.depth);
  shared_->thread =
      loop::start_helper_thread("palpate-infer", [shared = shared_, options]() mutable {
        shared->take_schedule(options);
        shared->warm_up(options.warm_up);
        shared->work(options.fifo_priority);
        shared.reset();
      });
  const bool came_back = shared_->ready.wait_until(loop::monotonic_ns() + kWarmUpLimit);
  if (came_back && shared_->warm) {
    report_refusals();
    return;
  }
  demote();
  leave();
  throw std::runtime_error(came_back ? "the model fails while it warms up"
                                     : "the model hangs while it warms up");
}

TorchExecutor::~TorchExecutor() { leave(); }

void TorchExecutor::report_refusals() {
  if (options_.remarks == nullptr) return;
  for (const std::string& refusal : shared_->refusals) {
    const std::string line = "inference thread: " + refusal;
    std::vector<std::string>& lines = *options_.remarks;
    const bool known = std::find(lines.begin(), lines.end(), line) != lines.end();
    if (!refusal.empty() && !known) lines.push_back(line);
  }
}

void TorchExecutor::demote() noexcept {
  if (options_.fifo_priority == 0) return;
  const sched_param none{};
  // Without the flag, which take_fifo() set, this would require a privilege.
  pthread_setschedparam(shared_->thread.native_handle(), SCHED_OTHER | SCHED_RESET_ON_FORK, &none);
  shared_->demoted = true;
}

void TorchExecutor::leave() noexcept {
  shared_->stop.store(true, std::memory_order_release);
  shared_->sample_bell.ring();
  if (shared_->ended.wait_until(loop::monotonic_ns() + kSecond)) {
    shared_->thread.join();
  } else {
    demote();
    shared_->thread.detach();
  }
}

ModelSizes TorchExecutor::sizes() const noexcept { return shared_->model->sizes(); }
const char* TorchExecutor::kind() const noexcept { return shared_->model->kind(); }

Answer TorchExecutor::step(const float* input, float* output) noexcept {
  ++counters_.steps;
  if (failed_) return Answer::kFault;
  const std::int64_t start = loop::monotonic_ns();
  if (given_ == answered_) since_ = start;
  Parcel& sample = shared_->samples.back();
  sample.number = ++given_;
  sample.sequence = sequence_;
  std::copy_n(input, sample.values.size(), sample.values.begin());
  if (shared_->samples.publish()) ++counters_.dropped;
  shared_->sample_bell.ring();

  const std::int64_t deadline = start + std::llround(options_.wait * 1e9);
  for (;;) {
    while (Parcel* answer = shared_->answers.take()) {
      answered_ = answer->number;
      since_ = start;  // patience with the next sample without a result starts here
      if (answer->sequence != sequence_) continue;
      if (!answer->good) {
        failed_ = true;
        ++counters_.faults;
        return Answer::kFault;
      }
      std::copy(answer->values.begin(), answer->values.end(), last_.begin());
      has_answer_ = true;
      if (answered_ < given_) continue;
      std::copy(last_.begin(), last_.end(), output);
      return Answer::kFresh;
    }
    if (!shared_->answer_bell.wait_until(deadline)) break;
  }
  ++counters_.late;
  if (loop::monotonic_ns() - since_ >= std::llround(options_.patience * 1e9)) {
    failed_ = true;
    ++counters_.faults;
    demote();
    return Answer::kFault;
  }
  if (!has_answer_) return Answer::kNone;
  std::copy(last_.begin(), last_.end(), output);
  return Answer::kLate;
}

void TorchExecutor::reset() noexcept {
  ++sequence_;
  failed_ = has_answer_ = false;
  since_ = loop::monotonic_ns();
}

}  // namespace palpate::inference
