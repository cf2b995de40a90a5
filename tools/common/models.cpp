#include "tools/common/models.hpp"

#include <cstdlib>
#include <filesystem>

#include "libcore/base/error.hpp"
#include "libcore/base/file.hpp"
#include "libcore/base/format.hpp"
#include "libcore/search/converter.hpp"
#include "tools/common/tool.hpp"

namespace hapgrid {

namespace {

std::string shown(const std::string& file) { return file == "-" ? "standard input" : file; }

/// Lets a model in Python find the module hapgrid of this installation, behind what PYTHONPATH has.
void offer_python_module() {
  std::error_code ignored;
  const std::filesystem::path folder = own_folder().parent_path() / "python";
  if (!std::filesystem::exists(folder / "hapgrid", ignored)) return;
  const char* given = std::getenv("PYTHONPATH");
  const std::string before = given && *given ? given + std::string(":") : "";
  ::setenv("PYTHONPATH", (before + folder.string()).c_str(), 1);
}

/// It runs in the directory of the definition's file.
std::unique_ptr<ModelSource> process_source(const Definition& definition, const std::string& file) {
  offer_python_module();
  // As many models as the user wants work side by side. More threads in each would only be in the
  // way of the others, and their number can change the last bits of a sum.
  for (const char* threads : {"OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"})
    ::setenv(threads, "1", /*overwrite=*/0);
  ProcessOptions options;
  options.timeout_seconds = definition.timeout_seconds;
  options.hint = [](const std::string& line) { say("hapgrid", line); };
  return std::make_unique<ProcessSource>(definition.model, definition.command,
                                         std::filesystem::path(file).parent_path(), options);
}

}  // namespace

void add_model_options(CommandLine& app, ModelOptions& options) {
  app.add("--allow-process", options.allowed,
          "Definition whose command may be run as the model, if the grid's model is a process.")
      .type("MODEL.toml");
}

void add_model_options(CommandLine& app, DefinedModelOptions& options) {
  app.add_flag("--allow-process", options.allow_process,
               "Allow to run the command that MODEL.toml names as its model.");
}

std::unique_ptr<ModelSource> model_source(const Definition& definition, const std::string& file,
                                          const DefinedModelOptions& options) {
  if (definition.command.empty()) return std::make_unique<Plugin>(definition.model, model_path());
  if (!options.allow_process)
    throw Error(
        format("{}: the model is a process, '{}', which is only started with --allow-process",
               shown(file), command_text(definition.command)));
  return process_source(definition, file);
}

std::unique_ptr<ModelSource> model_source(const GridSpec& spec, const ModelOptions& options,
                                          const std::string& instead) {
  if (!spec.equality.is_declared()) return std::make_unique<Plugin>(spec.model, model_path());
  if (!is_valid_name(spec.model))
    throw ModelError("a model whose name has other than letters, digits, '-' and '_'");
  if (options.allowed.empty())
    throw ModelError(
        format("model {}: is a process, which is only started with --allow-process MODEL.toml{}",
               spec.model, instead));
  const std::string name = shown(options.allowed);
  const Definition process = read_process(read_toml(options.allowed), name);
  if (process.model != spec.model)
    throw ModelError(
        format("{}: defines the model {}, the grid's is {}", name, process.model, spec.model));
  return process_source(process, options.allowed);
}

std::unique_ptr<Model> judging_model(const GridSpec& spec) {
  if (spec.equality.is_declared()) return declared_model(spec);
  return create_model(Plugin(spec.model, model_path()), spec);
}

}  // namespace hapgrid
