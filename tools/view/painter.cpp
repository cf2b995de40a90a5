#include "tools/view/painter.hpp"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <tuple>
#include <utility>

#include "libcore/base/error.hpp"
#include "libcore/base/format.hpp"
#include "tools/view/shaders.hpp"

namespace hapgrid {

namespace {

constexpr int kSupersampling = 2;

/// Floats have room for what is near the picture; what is absurdly far away is left out.
bool drawable(const Vec3& place, double size) {
  constexpr double kFar = 1e7;
  return std::abs(place[0]) < kFar && std::abs(place[1]) < kFar && std::abs(place[2]) < kFar &&
         size < kFar;
}

void append(std::vector<float>& data, const Vec3& place, double fourth) {
  for (const double x : place) data.push_back(static_cast<float>(x));
  data.push_back(static_cast<float>(fourth));
}

void append(std::vector<float>& data, const Colour& colour, float opacity) {
  data.insert(data.end(), colour.begin(), colour.end());
  data.push_back(opacity);
}

/// The drawing as the shaders want it.
struct Instances {
  std::vector<float> lines;        // start, end, colour
  std::vector<float> balls;        // place, colour
  std::vector<float> translucent;  // as balls
  std::vector<float> hidden;       // the same, as they are seen behind the rest
  std::vector<float> overlay;      // as lines
  float nearest = -std::numeric_limits<float>::max();
  float farthest = std::numeric_limits<float>::max();

  explicit Instances(const Drawing& drawing) {
    add(drawing.lines, lines);
    add(drawing.balls, 1, balls);
    add(drawing.translucent, kHipOpacity, translucent);
    add(drawing.translucent, kHiddenOpacity, hidden);
    add(drawing.overlay, overlay);
    // Nothing may be clipped for the sake of a rounded depth.
    const float margin = 1 + 1e-3F * (nearest - farthest);
    nearest += margin;
    farthest -= margin;
  }

