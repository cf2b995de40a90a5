// The mouse of the window as a hand: the position to which it moves the HIP, and the pipe through
// which play learns that position (libcore/device/hand.hpp).
#pragma once

#include <optional>
#include <string>

#include "libcore/base/file.hpp"
#include "libcore/scene/drawing.hpp"

namespace hapgrid {

class Hand {
 public:
  /// @param pipe a named pipe that play reads already.
  /// @throw Error, std::system_error
  Hand(const std::string& pipe, const Box& box);

  /// Starts the hand at `place`; before that nothing moves.
  void begin(const Vec3& place);
  bool begun() const { return place_.has_value(); }
  /// Where the hand is: in the box, or outside by at most as much as the HIP can lag behind it.
  const Vec3& place() const { return *place_; }

  /// Moves the hand by so many pixels to the right and down in the plane of the picture.
  void move(const Camera& camera, const RenderOptions& options, double right, double down);
  /// Moves it away from the viewer by so many steps of the wheel; 40 are the box's longest side.
  void push(const Camera& camera, double steps);

  /// Writes the hand's place as a line if it is a new one. It never waits: while the pipe is full,
  /// and after the other end was closed, nothing is written.
  /// @throw std::system_error
  void send();

 private:
  void go(const Vec3& way);

  std::string name_;
  FileDescriptor pipe_;
  Vec3 low_, high_;
  double longest_;
  std::optional<Vec3> place_;
  bool changed_ = false;
  bool closed_ = false;
};

}  // namespace hapgrid
