#include "libcore/model/process_source.hpp"

#include <limits>
#include <utility>

#include "libcore/base/error.hpp"

namespace hapgrid {

ProcessSource::ProcessSource(std::string name, Command command, const ProcessOptions& options)
    : name_(std::move(name)), command_(std::move(command)), options_(options) {}

Model ProcessSource::create(const std::vector<Parameter>& parameters) const {
  try {
    const std::string handshake = handshake_line(parameters);
    if (group_ && group_->handshake == handshake && description_)
      return Model(std::make_unique<ProcessModel>(group_, *description_));
    group_ = std::make_shared<ProcessGroup>();
    group_->command = command_;
    group_->options = options_;
    group_->handshake = handshake;
    description_.reset();
    auto first = std::make_unique<ProcessModel>(group_);
    description_ = first->description();
    return Model(std::move(first));
  } catch (const ModelError& e) {
    throw ModelError("model " + name_ + ": " + e.what());
  }
}

Model declared_model(const GridSpec& spec) {
  Description d;
  d.state_size = spec.state_size;
  d.d_max = std::numeric_limits<double>::infinity();  // not in a shard, and nothing is converted
  d.tolerance = spec.tolerance;
  d.tolerance_unit = spec.tolerance_unit;
  d.equality = spec.equality;
  d.length_unit = spec.length_unit;
  d.energy_unit = spec.energy_unit;
  d.hip_radius = spec.hip_radius;
  d.stored = spec.stored;
  d.spheres = spec.spheres;
  return Model(std::make_unique<ProcessModel>(nullptr, std::move(d)));
}

}  // namespace hapgrid
