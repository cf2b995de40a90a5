// view: shows the frames of play: as a report, a trajectory, a picture, a page, or live in a
// browser or a terminal (view/).

#include <arpa/inet.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <system_error>
#include <utility>

#include "libcore/base/error.hpp"
#include "libcore/base/file.hpp"
#include "libcore/base/format.hpp"
#include "libcore/base/text.hpp"
#include "libcore/scene/render.hpp"
#include "libcore/scene/stream.hpp"
#include "tools/common/inputs.hpp"
#include "tools/common/tool.hpp"
#include "tools/view/grid_page.hpp"
#include "tools/view/live.hpp"
#include "tools/view/page/page.hpp"
#include "tools/view/trajectory.hpp"

using namespace hapgrid;

namespace {

constexpr int kMaxPixels = 8192;  // of a side: 8192 x 8192 pixels are 200 MB

struct Options {
  std::string frames = "-";
  std::string xyz;
  std::string hip_label;
  std::string png;
  std::string html;
  double at_s = std::numeric_limits<double>::infinity();  // beyond: the last frame
  std::string size = "800x600";
  std::string from = "30,20";
  bool has_from = false;  // asked for
  std::string style = "spheres";
  // Empty: not asked for.
  std::string web, imd;  // where to listen
  std::string terminal;  // how to draw there

  bool wants_report() const { return xyz.empty() && png.empty() && html.empty(); }
};

/// WxH in pixels; nothing when it is not that.
std::optional<std::pair<int, int>> parse_size(const std::string& text) {
  std::pair<int, int> size;
  auto& [width, height] = size;
  if (!parse_two(text, 'x', width, height) || std::min(width, height) < 1 ||
      std::max(width, height) > kMaxPixels)
    return std::nullopt;
  return size;
}

/// AZIMUTH,ELEVATION in degrees; nothing when it is not that.
std::optional<std::pair<double, double>> parse_from(const std::string& text) {
  std::pair<double, double> from;
  auto& [azimuth, elevation] = from;
  if (!parse_two(text, ',', azimuth, elevation) || !(std::abs(azimuth) <= 360) ||
      !(std::abs(elevation) <= 90))
    return std::nullopt;
  return from;
}

/// [ADDRESS:]PORT; nothing when it is not that.
std::optional<Place> parse_place(const std::string& text) {
  Place place{.address = "127.0.0.1"};
  const std::size_t colon = text.find(':');
  if (colon != text.npos) place.address = text.substr(0, colon);
  in_addr address{};
  if (!parse_number(text.substr(colon + 1), place.port) || place.port < 0 || place.port > 65535 ||
      ::inet_pton(AF_INET, place.address.c_str(), &address) != 1)
    return std::nullopt;
  return place;
}

/// The frame that --png shows: the one nearest to a time, the earlier of two.
struct Chosen {
  double at_s;
  std::optional<Frame> frame = std::nullopt;
  bool snapped = false;                               // the state, after the frame before
  std::optional<std::uint64_t> jumps = std::nullopt;  // of the newest frame

  void offer(const Frame& next) {
    const bool snaps = jumps && *jumps != next.jumps;
    jumps = next.jumps;
    // Frames come in the order of ticks; at infinity each one is nearer than those before.
    if (frame && std::isfinite(at_s) &&
        std::abs(next.time_s - at_s) >= std::abs(frame->time_s - at_s))
      return;
    frame = next;
    snapped = snaps;
  }
};

/// @throw Error with the name and the tick, when a coordinate is not finite.
std::string xyz_frame(const SceneReader& reader, const Frame& frame, const std::string& hip_label) {
  try {
    std::string text;
    append_xyz(text, reader.scene(), frame, hip_label);
    return text;
  } catch (const Error& e) {
    throw Error(format("{}: tick {}: {}", reader.name(), frame.tick, e.what()));
  }
}

/// What view says of frames where nothing else is asked for.
struct Report {
  std::uint64_t frames = 0;
  double first_s = 0, last_s = 0;
  double largest_force = 0, largest_force_s = 0;

