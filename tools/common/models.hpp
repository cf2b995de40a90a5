// Where the filters get their model from: a plug-in, or a process that the command line allows.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "libcore/model/definition.hpp"
#include "libcore/model/plugin_model.hpp"
#include "libcore/model/process_model.hpp"
#include "tools/common/definition.hpp"

namespace hapgrid {

/// Options of a filter that reads a grid.
struct ModelOptions {
  std::string allowed;  ///< the MODEL.toml of --allow-process
};

/// Options of a filter that reads a definition, which itself names the command.
struct DefinedModelOptions {
  bool allow_process = false;
};

/// --allow-process MODEL.toml.
void add_model_options(CommandLine& app, ModelOptions& options);
/// --allow-process.
void add_model_options(CommandLine& app, DefinedModelOptions& options);

/// The source of the model that `definition`, read from `file`, defines.
/// @throw ModelError; Error when it is a process and not allowed
std::unique_ptr<ModelSource> model_source(const Definition& definition, const std::string& file,
                                          const DefinedModelOptions& options);

/// The source of the grid's model. A process is never started because a shard says so: its command
/// comes from the user's own definition, whose name must be the grid's.
/// @param instead what else the user could do, for the message.
/// @throw ModelError, Error, std::system_error
std::unique_ptr<ModelSource> model_source(const GridSpec& spec, const ModelOptions& options,
                                          const std::string& instead = "");

/// A model that judges equality and is asked nothing else. Of a process, the grid's header has its
/// tolerance function in words, and no process is started.
/// @throw ModelError
std::unique_ptr<Model> judging_model(const GridSpec& spec);

}  // namespace hapgrid
