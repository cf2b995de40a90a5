#include "tools/common/definition.hpp"

#include <CLI/CLI.hpp>
#include <filesystem>

#include "libcore/base/file.hpp"

namespace hapgrid {

void add_definition(CLI::App& app, DefinitionOptions& options) {
  app.add_option("definition", options.file,
                 "The definition, see hapgrid-seed(1) ('-': standard input)")
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
