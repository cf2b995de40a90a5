// How --help looks: no line is longer than a terminal is wide.
#include <CLI/CLI.hpp>
#include <memory>
#include <sstream>
#include <string>

#include "tools/common/tool.hpp"

namespace hapgrid {

namespace {

constexpr std::size_t kColumns = 100;
constexpr std::size_t kNameColumns = 32;

/// The columns that UTF-8 takes; none of our texts has wide characters.
std::size_t columns(const std::string& text) {
  std::size_t n = 0;
  for (const char c : text) n += (static_cast<unsigned char>(c) & 0xc0) != 0x80;
  return n;
}

/// Where a line's text goes on: below what follows its last run of blanks, which in the list of
/// options is the description.
std::size_t hanging_indent(const std::string& line) {
  const std::size_t blanks = line.rfind("  ");
  return blanks == std::string::npos ? 0 : blanks + 2;
}

std::string wrapped(std::string line) {
  const std::size_t indent = hanging_indent(line);
  std::string text;
  while (columns(line) > kColumns) {
    std::size_t cut = line.rfind(' ', kColumns);
    if (cut == std::string::npos || cut <= indent) cut = line.find(' ', indent);
    if (cut == std::string::npos) break;
    text += line.substr(0, cut) + "\n";
    line = std::string(indent, ' ') + line.substr(cut + 1);
  }
  return text + line;
}

class HelpFormatter : public CLI::Formatter {
 public:
  HelpFormatter() { column_width(kNameColumns); }

  std::string make_help(const CLI::App* app, std::string name,
                        CLI::AppFormatMode mode) const override {
    std::istringstream lines(Formatter::make_help(app, name, mode));
    std::string help;
    bool blank = false;
    for (std::string line; std::getline(lines, line);) {
      if (!blank || !line.empty()) help += wrapped(line) + "\n";
      blank = line.empty();
    }
    return help;
  }
};

}  // namespace

void set_help(CLI::App& app, const std::string& name, const std::string& details,
              const std::string& more_exits) {
  app.name(name);
  app.set_version_flag("--version", "hapgrid " + name + " " HAPGRID_VERSION)->group("Options");
  app.formatter(std::make_shared<HelpFormatter>());
  app.footer(details + (details.empty() ? "" : "\n") +
             "Exit codes:\n"
             "  0  done\n"
             "  1  could not: input, I/O, model, device, level limit\n"
             "  2  the command line is wrong; nothing was read or written\n" +
             more_exits);
}

}  // namespace hapgrid
