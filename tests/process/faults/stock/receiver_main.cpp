// A typical program: receives a typed message and all others through liblcm.

#include <cstdio>
#include <lcm/lcm-cpp.hpp>
#include <palpate/shape_t.hpp>

namespace {

struct Handler {
  void on_shape(const lcm::ReceiveBuffer*, const std::string&, const palpate::shape_t*) {}
  void on_any(const lcm::ReceiveBuffer*, const std::string&) {}
};

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: %s LCM_URL\n", argv[0]);
    return 64;
  }
  lcm::LCM lcm(argv[1]);
  if (!lcm.good()) return 1;
  Handler handler;
  lcm.subscribe("SHAPE", &Handler::on_shape, &handler);
  lcm.subscribe(".*", &Handler::on_any, &handler);
  std::printf("listens\n");
  std::fflush(stdout);
  while (lcm.handle() == 0) {
  }
  return 1;
}
