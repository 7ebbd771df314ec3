#include "sim/draw/osmesa.hpp"

#include <dlfcn.h>

#include <cstdlib>
#include <stdexcept>

#include "rt/loop/sanitizer.hpp"

namespace palpate::draw {
namespace {

// The sanitizers' allocator is incompatible with RTLD_DEEPBIND; sanitizer builds do not load libGL.
constexpr int kLoadFlags = RTLD_NOW | RTLD_LOCAL | (loop::kSanitized ? 0 : RTLD_DEEPBIND);

void* load(const std::string& library) {
  void* handle = dlopen(library.c_str(), kLoadFlags);
  if (handle == nullptr) {
    throw std::runtime_error(
        "cannot render pictures: " + std::string(dlerror()) +
        " (Debian package libosmesa6 provides it; the simulator runs without a camera)");
  }
  return handle;
}

OSMESAproc required(OSMESAproc address, const char* name) {
  if (address == nullptr) throw std::runtime_error(std::string("OSMesa has no ") + name);
  return address;
}

}  // namespace

OsMesa::OsMesa(const std::string& library) : handle_(load(library)) {}

OsMesa::Symbol OsMesa::symbol(const char* name) const {
  return {required(reinterpret_cast<OSMESAproc>(dlsym(handle_, name)), name)};
}

OsMesa::Symbol OsMesa::gl(const char* name) const { return {required(get_address(name), name)}; }

const OsMesa& OsMesa::instance() {
  static const OsMesa library = [] {
    setenv("LP_NUM_THREADS", "0", 0);
    return OsMesa("libOSMesa.so.8");
  }();
  return library;
}

void OsMesaContext::Destroy::operator()(osmesa_context* context) const {
  OsMesa::instance().destroy_context(context);
}

OsMesaContext::OsMesaContext(int width, int height)
    : gl_(OsMesa::instance()), width_(width), height_(height) {
  if (width < 1 || height < 1) throw std::invalid_argument("a picture needs a width and a height");
  pixels_.resize(std::size_t(4) * width * height);
  constexpr int kDepthBits = 24;
  context_.reset(gl_.create_context(OSMESA_RGBA, kDepthBits, 0, 0, nullptr));
  if (!context_) throw std::runtime_error("OSMesa cannot make a context");
  make_current();
}

void OsMesaContext::make_current() {
  if (!gl_.make_current(context_.get(), pixels_.data(), GL_UNSIGNED_BYTE, width_, height_)) {
    throw std::runtime_error("OSMesa cannot draw a picture of " + std::to_string(width_) + " x " +
                             std::to_string(height_));
  }
}

}  // namespace palpate::draw
