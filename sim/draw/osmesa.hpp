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
struct OsMesa {
  /// Throws std::runtime_error if the library or one of its functions is missing.
  explicit OsMesa(const std::string& library);

  /// The process-wide instance. Sets LP_NUM_THREADS to 0 unless it is already set: images are then
  /// rendered in the caller's thread, and no thread pool competes with the control loop.
  static const OsMesa& instance();

  decltype(&::OSMesaCreateContextExt) create_context;
  decltype(&::OSMesaMakeCurrent) make_current;
  decltype(&::OSMesaDestroyContext) destroy_context;

  decltype(&::glBlendFunc) blend_func;
  decltype(&::glClear) clear;
  decltype(&::glColorMask) color_mask;
  decltype(&::glColorMaterial) color_material;
  decltype(&::glColorPointer) color_pointer;
  decltype(&::glDepthFunc) depth_func;
  decltype(&::glDepthMask) depth_mask;
  decltype(&::glDisable) disable;
  decltype(&::glDisableClientState) disable_client_state;
  decltype(&::glDrawArrays) draw_arrays;
  decltype(&::glEnable) enable;
  decltype(&::glEnableClientState) enable_client_state;
  decltype(&::glFinish) finish;
  decltype(&::glGetError) get_error;
  decltype(&::glLightfv) light;
  decltype(&::glLightModelfv) light_model;
  decltype(&::glLineWidth) line_width;
  decltype(&::glLoadIdentity) load_identity;
  decltype(&::glLoadMatrixd) load_matrix;
  decltype(&::glMaterialfv) material;
  decltype(&::glMatrixMode) matrix_mode;
  decltype(&::glNormalPointer) normal_pointer;
  decltype(&::glReadPixels) read_pixels;
  decltype(&::glVertexPointer) vertex_pointer;
  decltype(&::glViewport) viewport;
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
