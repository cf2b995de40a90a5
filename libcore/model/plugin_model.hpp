// Models from plug-ins (plugin.h).
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "libcore/model/model.hpp"

struct hapgrid_model_table;

namespace hapgrid {

/// The directories in which plug-ins are looked for, in this order: the entries of the
/// environment's HAPGRID_MODEL_PATH, with ':' between them, then ../models beside the running
/// program.
std::vector<std::filesystem::path> model_path();

/// A loaded plug-in. Its name may come from a hostile shard, so only valid names are accepted.
/// Models keep the plug-in loaded. Threads may create models at the same time, by the same Plugin
/// or by others: one waits for the other.
class Plugin : public ModelSource {
 public:
  /// @throw ModelError when the name is not valid, no directory has NAME.so, or that file is no
  /// plug-in of this interface version.
  Plugin(const std::string& name, const std::vector<std::filesystem::path>& directories);

  const std::string& name() const { return name_; }
  const std::string& summary() const { return summary_; }

  const char* kind() const override { return "plug-in"; }
  using ModelSource::create;
  std::unique_ptr<Model> create(const std::vector<Parameter>& parameters,
                                const Stored& store) const override;

 private:
  std::string name_;
  std::string summary_;
  std::shared_ptr<void> library_;
  const hapgrid_model_table* table_ = nullptr;
};

}  // namespace hapgrid
