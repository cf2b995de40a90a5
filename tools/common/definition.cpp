#include "tools/common/definition.hpp"

#include <filesystem>

#include "libcore/base/file.hpp"
#include "tools/common/inputs.hpp"
#include "tools/common/tool.hpp"

namespace hapgrid {

void add_definition_file(CommandLine& app, std::string& file) {
  app.add("definition", file,
          "Definition of the model and its grid, which hapgrid-seed(1) explains ('-': standard "
          "input).")
      .type("MODEL.toml")
      .required();
}

void add_definition(CommandLine& app, DefinitionOptions& options) {
  add_definition_file(app, options.file);
  app.add("--set", options.overrides,
          "Value of a key of the definition in place of the file's, as in --set grid.spacing=0.025 "
          "or --set 'grid.counts=[80,40,40]'. It can be given several times.")
      .type("KEY=VALUE")
      .check(
          [](const std::string& text) {
            const std::size_t equals = text.find('=');
            return equals != std::string::npos && equals > 0;
          },
          "like KEY=VALUE")
      .repeatable();
}

Definition load_definition(const DefinitionOptions& options, const std::string& output) {
  keep_inputs({{"--output", output}}, {{options.file, "definition"}});
  const std::string name = options.file == "-" ? "standard input" : options.file;
  const std::filesystem::path directory = std::filesystem::path(options.file).parent_path();
  return read_definition(
      read_toml(options.file), name, options.overrides, [&](const std::string& file) {
        keep_inputs({{"--output", output}}, {{directory / file, "file that the definition names"}});
        return read_regular_text(directory / file, kMaxFileBytes);
      });
}

std::string read_toml(const std::string& name) {
  announce_terminal(name);
  return name == "-" ? read_text(name, kMaxDefinitionBytes)
                     : read_regular_text(name, kMaxDefinitionBytes);
}

}  // namespace hapgrid
