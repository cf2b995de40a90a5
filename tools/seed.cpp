// seed: the seed records of a grid, from a MODEL.toml.

#include "libcore/search/seed.hpp"

#include <filesystem>

#include "libcore/base/file.hpp"
#include "libcore/model/definition.hpp"
#include "tools/common/tool.hpp"

namespace {

struct Options {
  std::string definition = "-";
  std::vector<std::string> overrides;
  std::vector<std::string> model_path;
  std::string output = "-";
};

constexpr std::uint64_t kMaxDefinitionBytes = 16 << 20;

int run(const Options& options) {
  using namespace hapgrid;
  const std::string name = options.definition == "-" ? "standard input" : options.definition;
  const std::filesystem::path directory = std::filesystem::path(options.definition).parent_path();
  const Definition definition = read_definition(
      read_text(options.definition, kMaxDefinitionBytes), name, options.overrides,
      [&](const std::string& file) { return read_text(directory / file, kMaxDefinitionBytes); });
  const Plugin plugin(definition.plugin, model_path(options.model_path));
  const Model model = plugin.create(definition.parameters);
  const GridSpec spec = describe_grid(definition, model);
  OutputFile out(options.output);
  SectionWriter writer(out.fd(), out.name(), {Content::kGrid, 0, spec});
  write_seeds(definition, spec, model, writer);
  out.commit();
  return kExitDone;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app{
      "Writes the seed records of a grid: the known states at the seed points, all of them in the\n"
      "frontier. The model, its parameters, the box, the seeds and the level limit are in "
      "MODEL.toml."};
  hapgrid::describe(
      app, "seed",
      "MODEL.toml (lengths in the model's unit of length):\n"
      "  [model] plugin = \"NAME\"        the plug-in NAME.so\n"
      "  [model.parameters]             the model's own\n"
      "  [model.files]                  text files beside MODEL.toml; the contents are parameters\n"
      "  [grid] origin = [x, y, z]      position of the point (0, 0, 0)\n"
      "         spacing = h             distance of neighbouring points; sqrt(3) h <= d_max\n"
      "         counts = [nx, ny, nz]   points along each axis\n"
      "  [search] max_levels = 8        levels that a point may have, 1 to 254\n"
      "  [seeds] points = [[x, y, z]]   default: the corners of the box\n"
      "          states = [[[...]]]     for each point its states; default: those that the model "
      "knows\n");
  app.add_option("definition", options.definition, "The definition ('-': standard input)")
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
  hapgrid::add_model_path(app, options.model_path);
  hapgrid::add_output(app, options.output);
  return hapgrid::run_tool(app, argc, argv, [&] { return run(options); });
}
