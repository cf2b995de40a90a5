// A device and the hand that holds it, simulated in virtual time: a closed loop whose every run
// gives the same bits.
//
// On each axis the handle is a mass m between the device's force F and the hand, which is a spring
// and a damper to a point X that moves by itself:
//
//   m x'' = F + k (X - x) + b (X' - x')
//
// F is the force that was sent, and it holds for a tick. X moves straight from one tick's target to
// the next one's. So each tick has an exact solution, whatever the stiffness and however long the
// tick, and it is one small matrix product. The matrix is a series of sums and products: no
// function of the mathematical library, whose last bit differs between machines, is used.
//
// Nothing here is real-time safe: nobody waits for a simulated device.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "libcore/device/device.hpp"
#include "libcore/grid/vec3.hpp"

namespace hapgrid {

struct SimulatedOptions {
  double mass = 0.1;          ///< m of the handle, kg; > 0
  double stiffness = 300;     ///< k of the hand, N/m; 0: the handle is free
  double hand_damping = 1.5;  ///< b of the hand, N s/m
  double encoder = 5.5e-5;    ///< positions are rounded to such steps, m; 0: not at all
  std::uint32_t delay = 0;    ///< ticks from when a force is sent until it is in effect
  double reach = 0.1;         ///< side of the cube around 0 that the handle reaches, m
  double rate_hz = 1000;      ///< ticks a second
  std::uint64_t sessions = 1;
};

struct WanderingOptions {
  std::uint64_t seed = 1;
  double seconds = 5;  ///< of a session
  double speed = 0.1;  ///< the fastest leg's mean speed, in the unit of the box a second
  double hold = 1.5;   ///< seconds of a rest
  double rate_hz = 1000;
};

/// The positions of session `session`, one for each tick. The seed and the session alone decide
/// them.
///
/// The hand begins at a random point of the box from `low` to `high`, each as likely as any other.
/// With a probability of one half it rests there for `hold`. Then it goes straight to another such
/// point, as hands do: s(t) = 10 t^3 - 15 t^4 + 6 t^5 of the way, with t from 0 to 1 (least jerk;
/// Flash and Hogan 1985). The leg's mean speed is drawn from a quarter of `speed` to `speed`. At
/// the end of the leg the hand may rest again, and so on.
void wander(const WanderingOptions& options, const Vec3& low, const Vec3& high,
            std::uint64_t session, std::vector<Vec3>& places);

class SimulatedDevice : public Device {
 public:
  /// Sets the vector to the hand's point X, in metres, at each tick of a session, at least one.
  using Targets = std::function<void(std::uint64_t session, std::vector<Vec3>& targets)>;

  SimulatedDevice(const SimulatedOptions& options, Targets targets);

  /// The answer of info(), which the options alone decide.
  static DeviceInfo info(const SimulatedOptions& options);

  DeviceInfo info() const override { return info(options_); }
  /// A tick later; each session begins with DeviceInput::begins, at rest in its first target. kEnd
  /// after the last session.
  DeviceStatus read(DeviceInput& input) noexcept override;
  DeviceStatus send(const Vec3& force) noexcept override;
  DeviceStatus stop() noexcept override { return DeviceStatus::kOk; }
  std::string error() const override { return "a simulated device does not fail"; }

  // The state of the simulation at the tick that was read last.

  /// The number of the session, from 0.
  std::uint64_t session() const { return session_; }
  /// Where the handle is, in metres, before the encoder rounds it.
  const Vec3& position() const { return x_; }
  /// The hand's point X, in metres.
  const Vec3& target() const { return targets_[at_]; }
  /// What the device's force, as it was in effect, has done on the hand since the session began, in
  /// joules; exact.
  double work() const { return work_; }

 private:
  void begin();
  void advance();
  /// Moves the handle on one axis by a tick: its position x and speed v.
  /// @param force of the device, in newtons. @param from, to of the hand's point X, in metres.
  void advance(double& x, double& v, double force, double from, double to) const noexcept;

  SimulatedOptions options_;
  // (u, w, a) -> u and w a tick later; u = x - X, w = v - X', a the constant acceleration.
  std::array<std::array<double, 3>, 2> step_;
  Targets source_;
  std::vector<Vec3> targets_;
  std::uint64_t session_ = 0;
  std::size_t at_ = 0;  // the tick in targets_
  bool started_ = false;
  Vec3 x_{0, 0, 0};
  Vec3 v_{0, 0, 0};
  double work_ = 0;
  std::vector<Vec3> sent_;  // the last delay + 1 forces, a ring
  std::size_t newest_ = 0;
};

}  // namespace hapgrid
