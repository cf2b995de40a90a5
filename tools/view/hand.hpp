// The hand of the live page: the position to which it moves the HIP, and the pipe through which
// play learns that position (libcore/device/hand.hpp).
#pragma once

#include <optional>
#include <string>
#include <utility>

#include "libcore/base/file.hpp"
#include "libcore/grid/box.hpp"

namespace hapgrid {

/// The lowest and the highest place of a hand: as far outside the box as the HIP can lag behind it.
std::pair<Vec3, Vec3> hand_range(const Box& box);

class Hand {
 public:
  /// @param pipe a named pipe that play reads already.
  /// @throw Error, std::system_error
  Hand(const std::string& pipe, const Box& box);

  /// Puts the hand to a place, or to the nearest one that it can reach. It never waits: while the
  /// pipe is full, and after the other end was closed, nothing is written.
  /// @throw std::system_error
  void move_to(const Vec3& place);
  /// Wants the next level at the hand's place. As move_to().
  void next_level();
  /// Where the hand was put last; nothing before.
  const std::optional<Vec3>& place() const { return place_; }

 private:
  void write(const std::string& line);

  std::string name_;
  FileDescriptor pipe_;
  std::pair<Vec3, Vec3> range_;
  std::optional<Vec3> place_;
};

}  // namespace hapgrid
