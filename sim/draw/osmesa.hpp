#pragma once

#include <GL/gl.h>
#include <GL/osmesa.h>

#include <memory>
#include <string>
#include <vector>

namespace palpate::draw {

/// Mesa's off-screen OpenGL, loaded with private symbols: they clash with those of libGL, which
/// other libraries may load into the process. Therefore nothing links to OSMesa and every function
/// is looked up at run time.
class OsMesa {
 public:
  /// Throws std::runtime_error if the library or one of its functions is missing.
  explicit OsMesa(const std::string& library);

  /// The process-wide instance. Sets LP_NUM_THREADS to 0 unless it is already set: images are then
  /// rendered in the caller's thread, and no thread pool competes with the control loop.
  static const OsMesa& instance();

 private:
  /// An address that becomes a function of the type that it initialises.
  struct Symbol {
    OSMESAproc address;
    template <class Function>
    operator Function*() const {  // NOLINT(google-explicit-constructor): see above
      return reinterpret_cast<Function*>(address);
    }
  };
  /// Throws std::runtime_error if the library has no function of this name.
  Symbol symbol(const char* name) const;
  Symbol gl(const char* name) const;

  void* handle_;

 public:
  decltype(&::OSMesaCreateContextExt) create_context = symbol("OSMesaCreateContextExt");
  decltype(&::OSMesaMakeCurrent) make_current = symbol("OSMesaMakeCurrent");
  decltype(&::OSMesaDestroyContext) destroy_context = symbol("OSMesaDestroyContext");
  decltype(&::OSMesaGetProcAddress) get_address = symbol("OSMesaGetProcAddress");

  decltype(&::glBlendFunc) blend_func = gl("glBlendFunc");
  decltype(&::glClear) clear = gl("glClear");
  decltype(&::glColorMask) color_mask = gl("glColorMask");
  decltype(&::glColorMaterial) color_material = gl("glColorMaterial");
  decltype(&::glColorPointer) color_pointer = gl("glColorPointer");
  decltype(&::glDepthFunc) depth_func = gl("glDepthFunc");
  decltype(&::glDepthMask) depth_mask = gl("glDepthMask");
  decltype(&::glDisable) disable = gl("glDisable");
  decltype(&::glDisableClientState) disable_client_state = gl("glDisableClientState");
  decltype(&::glDrawArrays) draw_arrays = gl("glDrawArrays");
  decltype(&::glEnable) enable = gl("glEnable");
  decltype(&::glEnableClientState) enable_client_state = gl("glEnableClientState");
  decltype(&::glFinish) finish = gl("glFinish");
  decltype(&::glGetError) get_error = gl("glGetError");
  decltype(&::glLightfv) light = gl("glLightfv");
  decltype(&::glLightModelfv) light_model = gl("glLightModelfv");
  decltype(&::glLineWidth) line_width = gl("glLineWidth");
  decltype(&::glLoadIdentity) load_identity = gl("glLoadIdentity");
  decltype(&::glLoadMatrixd) load_matrix = gl("glLoadMatrixd");
  decltype(&::glMaterialfv) material = gl("glMaterialfv");
  decltype(&::glMatrixMode) matrix_mode = gl("glMatrixMode");
  decltype(&::glNormalPointer) normal_pointer = gl("glNormalPointer");
  decltype(&::glReadPixels) read_pixels = gl("glReadPixels");
  decltype(&::glVertexPointer) vertex_pointer = gl("glVertexPointer");
  decltype(&::glViewport) viewport = gl("glViewport");
};

/// An OpenGL context with its own image buffer.
class OsMesaContext {
 public:
  OsMesaContext(int width, int height);

  /// Binds the context to the calling thread.
  void make_current();
  const OsMesa& gl() const { return gl_; }
  int width() const { return width_; }
  int height() const { return height_; }

  /// RGBA pixels, rows from the bottom; valid after glFinish.
  const std::vector<unsigned char>& pixels() const { return pixels_; }

 private:
  struct Destroy {
    void operator()(osmesa_context* context) const;
  };

  const OsMesa& gl_;
  int width_;
  int height_;
  std::vector<unsigned char> pixels_;
  std::unique_ptr<osmesa_context, Destroy> context_;
};

}  // namespace palpate::draw
