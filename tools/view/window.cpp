#include "tools/view/window.hpp"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "libcore/base/error.hpp"
#include "libcore/base/file.hpp"
#include "libcore/base/format.hpp"
#include "libcore/base/text.hpp"
#include "libcore/device/hand.hpp"
#include "libcore/grid/vec3.hpp"
#include "libcore/scene/image.hpp"
#include "tools/common/tool.hpp"
#include "tools/view/feed.hpp"
#include "tools/view/force_bar.hpp"
#include "tools/view/hand.hpp"
#include "tools/view/painter.hpp"
#include "tools/view/panel.hpp"

namespace hapgrid {

namespace {

constexpr double kDegreesPerPixel = 0.4;  // of a drag
constexpr double kZoomStep = 1.1;         // of the wheel
constexpr double kMaxZoom = 1000;
constexpr int kNoButton = -1;

[[noreturn]] void no_window(const std::string& why) {
  throw Error("no window: " + why +
              "; --terminal shows frames in a terminal, --png draws one into a file");
}

[[noreturn]] void no_window() {
  const char* why = nullptr;
  ::glfwGetError(&why);
  no_window(why ? why : "unknown failure of GLFW");
}

/// The library while it is in use.
struct Glfw {
  Glfw() {
    if (!::glfwInit()) no_window();
  }
  ~Glfw() { ::glfwTerminate(); }
  Glfw(const Glfw&) = delete;
  Glfw& operator=(const Glfw&) = delete;
};

void write_png(const std::string& name, const Image& image) {
  OutputFile file(name);
  file.write(encode_png(image));
  file.commit();
}

class Window {
 public:
  /// @param hand what the mouse moves; null: the mouse only looks.
  Window(const Scene& scene, const WindowOptions& options, Hand* hand);
  ~Window() { ::glfwDestroyWindow(window_); }
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  /// Until it is closed. @throw Error
  void run(Feed& feed);
  bool has_frame() const { return has_frame_; }
  Image screenshot() const { return painter_->read(); }

 private:
  static Window& of(GLFWwindow* window) {
    return *static_cast<Window*>(::glfwGetWindowUserPointer(window));
  }
  void listen();
  void on_key(int key);
  void on_letter(unsigned letter);
  void on_move(double x, double y);
  void on_wheel(double steps);
  bool moves_hand() const { return hand_ && hand_->begun() && !turning_ && !paused_; }

  void set_title();
  std::vector<std::string> help() const;
  std::string status() const;
  void reset_camera();
  void widen();
  Camera shown_camera() const;
  void update(Feed& feed);
  void draw();
  void save();

  const Scene& scene_;
  RenderOptions render_;
  const WindowOptions& options_;
  Hand* hand_;
  GLFWwindow* window_ = nullptr;
  std::optional<Painter> painter_;

  Frame frame_;
  Traces traces_;
  Feed::State state_;
  bool has_frame_ = false;

  bool free_ = false;      // the view was moved or zoomed: it keeps its size
  Camera camera_;          // in these angles
  double half_width_ = 1;  // of the view: camera_'s or more
  double zoom_ = 1;        // times that size
  bool fitted_ = false;
  int dragging_ = kNoButton;  // the button that is held
  double last_x_ = 0;
  double last_y_ = 0;
  bool elsewhere_ = true;  // the pointer was taken to another place: no motion of the mouse
  bool turning_ = false;   // the mouse turns the view, although it has a hand

