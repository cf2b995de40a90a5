// Models that are processes, as the tools get them.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libcore/model/model.hpp"
#include "libcore/model/process_model.hpp"

namespace hapgrid {

/// A command that the user allowed. The first model that is created starts a process and hears
/// what the model is; those after it, with the same parameters, start theirs when they are asked
/// something, so that slow starts happen at the same time.
class ProcessSource : public ModelSource {
 public:
  /// @param name of the model, for messages.
  ProcessSource(std::string name, Command command, const ProcessOptions& options);

  const char* kind() const override { return "process"; }
  Model create(const std::vector<Parameter>& parameters) const override;

 private:
  std::string name_;
  Command command_;
  ProcessOptions options_;
  mutable std::shared_ptr<ProcessGroup> group_;  // of the parameters that were asked for last
  mutable std::optional<Description> description_;
};

/// What a shard tells of a model that is a process: enough for equal(), and nothing is started.
Model declared_model(const GridSpec& spec);

}  // namespace hapgrid
