// Models that are processes (PROTOCOL.md).
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "libcore/model/model.hpp"

namespace hapgrid {

struct ProcessOptions {
  double timeout_seconds = 60;  ///< for one answer
  /// For the first line. The longer of both timeouts counts.
  double start_timeout_seconds = 60;
  /// Gets a line for the user, at most once for a source: a process that owes an answer waits for
  /// input. May be empty; is called by any thread.
  std::function<void(const std::string&)> hint{};
};

struct ProcessGroup;

/// A command that the user allowed. The first model that is created starts a process and reads its
/// first line. Later models with the same parameters start their processes with their first
/// question, so that slow starts happen at the same time.
class ProcessSource : public ModelSource {
 public:
  /// @param name of the model, for messages.
  /// @param command program and arguments, without a shell; the program is looked up in PATH.
  /// @param directory where it runs, and where "./program" is looked for.
  ProcessSource(std::string name, std::vector<std::string> command, std::filesystem::path directory,
                const ProcessOptions& options)
      : name_(std::move(name)),
        command_(std::move(command)),
        directory_(std::move(directory)),
        options_(options) {}

  const char* kind() const override { return "process"; }
  using ModelSource::create;
  std::unique_ptr<Model> create(const std::vector<Parameter>& parameters,
                                const Stored& store) const override;

 private:
  std::string name_;
  std::vector<std::string> command_;
  std::filesystem::path directory_;
  ProcessOptions options_;
  mutable std::shared_ptr<ProcessGroup> group_;  // of the parameters that were asked for last
};

/// The words with spaces between them, for messages. A long text is cut.
std::string command_text(const std::vector<std::string>& command);

}  // namespace hapgrid