  bool paused_ = false;
  bool help_ = false;  // in place of the curves
  bool save_ = false;  // asked for by a key
  bool stale_ = true;  // the window does not show what it should
};

Window::Window(const Scene& scene, const WindowOptions& options, Hand* hand)
    : scene_(scene), render_(options.render), options_(options), hand_(hand) {
  ::glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
  ::glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
  ::glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  ::glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
  ::glfwWindowHint(GLFW_DEPTH_BITS, 0);  // of the window itself
  window_ = ::glfwCreateWindow(options.render.width, options.render.height, "hapgrid view", nullptr,
                               nullptr);
  if (!window_) no_window();
  try {
    ::glfwMakeContextCurrent(window_);
    ::glfwSwapInterval(1);
    painter_.emplace();
    set_title();
    listen();
  } catch (const Error& e) {
    ::glfwDestroyWindow(window_);
    no_window(e.what());
  }
}

// GLFW is C: what can throw is done in run().
void Window::listen() {
  ::glfwSetWindowUserPointer(window_, this);
  ::glfwSetKeyCallback(window_, [](GLFWwindow* w, int key, int, int action, int) {
    if (action == GLFW_PRESS) of(w).on_key(key);
  });
  ::glfwSetMouseButtonCallback(window_, [](GLFWwindow* w, int button, int action, int) {
    of(w).dragging_ = action == GLFW_PRESS ? button : kNoButton;
  });
  // As letters: where '?' is on the keyboard depends on its layout.
  ::glfwSetCharCallback(window_, [](GLFWwindow* w, unsigned letter) { of(w).on_letter(letter); });
  ::glfwSetCursorPosCallback(window_,
                             [](GLFWwindow* w, double x, double y) { of(w).on_move(x, y); });
  ::glfwSetScrollCallback(window_,
                          [](GLFWwindow* w, double, double steps) { of(w).on_wheel(steps); });
  ::glfwSetWindowRefreshCallback(window_, [](GLFWwindow* w) { of(w).stale_ = true; });
  ::glfwSetFramebufferSizeCallback(window_, [](GLFWwindow* w, int, int) { of(w).stale_ = true; });
  if (!hand_) return;
  // The arrow is what tells most about the force now.
  if (render_.arrow == 0) render_.arrow = 2 * newton_length(scene_, render_);
  ::glfwSetCursorEnterCallback(window_, [](GLFWwindow* w, int) { of(w).elsewhere_ = true; });
  ::glfwSetWindowFocusCallback(window_, [](GLFWwindow* w, int) { of(w).elsewhere_ = true; });
  // The pointer is not seen and has no edge to stop at: only the HIP shows where the hand is.
  ::glfwSetInputMode(window_, GLFW_CURSOR, GLFW_CURSOR_DISABLED);
}

void Window::on_key(int key) {
  switch (key) {
    case GLFW_KEY_SPACE:
      paused_ = !paused_;
      break;
    case GLFW_KEY_R:
      if (has_frame_) reset_camera();
      break;
    case GLFW_KEY_B:
      render_.sticks = !render_.sticks;
      break;
    case GLFW_KEY_S:
      save_ = true;
      break;
    case GLFW_KEY_Q:
    case GLFW_KEY_ESCAPE:
      ::glfwSetWindowShouldClose(window_, GLFW_TRUE);
      break;
    default:
      return;
  }
  stale_ = true;
}

void Window::on_letter(unsigned letter) {
  if (letter == 'h' || letter == '?')
    help_ = !help_;
  else if (letter == 't' && hand_)
    turning_ = !turning_;
  stale_ = true;
}

void Window::on_wheel(double steps) {
  if (moves_hand()) {
    hand_->push(camera_, steps);
    return;
  }
  free_ = true;
  zoom_ = std::clamp(zoom_ * std::pow(kZoomStep, steps), 1 / kMaxZoom, kMaxZoom);
  stale_ = true;
}

void Window::on_move(double x, double y) {
  const double right = x - std::exchange(last_x_, x);
  const double down = y - std::exchange(last_y_, y);
  if (std::exchange(elsewhere_, false) && hand_) return;
  if (moves_hand()) {
    hand_->move(shown_camera(), render_, right, down);
    return;
  }
  if (dragging_ == GLFW_MOUSE_BUTTON_RIGHT || dragging_ == GLFW_MOUSE_BUTTON_MIDDLE) {
    free_ = true;
    camera_ = panned(shown_camera(), render_, right, down);
    camera_.half_width = half_width_;
    stale_ = true;
  }
  if (dragging_ != GLFW_MOUSE_BUTTON_LEFT && !(turning_ && dragging_ == kNoButton)) return;
  // The picture follows the hand: to the right means that the viewer goes to the left.
  camera_.azimuth_degrees = std::remainder(camera_.azimuth_degrees - kDegreesPerPixel * right, 360);
  camera_.elevation_degrees =
      std::clamp(camera_.elevation_degrees + kDegreesPerPixel * down, -90.0, 90.0);
  stale_ = true;
}

void Window::set_title() {
  ::glfwSetWindowTitle(window_, format("{} - hapgrid view{}", printable_line(scene_.model),
                                       paused_ ? " (paused)" : "")
                                    .c_str());
}

std::vector<std::string> Window::help() const {
  if (hand_)
    return {"mouse   moves the hand            t          the mouse turns the view, or is the hand",
            "wheel   takes it away, nearer     space      pause, go on",
            "r       the first view again      s          write hapgrid-TICK.png",
            "h, ?    this help, no help        q, Escape  close, which ends the play",
            "b       balls and sticks, spheres",
            "The blue HIP lags behind your hand where the model resists, and snaps when it does.",
            "red arrow and bar: the force      orange lines: the state snapped"};
  std::vector<std::string> lines{
      "drag         turn the picture       r          the first view again",
      "right drag   move the picture       space      pause, go on",
      "wheel        zoom                   s          write hapgrid-TICK.png",
      "h, ?         this help, no help     q, Escape  close",
      "                                    b          balls and sticks, spheres",
      "blue: the HIP   red arrow: the force as it is sent   orange lines: the state snapped"};
  if (!scene_.keys.empty())
    lines.push_back("in the terminal of play:  " + printable_line(scene_.keys));
  return lines;
}

void Window::reset_camera() {
  camera_ =
      fit_model(scene_, frame_, render_, options_.azimuth_degrees, options_.elevation_degrees);
  zoom_ = 1;
  fitted_ = true;
  free_ = false;
}

/// Makes room for the newest frame: for the HIP and the model as long as they need it; for an arrow
/// until the view is fitted anew, so that the picture does not breathe with the force.
void Window::widen() {
  if (free_) return;
  camera_.half_width =
      std::max(camera_.half_width, needed_for_arrow(scene_, frame_, camera_, render_));
  half_width_ = std::max(camera_.half_width, needed_half_width(scene_, frame_, camera_, render_));
}

Camera Window::shown_camera() const {
  Camera camera = camera_;
  camera.half_width = half_width_ / zoom_;
  return camera;
}

/// The line above the curves.
std::string Window::status() const {
  std::string text =
      has_frame_ ? status_text(scene_, frame_, state_.dropped) : "waiting for frames";
  if (state_.ended) text += "   ended";
  if (paused_) text += "   paused";
  if (hand_) text += turning_ ? "   t: the hand again" : "   mouse: hand   t: turn";
  return text + "   h: help";
}

void Window::draw() {
  int width = 0, height = 0;
  ::glfwGetFramebufferSize(window_, &width, &height);
  if (width < 1 || height < 1) return;  // an icon
  float scale = 1;
  ::glfwGetWindowContentScale(window_, &scale, nullptr);
  const int letters = std::max(1, static_cast<int>(std::lround(scale)));
  // A low window has the picture alone.
  int panel_height = letters * kPanelHeight;
  const bool with_panel = height >= 2 * panel_height || (help_ && height > panel_height);
  if (!with_panel) panel_height = 0;
  painter_->resize(width, height - panel_height, panel_height);
  render_.width = width;
  render_.height = height - panel_height;
  render_.letter_scale = letters;
  render_.supersampling = painter_->supersampling();
  Drawing drawing;
  if (has_frame_) {
    if (!fitted_) reset_camera();
    widen();
    drawing = hapgrid::draw(scene_, frame_, shown_camera(), render_);
    const Vec3& f = frame_.force;
    if (hand_)
      add_force_bar(drawing, std::hypot(f[0], f[1], f[2]),
                    std::max(kHandForce, force_extent(traces_).high), render_);
  }
  painter_->paint(drawing, !with_panel ? Image{}
                           : help_     ? draw_text(width, letters, help())
                                       : draw_panel(width, letters, scene_, traces_, status()));
  painter_->show();
  ::glfwSwapBuffers(window_);
}

void Window::save() {
  // With the tick's number: each frame has a file of its own.
  const std::string name = format("hapgrid-{}.png", frame_.tick);
  try {
    write_png(name, painter_->read());
    std::fprintf(stderr, "view: wrote %s\n", name.c_str());
  } catch (const std::exception& e) {
    say("view", e.what());  // no reason to close the window
  }
}

void Window::update(Feed& feed) {
  const bool had_ended = state_.ended;
  state_ = feed.update(frame_, traces_);
  has_frame_ = has_frame_ || state_.fresh;
  stale_ = stale_ || state_.fresh || state_.ended != had_ended;
  if (hand_ && has_frame_ && !hand_->begun() && finite(frame_.position))
    hand_->begin(frame_.position);
}

void Window::run(Feed& feed) {
  bool was_paused = false;
  while (!::glfwWindowShouldClose(window_)) {
    if (std::exchange(was_paused, paused_) != paused_) {
      feed.pause(paused_);
      set_title();
    }
    if (!paused_) update(feed);
    if (std::exchange(stale_, false)) draw();
    if (has_frame_ && std::exchange(save_, false)) save();
    if (state_.ended && options_.close) return;
    if (state_.more && !paused_)
      ::glfwPollEvents();
    else
      ::glfwWaitEvents();
    if (hand_) hand_->send();
  }
}

}  // namespace

void run_window(const std::string& frames, const WindowOptions& options) {
  std::optional<OutputFile> screenshot;
  if (!options.screenshot.empty()) screenshot.emplace(options.screenshot);
  std::optional<Glfw> glfw;
  if (options.hand.empty()) glfw.emplace();
  // It is gone before the library is: its thread wakes up glfwWaitEvents().
  Feed feed(frames, [] { ::glfwPostEmptyEvent(); });
  // Play has opened the pipe before the scene came. Taken before there is a window, it tells play
  // that there will be none when that fails.
  std::optional<Hand> hand;
  if (!options.hand.empty()) hand.emplace(options.hand, feed.scene().box);
  if (!glfw) glfw.emplace();
  Window window(feed.scene(), options, hand ? &*hand : nullptr);
  feed.start();
  window.run(feed);
  if (screenshot) {
    if (!window.has_frame()) {
      feed.check();
      throw Error(format("{}: no frame in it, nothing to draw", feed.name()));
    }
    screenshot->write(encode_png(window.screenshot()));
    screenshot->commit();
  }
  feed.check();
}

}  // namespace hapgrid
