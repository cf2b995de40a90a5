// Positions as a text.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "libcore/device/device.hpp"
#include "libcore/grid/vec3.hpp"

namespace hapgrid {

/// Reads positions: one x y z in each line, in the model's unit of length, separated by spaces or
/// tabs; the word `next` can follow, which is DeviceInput::next. '#' starts a comment, blank lines
/// are skipped. Numbers are those of the C locale.
/// @param name for messages.
/// @throw Error "NAME: line N: ..." for any other text, or when there is no position.
std::vector<DeviceInput> parse_path(std::string_view text, const std::string& name);

/// Of a whole file, "-" for standard input. @throw Error; std::system_error
std::vector<DeviceInput> read_path(const std::string& file);

// A device that does what a list says, tick by tick: what a hand did, or the positions of a path.

/// Each read() gives the next input, however late it comes. Of a recorded play, its
/// DeviceInput::missed tells the ticks that were missed before it, so that the loop does what it
/// did then. It has no force.
class ReplayDevice : public Device {
 public:
  explicit ReplayDevice(std::vector<DeviceInput> ticks, std::string name = "replay")
      : ticks_(std::move(ticks)), name_(std::move(name)) {}

  std::size_t size() const { return ticks_.size(); }
  /// The force that was sent last.
  const Vec3& force() const { return force_; }

  DeviceInfo info() const override { return {.name = name_}; }
  DeviceStatus read(DeviceInput& input) noexcept override;
  DeviceStatus send(const Vec3& force) noexcept override;
  DeviceStatus stop() noexcept override { return send({0, 0, 0}); }
  std::string error() const override { return "a " + name_ + " does not fail"; }

 private:
  std::vector<DeviceInput> ticks_;
  std::string name_;
  std::size_t next_ = 0;
  Vec3 force_{0, 0, 0};
};

}  // namespace hapgrid
