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

std::pair<Vec3, Vec3> hand_range(const Box& box) {
  const Vec3 low = box.position({0, 0, 0});
  const Vec3 high = box.position({box.counts[0] - 1, box.counts[1] - 1, box.counts[2] - 1});
  const double reach =
      kHandReach * std::max({high[0] - low[0], high[1] - low[1], high[2] - low[2]});
  const Vec3 margin{reach, reach, reach};
  return {low - margin, high + margin};
}

Hand::Hand(const std::string& pipe, const Box& box)
    : name_(pipe), pipe_(open_for_play(pipe)), range_(hand_range(box)) {
  ::signal(SIGPIPE, SIG_IGN);  // play may end first
}

void Hand::move_to(const Vec3& place) {
  place_ = place;
  for (int a = 0; a < 3; ++a)
    (*place_)[a] = std::clamp(place[a], range_.first[a], range_.second[a]);
  const Vec3& x = *place_;
  write(format("{} {} {}\n", to_text(x[0]), to_text(x[1]), to_text(x[2])));
}

void Hand::next_level() { write(std::string(kHandNext) + "\n"); }

void Hand::write(const std::string& line) {
  // A line is far shorter than PIPE_BUF: all of it is written, or nothing. Of a full pipe play
  // reads places that are newer than what it had, and the next move brings the newest one.
  if (::write(pipe_.get(), line.data(), line.size()) < 0 && errno != EPIPE && errno != EAGAIN &&
      errno != EINTR)
    throw std::system_error(errno, std::generic_category(), name_);
}

}  // namespace hapgrid
