#include "tools/stats/gnuplot.hpp"

#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <initializer_list>
#include <span>
#include <system_error>
#include <utility>

#include "libcore/base/error.hpp"
#include "libcore/base/format.hpp"
#include "libcore/base/text.hpp"

namespace hapgrid {

namespace {

[[noreturn]] void fail(int error, const std::string& what) {
  throw std::system_error(error, std::generic_category(), what);
}

/// A file in memory with `text`, to be read from its beginning.
FileDescriptor file_with(const std::string& text) {
  FileDescriptor file(::memfd_create("gnuplot", MFD_CLOEXEC));
  if (!file) fail(errno, "file for gnuplot");
  write_all(file.get(), std::as_bytes(std::span(text)), "file for gnuplot");
  if (::lseek(file.get(), 0, SEEK_SET) != 0) fail(errno, "file for gnuplot");
  return file;
}

/// What gnuplot says is wrong: the last line that is more than the '^' below a place in the script
/// and no warning.
std::string complaint(int fd) {
  std::array<char, 4096> buffer;
  const ssize_t count = ::pread(fd, buffer.data(), buffer.size(), 0);
  const std::string text(buffer.data(), count > 0 ? static_cast<std::size_t>(count) : 0);
  std::string last = "no reason given";
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::string line = text.substr(begin, end - begin);
    const std::size_t word = line.find_first_not_of(" \t^");
    if (word != line.npos && line.find("arning") == line.npos)
      last = printable_line(line.substr(word));
    begin = end + 1;
  }
  return last;
}

// Okabe and Ito's palette, which the colour-blind can tell apart. The index is the number of
// levels; the last colour stands for that many and more.
constexpr std::array kColours{0xdddddd, 0x56b4e9, 0xe69f00, 0x009e73,
                              0xcc79a7, 0x0072b2, 0xd55e00, 0x000000};
constexpr std::size_t kMostLevels = kColours.size() - 1;

/// Pixels. The margins hold titles, labels and tics whatever the plot's own size is.
struct Canvas {
  double plot_width;
  double plot_height;
  double left;
  double right;
  double bottom;
  double top;

  double width() const { return left + plot_width + right; }
  double height() const { return bottom + plot_height + top; }
};

/// The title is a label over the whole picture, since gnuplot's own would be centred on the plot,
/// however narrow that is. A long one is cut, not squeezed.
std::string setup(const Canvas& canvas, const std::string& title, const std::string& subtitle,
                  const std::string& x_label, const std::string& y_label) {
  const auto fraction = [](double part, double whole) { return "screen " + rounded(part / whole); };
  const double w = canvas.width();
  const double h = canvas.height();
  return format(
      "set encoding utf8\n"
      "set terminal pngcairo noenhanced size {},{} font 'sans,12'\n"
      "set lmargin at {}\n"
      "set rmargin at {}\n"
      "set bmargin at {}\n"
      "set tmargin at {}\n"
      "set label 1 {} at screen 0.5, {} center font 'sans,14'\n"
      "set label 2 {} at screen 0.5, {} center\n"
      "set xlabel {}\n"
      "set ylabel {}\n"
      "set tics out nomirror\n",
      rounded(std::round(w)), rounded(std::round(h)), fraction(canvas.left, w),
      fraction(canvas.left + canvas.plot_width, w), fraction(canvas.bottom, h),
      fraction(canvas.bottom + canvas.plot_height, h), gnuplot_string(title), fraction(h - 25, h),
      gnuplot_string(subtitle), fraction(h - 50, h), gnuplot_string(x_label),
      gnuplot_string(y_label));
}

void append_numbers(std::string& script, std::initializer_list<double> values) {
  for (const double value : values) script += to_text(value) + ' ';
  script += '\n';
}

/// Where the squares of one axis are drawn; gnuplot wants two at least, so the only plane of an
/// axis is drawn as two halves.
std::vector<double> square_centres(const Box& box, int axis) {
  if (box.counts[axis] == 1)
    return {box.origin[axis] - box.spacing / 4, box.origin[axis] + box.spacing / 4};
  std::vector<double> centres;
  for (std::uint32_t c = 0; c < box.counts[axis]; ++c)
    centres.push_back(box.origin[axis] + box.spacing * c);
  return centres;
}

std::string axis_range(const Box& box, int axis) {
  const double low = box.origin[axis] - box.spacing / 2;
  return format("[{}:{}]\n", to_text(low), to_text(low + box.spacing * box.counts[axis]));
}

}  // namespace

