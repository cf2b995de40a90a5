#include "libcore/scene/output.hpp"

#include <limits.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <limits>
#include <system_error>
#include <utility>

#include "libcore/base/signals.hpp"

namespace hapgrid {

namespace {

constexpr int kAskEvery_ms = 20;

}  // namespace

FrameOutput::FrameOutput(OutputFile file) : file_(std::move(file)) {
  // A pipe that poll() calls writable takes PIPE_BUF bytes. O_NONBLOCK would work for any number,
  // but it belongs to the pipe: other writers would see it too.
  struct stat status {};
  const bool regular = ::fstat(file_.fd(), &status) == 0 && S_ISREG(status.st_mode);
  piece_ = regular ? std::numeric_limits<std::size_t>::max() : PIPE_BUF;
}

FrameOutput::Status FrameOutput::write(std::span<const std::byte> message,
                                       const std::function<bool()>& give_up) {
  const NoSigpipe no_sigpipe;
  const auto fail = [&] { throw std::system_error(errno, std::generic_category(), file_.name()); };
  while (!message.empty()) {
    pollfd viewer{file_.fd(), POLLOUT, 0};
    const int ready = ::poll(&viewer, 1, kAskEvery_ms);
    if (ready < 0 && errno != EINTR) fail();
    if (ready <= 0) {
      if (give_up()) return Status::kGivenUp;
      continue;
    }
    const ssize_t count = ::write(file_.fd(), message.data(), std::min(message.size(), piece_));
    if (count < 0 && errno == EPIPE) return Status::kClosed;
    if (count < 0 && errno != EINTR && errno != EAGAIN) fail();
    if (count > 0) message = message.subspan(static_cast<std::size_t>(count));
  }
  return Status::kWritten;
}

}  // namespace hapgrid