  void add(const Frame& frame) {
    last_s = frame.time_s;
    if (frames++ == 0) first_s = last_s;
    const double force = length_of(frame.force);
    if (!(force > largest_force)) return;
    largest_force = force;
    largest_force_s = last_s;
  }
  std::string text(const Scene& scene) const {
    return format(
        "model    {}\nspheres  {}\nframes   {}, from {} s to {} s\nforce    at most {} N, at {} "
        "s\n",
        printable_line(scene.model), scene.spheres.size(), frames, rounded(first_s),
        rounded(last_s), rounded(largest_force), rounded(largest_force_s));
  }
};

RenderOptions render_options(const Options& options) {
  RenderOptions how;
  std::tie(how.width, how.height) = *parse_size(options.size);
  std::tie(how.azimuth_degrees, how.elevation_degrees) = *parse_from(options.from);
  how.sticks = options.style == "sticks";
  return how;
}

/// The frames are no frames but a grid.
int run_grid(const Options& options, RenderOptions how) {
  if (!options.has_from) {
    how.azimuth_degrees = 0;  // from the front: the hand moves in the plane of the picture
    how.elevation_degrees = 10;
  }
  if (options.html.empty() || !options.xyz.empty() || !options.png.empty())
    throw UsageError(
        options.frames +
        ": is a grid, of which --html alone makes something, a page that plays it; play "
        "GRID --frames - makes frames");
  OutputFile html(options.html, /*binary=*/false);
  html.write(grid_page(options.frames, how));
  html.commit();
  return kExitDone;
}

/// Where the HIP and its force are in a recorded file, which the camera shows.
void fit_to_file(const std::string& name, RenderOptions& how) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(name, error)) return;
  try {
    SceneReader reader(name);
    for (Frame frame; reader.next(frame);) add_to_way(reader.scene(), frame, how);
  } catch (const Error&) {  // what is wrong is said when it is to be shown
  }
}

int run(const Options& options) {
  if (options.frames.ends_with(".session"))
    throw Error(options.frames +
                ": a session has no shape to show; play GRID --device replay:FILE --frames - "
                "makes frames of it");
  keep_inputs({{"--xyz", options.xyz}, {"--png", options.png}, {"--html", options.html}},
              {{options.frames, "frames"}});
  announce_terminal(options.frames);
  RenderOptions how = render_options(options);
  if (is_grid(options.frames)) return run_grid(options, how);
  if (!options.web.empty() || !options.terminal.empty()) fit_to_file(options.frames, how);
  if (const auto place = parse_place(options.web)) {
    run_web(options.frames, *place, how);
    return kExitDone;
  }
  if (const auto place = parse_place(options.imd)) {
    run_imd(options.frames, *place);
    return kExitDone;
  }
  if (!options.terminal.empty()) {
    run_terminal(options.frames, how, options.terminal);
    return kExitDone;
  }

  std::optional<OutputFile> xyz;
  if (!options.xyz.empty()) xyz.emplace(options.xyz, /*binary=*/false);
  std::optional<OutputFile> png;
  if (!options.png.empty()) png.emplace(options.png);
  std::optional<OutputFile> html;
  if (!options.html.empty()) html.emplace(options.html, /*binary=*/false);

  SceneReader reader(options.frames);
  const Scene& scene = reader.scene();
  Report report;
  Chosen chosen{options.at_s};
  std::optional<Frame> first;
  std::string shown;
  for (Frame frame; reader.next(frame);) {
    report.add(frame);
    if (png) chosen.offer(frame);
    if (html) shown += (first ? ",\n" : "") + script_of(page_frame(scene, frame));
    if (!first) first = frame;
    add_to_way(scene, frame, how);
    if (xyz) xyz->write(xyz_frame(reader, frame, options.hip_label));
  }
  if ((png || html) && !first)
    throw Error(format("{}: no frame in it, nothing to draw", reader.name()));
  if (png) {
    how.flash = chosen.snapped;
    // Fitted to the first frame, as the page's: all pictures of a play have one camera.
    png->write(encode_png(render(scene, *chosen.frame, fit_camera(scene, *first, how), how)));
    png->commit();
  }
  if (html) {
    html->write(page_text(script_of(page_scene(scene, *first, how)), shown));
    html->commit();
  }
  if (xyz) xyz->commit();
  if (options.wants_report()) write_text("-", printable_text(report.text(scene)));
  return kExitDone;
}

