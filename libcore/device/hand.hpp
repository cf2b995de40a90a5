// A hand without a force on it, such as one on a mouse (coupled_hip.hpp). Another program writes
// the hand's position into a named pipe.
#pragma once

#include <atomic>
#include <chrono>
#include <optional>
#include <string>
#include <string_view>
#include <thread>

#include "libcore/base/file.hpp"
#include "libcore/base/triple_buffer.hpp"
#include "libcore/device/coupled_hip.hpp"
#include "libcore/device/device.hpp"

namespace hapgrid {

/// The line of a pipe that wants the next level.
inline constexpr std::string_view kHandNext = "next";

/// Reads positions, in the lines of a path, from a stream of bytes. A line `next` wants the next
/// level at the place of the hand.
class HandLines {
 public:
  /// The newest position of the lines that end in `bytes`, if there is one.
  /// @throw Error "line N: ...", also for a line of more than 256 bytes
  std::optional<Vec3> read(std::string_view bytes);
  /// Reads the last line of the stream, which may have no end. @throw Error
  std::optional<Vec3> finish();
  unsigned nexts() const { return nexts_; }

 private:
  std::optional<Vec3> read_line();

  std::string line_;
  unsigned nexts_ = 0;
  std::size_t number_ = 1;
};

/// Reads the pipe in a thread of its own. The HIP follows the last position while no new one comes,
/// and the play ends when the pipe's writers have closed it.
class HandDevice : public Device {
 public:
  /// @param pipe a named pipe, which need not have a writer yet. @throw std::system_error
  HandDevice(const std::string& pipe, const HipRange& range);

  DeviceInfo info() const override { return {.name = "hand"}; }
  DeviceStatus read(DeviceInput& input) noexcept override;
  DeviceStatus send(const Vec3& force) noexcept override;
  DeviceStatus stop() noexcept override { return send({0, 0, 0}); }
  std::string error() const override { return name_ + ": " + error_; }

 private:
  void listen(const std::stop_token& token);
  /// @throw Error, std::system_error. @return false at the end of the stream
  bool listen_once(HandLines& lines);

  std::string name_;
  FileDescriptor pipe_;
  TripleBuffer<Vec3> hand_;
  std::atomic<unsigned> nexts_{0};
  std::string error_;  // the listener's until kFailed
  std::atomic<DeviceStatus> status_{DeviceStatus::kOk};
  // The haptic thread's.
  CoupledHip hip_;
  Vec3 force_{0, 0, 0};
  unsigned seen_nexts_ = 0;
  std::optional<std::chrono::steady_clock::time_point> last_;
  std::jthread listener_;
};

}  // namespace hapgrid