 private:
  void add(const std::vector<Line>& from, std::vector<float>& data) {
    for (const Line& line : from) {
      if (!drawable(line.from, line.half_width) || !drawable(line.to, 0)) continue;
      append(data, line.from, line.half_width);
      append(data, line.to, 0);
      append(data, line.colour, 1);
      see(line.from[2], 0);
      see(line.to[2], 0);
    }
  }
  void add(const std::vector<Ball>& from, float opacity, std::vector<float>& data) {
    for (const Ball& ball : from) {
      if (!drawable(ball.centre, ball.radius)) continue;
      append(data, ball.centre, ball.radius);
      append(data, ball.colour, opacity);
      see(ball.centre[2], ball.radius);
    }
  }
  void see(double z, double radius) {
    nearest = std::max(nearest, static_cast<float>(z + radius));
    farthest = std::min(farthest, static_cast<float>(z - radius));
  }
};

std::string log_of(GLuint what, PFNGLGETSHADERINFOLOGPROC get) {
  std::array<char, 500> log{};
  get(what, log.size(), nullptr, log.data());
  return log.data();
}

constexpr GLsizei kFour = 4 * sizeof(float);

}  // namespace

Gl load_gl() {
  Gl gl{};
  const auto load = [](const char* name) {
    const auto function = ::glfwGetProcAddress(name);
    if (!function) throw Error(std::string("OpenGL 3.3 lacks ") + name);
    return function;
  };
#define HAPGRID_GL_LOAD(name, type) gl.name = reinterpret_cast<type>(load("gl" #name));
  HAPGRID_GL_FUNCTIONS(HAPGRID_GL_LOAD)
#undef HAPGRID_GL_LOAD
  return gl;
}

Painter::Painter() : gl_(load_gl()) {
  balls_ = make_shape(kBallVertex, kBallFragment, 2);
  lines_ = make_shape(kLineVertex, kLineFragment, 3);
  rays_ = make_target(/*with_depth=*/true);
  shown_ = make_target(/*with_depth=*/false);
  gl_.GenFramebuffers(1, &panel_.framebuffer);
  gl_.GenTextures(1, &panel_.colour);
  GLint renderbuffer = 0, texture = 0;
  gl_.GetIntegerv(GL_MAX_RENDERBUFFER_SIZE, &renderbuffer);
  gl_.GetIntegerv(GL_MAX_TEXTURE_SIZE, &texture);
  largest_side_ = std::min(renderbuffer, texture);
  gl_.PixelStorei(GL_PACK_ALIGNMENT, 1);
  gl_.PixelStorei(GL_UNPACK_ALIGNMENT, 1);
  gl_.BlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  gl_.DepthFunc(GL_LESS);
}

/// Instances of `vectors` vectors of four floats each.
Painter::Shape Painter::make_shape(const char* vertex, const char* fragment,
                                   std::size_t vectors) const {
  Shape shape;
  shape.program = gl_.CreateProgram();
  GLint done = 0;
  for (const auto& [kind, source] :
       {std::pair{GL_VERTEX_SHADER, vertex}, std::pair{GL_FRAGMENT_SHADER, fragment}}) {
    const GLuint shader = gl_.CreateShader(static_cast<GLenum>(kind));
    gl_.ShaderSource(shader, 1, &source, nullptr);
    gl_.CompileShader(shader);
    gl_.GetShaderiv(shader, GL_COMPILE_STATUS, &done);
    if (!done) throw Error(format("OpenGL's shader: {}", log_of(shader, gl_.GetShaderInfoLog)));
    gl_.AttachShader(shape.program, shader);
    gl_.DeleteShader(shader);
  }
  gl_.LinkProgram(shape.program);
  gl_.GetProgramiv(shape.program, GL_LINK_STATUS, &done);
  if (!done)
    throw Error(format("OpenGL's shaders: {}", log_of(shape.program, gl_.GetProgramInfoLog)));

  gl_.GenVertexArrays(1, &shape.vertices);
  gl_.GenBuffers(1, &shape.instances);
  gl_.BindVertexArray(shape.vertices);
  gl_.BindBuffer(GL_ARRAY_BUFFER, shape.instances);
  for (std::size_t i = 0; i < vectors; ++i) {
    const auto location = static_cast<GLuint>(i);
    gl_.EnableVertexAttribArray(location);
    gl_.VertexAttribPointer(location, 4, GL_FLOAT, GL_FALSE, static_cast<GLsizei>(vectors) * kFour,
                            reinterpret_cast<const void*>(i * kFour));
    gl_.VertexAttribDivisor(location, 1);
  }
  return shape;
}

Painter::Target Painter::make_target(bool with_depth) const {
  Target target;
  gl_.GenFramebuffers(1, &target.framebuffer);
  gl_.GenRenderbuffers(1, &target.colour);
  if (with_depth) gl_.GenRenderbuffers(1, &target.depth);
  return target;
}

void Painter::set_size(const Target& target, int width, int height) const {
  gl_.BindFramebuffer(GL_FRAMEBUFFER, target.framebuffer);
  for (const auto& [buffer, format, place] :
       {std::tuple{target.colour, GL_RGBA8, GL_COLOR_ATTACHMENT0},
        std::tuple{target.depth, GL_DEPTH_COMPONENT32F, GL_DEPTH_ATTACHMENT}}) {
    if (buffer == 0) continue;
    gl_.BindRenderbuffer(GL_RENDERBUFFER, buffer);
    gl_.RenderbufferStorage(GL_RENDERBUFFER, static_cast<GLenum>(format), width, height);
    gl_.FramebufferRenderbuffer(GL_FRAMEBUFFER, static_cast<GLenum>(place), GL_RENDERBUFFER,
                                buffer);
  }
}

void Painter::resize(int width, int picture_height, int panel_height) {
  if (width == width_ && picture_height == picture_height_ && panel_height == panel_height_) return;
  const int side = std::max(width, picture_height + panel_height);
  if (side > largest_side_)
    throw Error(format("a window of {}x{} pixels; OpenGL's limit is {}", width,
                       picture_height + panel_height, largest_side_));
  supersampling_ = kSupersampling * side <= largest_side_ ? kSupersampling : 1;
  width_ = width;
  picture_height_ = picture_height;
  panel_height_ = panel_height;
  set_size(rays_, supersampling_ * width, supersampling_ * picture_height);
  bool complete = gl_.CheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
  set_size(shown_, width, picture_height + panel_height);
  complete &= gl_.CheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
  if (!complete)
    throw Error(format("OpenGL cannot draw into a picture of {}x{} pixels", width,
                       picture_height + panel_height));
}

void Painter::draw_instances(const Shape& shape, const std::vector<float>& data,
                             std::size_t floats_each) const {
  if (data.empty()) return;
  gl_.UseProgram(shape.program);
  gl_.BindVertexArray(shape.vertices);
  gl_.BindBuffer(GL_ARRAY_BUFFER, shape.instances);
  gl_.BufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(data.size() * sizeof(float)), data.data(),
                 GL_STREAM_DRAW);
  gl_.DrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, static_cast<GLsizei>(data.size() / floats_each));
}