void add_file_options(CommandLine& app, Options& options) {
  app.group("Files, instead of the report");
  const Option xyz =
      app.add("--xyz", options.xyz,
              "Trajectory to write in the XYZ format, with the spheres of all frames.")
          .type("FILE")
          .writes();
  app.add("--hip-label", options.hip_label,
          "Symbol of an atom that shows the HIP in --xyz (default: no atom).")
      .type("SYMBOL")
      .check(is_symbol, "a letter, then letters or digits")
      .needs(xyz);
  const Option png =
      app.add("--png", options.png, "Picture to write of one frame.").type("FILE").writes();
  app.add("--at", options.at_s, "Time of the frame of --png (default: the last frame).")
      .type("SECONDS")
      .within(0, 1e12, "a time from 0 to 1e12 s")
      .needs(png);
  app.add("--html", options.html,
          "Web page to write in one file: it plays all frames in a browser or, where FRAMES is a "
          "grid, lets a mouse or a finger feel that grid.")
      .type("FILE")
      .writes();
}

void add_live_options(CommandLine& app, Options& options) {
  app.group("Live");
  const auto is_place = [](const std::string& text) { return parse_place(text).has_value(); };
  const char* const place = "an IPv4 address and a port, like 8888 or 127.0.0.1:8888";
  // Flags, so that a file's name behind them is not taken for their value.
  app.add_flag("--web{0}", options.web,
               "Serve a page that shows the frames in browsers, and write its address; a recorded "
               "file plays at the speed at which it was recorded. With another address than "
               "127.0.0.1, the default, other machines reach it; the default port is one that is "
               "free.")
      .type("[ADDRESS:]PORT")
      .check(is_place, place)
      .goes_with({"frames", "--style", "--from"});
  app.add_flag("--terminal{auto}", options.terminal,
               "Show the frames in the terminal. Default: auto, the best that the terminal can do.")
      .one_of({"auto", "symbols", "sixel"})
      .goes_with({"frames", "--style", "--from"});
  app.add_flag("--imd{8888}", options.imd,
               "Serve VMD over TCP, by default on port 8888 of this machine alone. There is no "
               "password: whoever reaches the port sees the play.")
      .type("[ADDRESS:]PORT")
      .check(is_place, place)
      .goes_with({"frames"});
}

void add_picture_options(CommandLine& app, Options& options) {
  const std::vector<std::string> pictures{"--png", "--html", "--web", "--terminal"};
  app.group("The picture");
  app.add("--style", options.style, "Whole spheres, or balls and sticks.")
      .one_of({"spheres", "sticks"})
      .shows_default()
      .needs_one_of(pictures);
  app.add("--size", options.size, "Width and height of the picture in pixels.")
      .type("WxH")
      .check([](const std::string& text) { return parse_size(text).has_value(); },
             format("like 800x600, at most {} each", kMaxPixels))
      .shows_default()
      .needs(app.option("--png"));
  app.add("--from", options.from,
          "Direction of the viewer in degrees: around z, where at 0 x points to the right and y "
          "away, and above the plane of x and y.")
      .type("AZIMUTH,ELEVATION")
      .check([](const std::string& text) { return parse_from(text).has_value(); },
             "like 30,20: degrees from -360 to 360 and from -90 to 90")
      .shows_default()
      .needs_one_of(pictures);
}

}  // namespace

int main(int argc, char** argv) {
  CommandLine app(
      "Shows the frames that play --frames wrote: as a report, a trajectory, a picture or a web "
      "page; or live, in a browser or a terminal, from play --frames - through a pipe.");
  Options options;
  app.add("frames", options.frames, "Frames to show (default: standard input).").type("FRAMES");
  add_file_options(app, options);
  add_live_options(app, options);
  add_picture_options(app, options);
  app.set_help("view",
               "A file named '-' is standard output. Lengths are in the model's unit.\n"
               "The button ? of the page shows what mouse, fingers and keys do.\n");
  return run_tool(app, argc, argv, [&] {
    options.has_from = app.given("--from");
    return run(options);
  });
}
