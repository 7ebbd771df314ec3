#include "sim/draw/osmesa.hpp"

#include <dlfcn.h>

#include <cstdlib>
#include <stdexcept>

#include "rt/loop/sanitizer.hpp"

namespace palpate::draw {
namespace {

// The sanitizers' allocator is incompatible with RTLD_DEEPBIND; sanitizer builds do not load libGL.
constexpr int kLoadFlags = RTLD_NOW | RTLD_LOCAL | (loop::kSanitized ? 0 : RTLD_DEEPBIND);

template <class Function>
void require(Function& function, OSMESAproc address, const char* name) {
  if (address == nullptr) throw std::runtime_error(std::string("OSMesa has no ") + name);
  function = reinterpret_cast<Function>(address);
}

}  // namespace

OsMesa::OsMesa(const std::string& library) {
  void* handle = dlopen(library.c_str(), kLoadFlags);
  if (handle == nullptr) {
    throw std::runtime_error(
        "cannot render pictures: " + std::string(dlerror()) +
        " (Debian package libosmesa6 provides it; the simulator runs without a camera)");
  }
  const auto symbol = [&](const char* name) {
    return reinterpret_cast<OSMESAproc>(dlsym(handle, name));
  };
  require(create_context, symbol("OSMesaCreateContextExt"), "OSMesaCreateContextExt");
  require(make_current, symbol("OSMesaMakeCurrent"), "OSMesaMakeCurrent");
  require(destroy_context, symbol("OSMesaDestroyContext"), "OSMesaDestroyContext");
  decltype(&::OSMesaGetProcAddress) get_address = nullptr;
  require(get_address, symbol("OSMesaGetProcAddress"), "OSMesaGetProcAddress");
  const auto load = [&](auto& function, const char* name) {
    require(function, get_address(name), name);
  };
  load(blend_func, "glBlendFunc");
  load(clear, "glClear");
  load(color_mask, "glColorMask");
  load(color_material, "glColorMaterial");
  load(color_pointer, "glColorPointer");
  load(depth_func, "glDepthFunc");
  load(depth_mask, "glDepthMask");
  load(disable, "glDisable");
  load(disable_client_state, "glDisableClientState");
  load(draw_arrays, "glDrawArrays");
  load(enable, "glEnable");
  load(enable_client_state, "glEnableClientState");
  load(finish, "glFinish");
  load(get_error, "glGetError");
  load(light, "glLightfv");
  load(light_model, "glLightModelfv");
  load(line_width, "glLineWidth");
  load(load_identity, "glLoadIdentity");
  load(load_matrix, "glLoadMatrixd");
  load(material, "glMaterialfv");
  load(matrix_mode, "glMatrixMode");
  load(normal_pointer, "glNormalPointer");
  load(read_pixels, "glReadPixels");
  load(vertex_pointer, "glVertexPointer");
  load(viewport, "glViewport");
}

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