std::string gnuplot_string(std::string_view text) {
  std::string result = "'";
  for (const char c : printable_line(text, text.npos)) {
    if (c == '\'')
      result += "''";
    else
      result += c == '\\' || c == '`' ? '?' : c;
  }
  return result + "'";
}

void run_gnuplot(const std::string& script, OutputFile& png) {
  // Files instead of pipes: no order of reading and writing can block, and nothing is left over.
  const FileDescriptor input = file_with(script);
  const FileDescriptor errors = file_with("");
  FileDescriptor output = file_with("");
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_adddup2(&actions, output.get(), STDOUT_FILENO);
  ::posix_spawn_file_actions_adddup2(&actions, input.get(), STDIN_FILENO);
  ::posix_spawn_file_actions_adddup2(&actions, errors.get(), STDERR_FILENO);
  // --default-settings: a user's ~/.gnuplot must not change the picture.
  std::array<std::string, 3> words{"gnuplot", "--default-settings", "-"};
  std::array<char*, 4> argv{words[0].data(), words[1].data(), words[2].data(), nullptr};
  pid_t child = 0;
  const int error = ::posix_spawnp(&child, "gnuplot", &actions, nullptr, argv.data(), environ);
  ::posix_spawn_file_actions_destroy(&actions);
  const char* const not_found = "gnuplot: not found: install gnuplot-nox";
  if (error == ENOENT) throw Error(not_found);
  if (error != 0) fail(error, "gnuplot");
  int status = 0;
  while (::waitpid(child, &status, 0) < 0)
    if (errno != EINTR) fail(errno, "gnuplot");
  if (WIFSIGNALED(status)) throw Error(format("gnuplot: ended by signal {}", WTERMSIG(status)));
  if (WEXITSTATUS(status) == 127) throw Error(not_found);  // as posix_spawnp() may say it, too
  if (WEXITSTATUS(status) != 0) throw Error(format("gnuplot: {}", complaint(errors.get())));
  // gnuplot says nothing of what it could not write: it writes to memory, and that it is whole is
  // seen by the last chunk of a PNG.
  const InputFile picture(std::move(output), "picture of gnuplot");
  std::string bytes(picture.size(), '\0');
  bytes.resize(picture.read(0, std::as_writable_bytes(std::span(bytes))));
  if (!bytes.ends_with(std::string_view("\0\0\0\0IEND\xae\x42\x60\x82", 12)))
    throw Error("gnuplot: the picture is not whole");
  png.write(bytes);
}

