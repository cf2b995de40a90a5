// A device that moves the HIP through the positions of a text. It has no force.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "libcore/device/device.hpp"

namespace hapgrid {

/// The position in a line of a path; nothing if the line has only blanks and a comment.
/// @throw Error that says what is wrong with the line.
std::optional<Vec3> parse_position(std::string_view line);

/// Reads positions: one x y z in each line, in the model's unit of length, separated by spaces or
/// tabs. '#' starts a comment, blank lines are skipped. Numbers are those of the C locale.
/// @param name for messages.
/// @throw Error "NAME: line N: ..." for any other text, or when there is no position.
std::vector<Vec3> parse_path(std::string_view text, const std::string& name);

/// Each read() gives the next position, however late it comes.
class PathDevice : public Device {
 public:
  explicit PathDevice(std::vector<Vec3> positions) : positions_(std::move(positions)) {}

  /// Reads a whole file, "-" for standard input. @throw Error; std::system_error
  static PathDevice open(const std::string& file);

  std::size_t size() const { return positions_.size(); }
  /// The force that was sent last.
  const Vec3& force() const { return force_; }

  DeviceInfo info() const override { return {.name = "path"}; }
  DeviceStatus read(DeviceInput& input) noexcept override;
  DeviceStatus send(const Vec3& force) noexcept override;
  DeviceStatus stop() noexcept override { return send({0, 0, 0}); }
  std::string error() const override { return "a path does not fail"; }

 private:
  std::vector<Vec3> positions_;
  std::size_t next_ = 0;
  Vec3 force_{0, 0, 0};
};

}  // namespace hapgrid
