#include "tools/common/definition.hpp"

#include <CLI/CLI.hpp>
#include <filesystem>

#include "libcore/base/file.hpp"

namespace hapgrid {

const char* const kDefinitionHelp =
    "MODEL.toml (lengths in the model's unit of length):\n"
    "  [model] plugin = \"NAME\"        the plug-in NAME.so\n"
    "          process = [\"PROGRAM\", ...], name = \"NAME\"\n"
    "                                 or a program, run beside MODEL.toml with --allow-process\n"
    "  [model.parameters]             the model's own\n"
    "  [model.files]                  text files beside MODEL.toml; the contents are parameters\n"
    "  [grid] origin = [x, y, z]      position of the point (0, 0, 0)\n"
    "         spacing = h             distance of neighbouring points; sqrt(3) h <= d_max\n"
    "         counts = [nx, ny, nz]   points along each axis\n"
    "  [search] max_levels = 8        levels that a point may have, 1 to 254\n"
    "  [seeds] points = [[x, y, z]]   default: the corners of the box\n"
    "          states = [[[...]]]     for each point its states; default: those that the model "
    "knows\n";

void add_definition(CLI::App& app, DefinitionOptions& options) {
  app.add_option("definition", options.file, "The definition ('-': standard input)")
      ->type_name("MODEL.toml")
      ->required();
  app.add_option("--set", options.overrides,
                 "Override a key of the definition, e.g. --set grid.spacing=0.025 or "
                 "--set 'grid.counts=[80,40,40]'; repeatable")
      ->type_name("KEY=VALUE")
      ->check([](const std::string& text) {
        const std::size_t equals = text.find('=');
        const bool good = equals != std::string::npos && equals > 0;
        return good ? "" : "'" + text + "' is not like KEY=VALUE";
      })
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
}

Definition load_definition(const DefinitionOptions& options) {
  const std::string name = options.file == "-" ? "standard input" : options.file;
  const std::filesystem::path directory = std::filesystem::path(options.file).parent_path();
  return read_definition(
      read_text(options.file, kMaxDefinitionBytes), name, options.overrides,
      [&](const std::string& file) { return read_text(directory / file, kMaxDefinitionBytes); });
}

}  // namespace hapgrid
