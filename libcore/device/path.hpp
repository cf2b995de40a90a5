// A device that moves the HIP through the positions of a text. It has no force.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "libcore/device/device.hpp"

namespace hapgrid {

/// A line of a path: where the HIP is, and whether it wants the next level there, as
/// DeviceInput::next does.
struct PathTick {
  Vec3 x;
  bool next = false;
  friend bool operator==(const PathTick&, const PathTick&) = default;
};

/// What a line of a path has; nothing if it has only blanks and a comment.
/// @throw Error that says what is wrong with the line.
std::optional<PathTick> parse_tick(std::string_view line);

/// Reads positions: one x y z in each line, in the model's unit of length, separated by spaces or
/// tabs; the word `next` can follow. '#' starts a comment, blank lines are skipped. Numbers are
/// those of the C locale.
/// @param name for messages.
/// @throw Error "NAME: line N: ..." for any other text, or when there is no position.
std::vector<PathTick> parse_path(std::string_view text, const std::string& name);

/// Each read() gives the next position, however late it comes.
class PathDevice : public Device {
 public:
  explicit PathDevice(std::vector<PathTick> ticks) : ticks_(std::move(ticks)) {}

  /// Reads a whole file, "-" for standard input. @throw Error; std::system_error
  static PathDevice open(const std::string& file);

  std::size_t size() const { return ticks_.size(); }
  /// The force that was sent last.
  const Vec3& force() const { return force_; }

  DeviceInfo info() const override { return {.name = "path"}; }
  DeviceStatus read(DeviceInput& input) noexcept override;
  DeviceStatus send(const Vec3& force) noexcept override;
  DeviceStatus stop() noexcept override { return send({0, 0, 0}); }
  std::string error() const override { return "a path does not fail"; }

 private:
  std::vector<PathTick> ticks_;
  std::size_t next_ = 0;
  Vec3 force_{0, 0, 0};
};

}  // namespace hapgrid