void Painter::paint(const Drawing& drawing, const Image& panel) {
  const Instances instances(drawing);
  const int width = supersampling_ * width_;
  const int height = supersampling_ * picture_height_;
  gl_.BindFramebuffer(GL_FRAMEBUFFER, rays_.framebuffer);
  gl_.Viewport(0, 0, width, height);
  gl_.Enable(GL_DEPTH_TEST);
  gl_.ClearColor(kBackground[0], kBackground[1], kBackground[2], 1);
  gl_.Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  for (const Shape* shape : {&lines_, &balls_}) {
    gl_.UseProgram(shape->program);
    gl_.Uniform2f(gl_.GetUniformLocation(shape->program, "size"), static_cast<float>(width),
                  static_cast<float>(height));
    gl_.Uniform2f(gl_.GetUniformLocation(shape->program, "depths"), instances.farthest,
                  instances.nearest);
  }
  draw_instances(lines_, instances.lines, 12);
  draw_instances(balls_, instances.balls, 8);
  gl_.Enable(GL_BLEND);
  // Where the rest is nearer. It takes over the depth, so that no place is drawn twice.
  gl_.DepthFunc(GL_GREATER);
  draw_instances(balls_, instances.hidden, 8);
  gl_.DepthFunc(GL_LESS);
  draw_instances(balls_, instances.translucent, 8);
  gl_.Disable(GL_BLEND);
  gl_.Disable(GL_DEPTH_TEST);
  draw_instances(lines_, instances.overlay, 12);

  // OpenGL counts rows from the bottom. Of twice the size, GL_LINEAR is the mean of four rays.
  gl_.BindFramebuffer(GL_READ_FRAMEBUFFER, rays_.framebuffer);
  gl_.BindFramebuffer(GL_DRAW_FRAMEBUFFER, shown_.framebuffer);
  gl_.BlitFramebuffer(0, 0, width, height, 0, panel_height_, width_,
                      panel_height_ + picture_height_, GL_COLOR_BUFFER_BIT, GL_LINEAR);
  if (panel_height_ == 0) return;
  gl_.BindTexture(GL_TEXTURE_2D, panel_.colour);
  gl_.TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, panel.width, panel.height, 0, GL_RGB, GL_UNSIGNED_BYTE,
                 panel.pixels.data());
  gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, 0);
  gl_.BindFramebuffer(GL_READ_FRAMEBUFFER, panel_.framebuffer);
  gl_.FramebufferTexture2D(GL_READ_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, panel_.colour,
                           0);
  gl_.BlitFramebuffer(0, 0, panel.width, panel.height, 0, panel_height_, width_, 0,
                      GL_COLOR_BUFFER_BIT, GL_NEAREST);
}

void Painter::show() const {
  const int height = picture_height_ + panel_height_;
  gl_.BindFramebuffer(GL_READ_FRAMEBUFFER, shown_.framebuffer);
  gl_.BindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
  gl_.BlitFramebuffer(0, 0, width_, height, 0, 0, width_, height, GL_COLOR_BUFFER_BIT, GL_NEAREST);
}

Image Painter::read() const {
  Image image{width_, picture_height_ + panel_height_, {}};
  image.pixels.resize(static_cast<std::size_t>(image.width) *
                      static_cast<std::size_t>(image.height));
  gl_.BindFramebuffer(GL_READ_FRAMEBUFFER, shown_.framebuffer);
  gl_.ReadPixels(0, 0, image.width, image.height, GL_RGB, GL_UNSIGNED_BYTE, image.pixels.data());
  const auto row = [&](int y) { return image.pixels.begin() + std::ptrdiff_t{y} * image.width; };
  for (int y = 0; y < image.height / 2; ++y)
    std::swap_ranges(row(y), row(y + 1), row(image.height - 1 - y));
  return image;
}

}  // namespace hapgrid
