// The mouse of the window as a hand: where it wants the HIP to be, and the pipe through which play
// learns that (libcore/device/hand.hpp).
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

  /// Takes the HIP at `place`; before that nothing moves.
  void begin(const Vec3& place);
  bool begun() const { return place_.has_value(); }
  /// Where it is: in the box, or farther out by as much as the HIP can lag behind it.
  const Vec3& place() const { return *place_; }

  /// By so many pixels to the right and down in the plane of the picture.
  void move(const Camera& camera, const RenderOptions& options, double right, double down);
  /// Away from the viewer by so many steps of the wheel, of which 40 are the box's longest side.
  void push(const Camera& camera, double steps);

  /// Writes the place as a line where it is a new one. Never waits: while the pipe is full nothing
  /// is written, and nobody needs to know when the other end is closed.
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
