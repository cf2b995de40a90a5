// seed: the seed records of a grid, from a MODEL.toml.

#include "libcore/search/seed.hpp"

#include "libcore/base/file.hpp"
#include "tools/common/definition.hpp"
#include "tools/common/models.hpp"
#include "tools/common/tool.hpp"

namespace {

struct Options {
  hapgrid::DefinitionOptions definition;
  hapgrid::DefinedModelOptions model;
  std::string output = "-";
};

int run(const Options& options) {
  using namespace hapgrid;
  const Definition definition = load_definition(options.definition, options.output);
  const auto model = model_source(definition, options.definition.file, options.model)
                         ->create(definition.parameters, definition.store);
  const GridSpec spec = spec_of(definition, *model);
  OutputFile out(options.output);
  SectionWriter writer(out.fd(), out.name(), {Content::kGrid, 0, spec});
  write_seeds(definition, spec, *model, writer);
  out.commit();
  return kExitDone;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  hapgrid::CommandLine app{
      "Writes the seed records of a grid: the known states at the seed points, all of them in the\n"
      "frontier. MODEL.toml defines the model and its parameters, the box, the seeds and the "
      "limit\n"
      "of levels."};
  app.set_help("seed");
  hapgrid::add_definition(app, options.definition);
  hapgrid::add_model_options(app, options.model);
  hapgrid::add_output(app, options.output);
  return hapgrid::run_tool(app, argc, argv, [&] { return run(options); });
}