std::string slice_script(const GridSpec& spec, const Slice& slice) {
  const Box& box = spec.box;
  const std::uint32_t nu = box.counts[slice.u];
  const std::uint32_t nv = box.counts[slice.v];
  // Equal scales on both axes, the longer one 700 pixels. Beside the plot there is room for the
  // legend and for labels that are longer than a narrow plot.
  const double pixels = 700.0 / std::max(nu, nv);
  Canvas canvas{nu * pixels, nv * pixels, 110, 245, 75, 80};
  canvas.right += std::max(0.0, 300 - canvas.plot_width);
  const double missing = std::max(0.0, 140 - canvas.plot_height);
  canvas.bottom += missing / 2;
  canvas.top += missing / 2;
  const auto label = [&](int axis) {
    return axis_label(std::string(1, "xyz"[axis]),
                      spec.length_unit.empty() ? "model's unit of length" : spec.length_unit);
  };
  constexpr std::size_t kLongestName = 32;
  const bool is_long = spec.model.size() > kLongestName;
  const std::string model =
      is_long ? printable_line(spec.model, kLongestName - 3) + "..." : spec.model;
  std::string script =
      setup(canvas,
            format("{}: levels of each point at {} = {}", model, "xyz"[slice.axis],
                   rounded(slice.coordinate)),
            format("grid of {} × {} × {} points", box.counts[0], box.counts[1], box.counts[2]),
            label(slice.u), label(slice.v));
  script += "set xrange " + axis_range(box, slice.u) + "set yrange " + axis_range(box, slice.v);
  // Along a short axis tics would run into each other: one in its middle plane has to do.
  const auto one_tic = [&](const char* tics, int axis) {
    const std::string middle = rounded(box.origin[axis] + box.spacing * (box.counts[axis] / 2));
    script += format("set {} ({} {})\n", tics, gnuplot_string(middle), middle);
  };
  if (canvas.plot_width < 200) one_tic("xtics", slice.u);
  if (canvas.plot_height < 100) one_tic("ytics", slice.v);
  script += "set key at screen " +
            rounded((canvas.left + canvas.plot_width + 15) / canvas.width()) + ", screen " +
            rounded((canvas.bottom + canvas.plot_height) / canvas.height()) +
            " left top vertical maxrows 8 Left reverse samplen 1.5 spacing 1.4\n"
            "set style fill solid border rgb '#555555'\n"
            "$levels << END\n";

  std::array<std::uint64_t, kColours.size()> points{};
  for (const RecordIndex levels : slice.levels)
    ++points[std::min<std::size_t>(levels, kMostLevels)];
  const std::vector<double> u = square_centres(box, slice.u);
  const std::vector<double> v = square_centres(box, slice.v);
  for (std::size_t j = 0; j < v.size(); ++j)
    for (std::size_t i = 0; i < u.size(); ++i) {
      const std::size_t point =
          std::min<std::size_t>(i, nu - 1) + std::size_t{nu} * std::min<std::size_t>(j, nv - 1);
      const int colour = kColours[std::min<std::size_t>(slice.levels[point], kMostLevels)];
      append_numbers(script,
                     {u[i], v[j], static_cast<double>(colour >> 16),
                      static_cast<double>(colour >> 8 & 255), static_cast<double>(colour & 255)});
    }
  script += "END\nplot $levels with rgbimage notitle";
  for (std::size_t k = 0; k < points.size(); ++k) {
    if (points[k] == 0) continue;
    const std::string what = k == 0   ? "not reached"
                             : k == 1 ? "1 level"
                                      : format("{}{} levels", k, k == kMostLevels ? "+" : "");
    script += format(
        ", NaN with boxes lc rgb '#{:06x}' title {}", kColours[k],
        gnuplot_string(format("{}: {} point{}", what, points[k], points[k] == 1 ? "" : "s")));
  }
  return script + "\n";
}

std::string motion_script(const std::vector<MotionCurve>& curves, const std::string& title,
                          const std::string& subtitle, const std::string& x_label,
                          const std::string& y_label) {
  std::string script = setup({880, 480, 95, 25, 75, 110}, title, subtitle, x_label, y_label);
  script +=
      "set grid lc rgb '#dddddd' lt 1\n"
      "set autoscale fix\n"
      "set offsets graph 0.02, graph 0.02, graph 0.05, graph 0.05\n"
      "set key at screen 0.5, screen 0.87 center horizontal Left reverse samplen 3 width 2\n";
  // The way there is broad and light, the way back thin and dark, so that both are seen where they
  // run over each other; a second curve is thinner than the first.
  constexpr std::array<std::array<const char*, 2>, 2> kLooks{
      {{"lw 7 lc rgb '#56b4e9'", "lw 2.5 lc rgb '#d55e00'"},
       {"lw 4 lc rgb '#bbbbbb'", "lw 1.2 lc rgb '#000000'"}}};
  std::string plots;
  const auto append = [&](std::size_t c, int back, const std::vector<XY>& line) {
    if (line.empty()) return;
    const std::string data = format("${}{}", back ? "back" : "there", c);
    script += format("{} << END\n", data);
    for (const auto& [x, y] : line) append_numbers(script, {x, y});
    script += "END\n";
    const std::string way = back ? "back" : "there";
    plots += format("{}{} with lines {} title {}", plots.empty() ? "" : ", ", data, kLooks[c][back],
                    gnuplot_string(curves.size() > 1 ? way + ", " + curves[c].name : way));
  };
  for (std::size_t c = 0; c < std::min(curves.size(), kLooks.size()); ++c) {
    append(c, 0, curves[c].motion.there);
    append(c, 1, curves[c].motion.back);
  }
  return script + "plot " + plots + "\n";
}

}  // namespace hapgrid
