#include "tools/view/hand.hpp"

#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>

#include "libcore/base/error.hpp"
#include "libcore/base/format.hpp"
#include "libcore/base/text.hpp"
#include "libcore/device/hand.hpp"

namespace hapgrid {

namespace {

constexpr double kStepsOfBox = 40;

FileDescriptor open_for_play(const std::string& name) {
  const auto fail = [&] { throw std::system_error(errno, std::generic_category(), name); };
  struct stat status {};
  if (::stat(name.c_str(), &status) != 0) fail();
  if (!S_ISFIFO(status.st_mode)) throw Error(format("{}: is not a named pipe", name));
  FileDescriptor pipe(::open(name.c_str(), O_WRONLY | O_NONBLOCK | O_CLOEXEC));
  if (!pipe && errno == ENXIO)
    throw Error(format("{0}: nobody reads this pipe; it is for play --device path:{0}", name));
  if (!pipe) fail();
  return pipe;
}

}  // namespace

Hand::Hand(const std::string& pipe, const Box& box)
    : name_(pipe),
      pipe_(open_for_play(pipe)),
      low_(box.position({0, 0, 0})),
      high_(box.position({box.counts[0] - 1, box.counts[1] - 1, box.counts[2] - 1})),
      longest_(std::max({high_[0] - low_[0], high_[1] - low_[1], high_[2] - low_[2]})) {
  ::signal(SIGPIPE, SIG_IGN);  // play may end first
}

void Hand::begin(const Vec3& place) { place_ = place; }

void Hand::move(const Camera& camera, const RenderOptions& options, double right, double down) {
  // The picture's middle goes the other way when the picture is moved.
  const Camera moved = panned(camera, options, right, down);
  go({camera.centre[0] - moved.centre[0], camera.centre[1] - moved.centre[1],
      camera.centre[2] - moved.centre[2]});
}

void Hand::push(const Camera& camera, double steps) {
  const Vec3 near = PictureAxes(camera).near;
  const double away = -steps * longest_ / kStepsOfBox;
  go({away * near[0], away * near[1], away * near[2]});
}

void Hand::go(const Vec3& way) {
  if (!place_) return;
  const double margin = kHandReach * longest_;
  for (int a = 0; a < 3; ++a)
    (*place_)[a] = std::clamp((*place_)[a] + way[a], low_[a] - margin, high_[a] + margin);
  changed_ = true;
}

void Hand::send() {
  if (!changed_ || closed_) return;
  const Vec3& x = *place_;
  const std::string line = format("{} {} {}\n", to_text(x[0]), to_text(x[1]), to_text(x[2]));
  // A line is far shorter than PIPE_BUF: all of it is written, or nothing.
  if (::write(pipe_.get(), line.data(), line.size()) >= 0)
    changed_ = false;
  else if (errno == EPIPE)
    closed_ = true;
  else if (errno != EAGAIN && errno != EINTR)
    throw std::system_error(errno, std::generic_category(), name_);
}

}  // namespace hapgrid
