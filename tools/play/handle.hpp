// A device in the hand of a person at a terminal, for the bring-up: ticks, and lines that are asked
// for and typed.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "libcore/device/process_device.hpp"
#include "libcore/loop/pacer.hpp"
#include "libcore/loop/safety.hpp"

namespace hapgrid {

/// A signal asks the program to end.
struct Interrupted {};

/// For one thread. Each member throws DeviceError where the device fails, Interrupted after a
/// signal, and Error at the end of standard input; the device has had zero force then.
class Handle {
 public:
  Handle(ProcessDevice& device, double rate_hz);
  /// Stops the device, whatever happened.
  ~Handle() { device_.stop(); }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;

  /// Waits for the next tick, reads, and sends the force through the safety core.
  /// @return whether a line was typed, which is then the answer
  bool tick(const Vec3& wanted);
  /// Takes the force away as softly as the safety core does.
  void fade();
  /// Writes a line for the person, and forgets what was typed before.
  void tell(const std::string& text);
  /// tell(), and shows the place until a line is typed. @return the places in all ticks until then
  std::vector<Vec3> ask(const std::string& text);
  std::vector<Vec3> record(double seconds);

  /// Where the handle is: metres, or its deflection in [-1, 1].
  const Vec3& place() const { return place_; }
  const Vec3& sent() const { return sent_; }
  /// The last line that was typed, in small letters, without blanks around it.
  const std::string& answer() const { return answer_; }
  double rate_hz() const { return rate_hz_; }
  double answers_hz() const;  ///< since the first tick

 private:
  void show() const;
  bool read_line();

  ProcessDevice& device_;
  const double rate_hz_;
  const DeviceInfo info_;
  Clock clock_;
  Pacer pacer_;
  SafetyCore safety_;
  std::optional<std::uint64_t> last_;
  std::uint64_t first_ = 0, answers_ = 0;
  std::int64_t sent_ns_ = 0;
  Vec3 place_{0, 0, 0}, sent_{0, 0, 0};
  bool lost_ = true;  // nobody knows where the handle was
  std::string answer_;
};

}  // namespace hapgrid
