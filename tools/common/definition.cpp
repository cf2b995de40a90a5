#include "tools/common/definition.hpp"

#include <filesystem>

#include "libcore/base/file.hpp"

namespace hapgrid {

void add_definition(CommandLine& app, DefinitionOptions& options) {
  app.add("definition", options.file, "The definition, see hapgrid-seed(1) ('-': standard input)")
      .type("MODEL.toml")
      .required();
  app.add("--set", options.overrides,
          "Override a key of the definition, e.g. --set grid.spacing=0.025 or "
          "--set 'grid.counts=[80,40,40]'; repeatable")
      .type("KEY=VALUE")
      .check(
          [](const std::string& text) {
            const std::size_t equals = text.find('=');
            return equals != std::string::npos && equals > 0;
          },
          "like KEY=VALUE")
      .repeatable();
}

Definition load_definition(const DefinitionOptions& options) {
  const std::string name = options.file == "-" ? "standard input" : options.file;
  const std::filesystem::path directory = std::filesystem::path(options.file).parent_path();
  return read_definition(
      read_text(options.file, kMaxDefinitionBytes), name, options.overrides,
      [&](const std::string& file) { return read_text(directory / file, kMaxDefinitionBytes); });
}

}  // namespace hapgrid
