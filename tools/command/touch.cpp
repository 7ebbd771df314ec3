#include "tools/command/touch.hpp"

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <cstdio>

#include "rt/bus/text.hpp"
#include "rt/client/touch_call.hpp"

namespace palpate::command {
namespace {

volatile std::sig_atomic_t interrupted = 0;

void note_interrupt(int) { interrupted = 1; }

void print_progress(const touch_t& touch) {
  std::fprintf(stderr, "%s: %.1f mm, %.3f N\n", client::name_of_state(touch), 1e3 * touch.travel,
               touch.force);
}

/// Exit code: 0 if touched.
int print_result(const touch_t& touch) {
  const char* reason = bus::get_text(touch.reason);
  if (touch.state != touch_t::TOUCHED) {
    std::printf("%s after %.1f mm, at most %.3f N: %s\n", client::name_of_state(touch),
                1e3 * touch.travel, touch.force, reason);
    return 1;
  }
  const double* p = touch.point;
  const double* c = touch.centre;
  std::printf("touched at %.5f %.5f %.5f m in W", p[0], p[1], p[2]);
  if (touch.point_deviation >= 0)
    std::printf(" +- %.2f mm along the direction\n", 1e3 * touch.point_deviation);
  else
    std::printf(", where the force was reached: %s\n", reason);
  std::printf("centre of the tip %.5f %.5f %.5f m\n", c[0], c[1], c[2]);
  std::printf("largest force %.3f N\n", touch.force);
  if (touch.stiffness >= 0)
    std::printf("stiffness %.1f +- %.1f N/m at an indentation of %.2f mm\n", touch.stiffness,
                touch.stiffness_deviation, 1e3 * touch.indentation);
  return 0;
}

}  // namespace

void Touch::add_to(CLI::App& app) {
  CLI::App* touch = app.add_subcommand(
      "touch", "guarded motion: move until a contact, back off, print the touched point");
  touch->add_option("--direction", direction_, "x y z of the motion, in W; any length")
      ->expected(3)
      ->required();
  touch->add_option("--force", request_.force, "N, against the motion, at which it ends")
      ->check(CLI::PositiveNumber)
      ->required();
  touch->add_option("--speed", request_.speed, "m/s; default: as configured")
      ->check(CLI::PositiveNumber);
  touch
      ->add_option("--distance", request_.distance,
                   "m, after which the motion ends without contact; default: as configured")
      ->check(CLI::PositiveNumber);
  touch
      ->add_option("--retreat", request_.retreat,
                   "m, to back off from the touched point; default: as configured")
      ->check(CLI::PositiveNumber);
}

int Touch::run(bus::MessageBus& control, const bus::Access& access, double timeout) const {
  constexpr std::int64_t kWait = 20'000'000, kProgress = 1'000'000;  // ns, us
  touch_request_t request = request_;
  std::copy_n(direction_.begin(), 3, request.direction);
  client::TouchCall call(control, access);
  control.start_without_thread();
  std::signal(SIGINT, note_interrupt);
  call.begin(request, bus::wall_clock_us());
  const bool is_terminal = isatty(STDERR_FILENO) != 0;
  std::int64_t printed_us = 0;
  std::int32_t printed_state = -1;
  bool cancelled = false;
  while (!call.has_ended()) {
    const std::int64_t now_us = bus::wall_clock_us();
    if (interrupted != 0 && !cancelled) {
      cancelled = true;
      call.cancel(now_us);
    }
    call.service(now_us);
    if (static_cast<double>(call.silence(now_us)) > 1e6 * timeout) {
      std::fprintf(stderr, "no answer in %g s: does palpated run, and on this control URL?\n",
                   timeout);
      return 1;
    }
    const auto& touch = call.latest();
    const bool is_new = touch && touch->state != printed_state;
    if (touch && !call.has_ended() &&
        (is_new || (is_terminal && now_us - printed_us > kProgress))) {
      print_progress(*touch);
      printed_us = now_us;
      printed_state = touch->state;
    }
    control.receive(kWait);
  }
  return print_result(*call.latest());
}

}  // namespace palpate::command
