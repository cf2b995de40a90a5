// Draws a window's picture with OpenGL 3.3, from the same Drawing as render().
//
// A sphere is a square whose fragment shader finds the sphere's surface, its normal and its depth.
// So a sphere is round at every size, and spheres intersect where they should. The picture is
// painted into memory with several rays a pixel and then made smaller, because multisampling does
// not smooth the edges that a fragment shader makes by discarding. The window shows a copy of the
// picture, so a screenshot is whole even behind other windows.
#pragma once

#include <cstddef>
#include <vector>

#include "libcore/scene/drawing.hpp"
#include "libcore/scene/image.hpp"
#include "tools/view/gl.hpp"

namespace hapgrid {

/// Its objects belong to the OpenGL context, which must be current in each call.
class Painter {
 public:
  /// @throw Error when the context lacks something that is needed.
  Painter();

  /// Sets the size of the picture and of the panel below it in pixels, at least 1 each.
  /// @throw Error when they are too large for the context.
  void resize(int width, int picture_height, int panel_height);
  /// Rays a pixel and axis, for draw(); resize() can change it.
  int supersampling() const { return supersampling_; }

  void paint(const Drawing& drawing, const Image& panel);
  /// Copies what was painted to the window, which has the same size.
  void show() const;
  /// The picture that was painted.
  Image read() const;

 private:
  struct Shape {  // a kind of thing that is drawn in many instances
    GLuint program = 0;
    GLuint vertices = 0;
    GLuint instances = 0;
  };
  struct Target {
    GLuint framebuffer = 0;
    GLuint colour = 0;  // a renderbuffer; of the panel a texture
    GLuint depth = 0;
  };

  Shape make_shape(const char* vertex, const char* fragment, std::size_t vectors) const;
  Target make_target(bool with_depth) const;
  void set_size(const Target& target, int width, int height) const;
  void draw_instances(const Shape& shape, const std::vector<float>& data,
                      std::size_t floats_each) const;

  Gl gl_;
  Shape balls_;
  Shape lines_;
  Target rays_;   // the picture, supersampling_ times larger
  Target shown_;  // the picture and the panel
  Target panel_;
  int largest_side_ = 0;
  int supersampling_ = 1;
  int width_ = 0;
  int picture_height_ = 0;
  int panel_height_ = 0;
};

}  // namespace hapgrid
