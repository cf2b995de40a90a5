// The model itself, which follows the hand beside the grid and says in which state it really is,
// and with which force it pushes there.
//
// Problem. Where branches end or meet inside a cell, the grid guesses on which of them the hand is.
// A wrong guess lasts until the hand happens to come back to a place where there is one branch. And
// where points are far apart, no branch of the cell may be near to the model's state. The model
// knows better: one conversion for the way of a tick takes microseconds for many models. But
// it can take a hundred times as long now and then, and a tick of the haptic loop cannot wait.
//
// Choice. For a live hand a thread of its own makes the conversions. The loop passes it each place
// of the hand through a ring, and takes the newest answer from a triple buffer; neither waits for
// the other. When nobody waits, as in the play of a path, the model is asked in the tick itself,
// and its answer counts a number of ticks later: so the same input always gives the same output. In
// both ways a tick takes the newest answer first, and tells its own place at its end.
//
// Answers come late by some ticks, in which the hand has gone on. So the model is also asked in
// which state it will be when the answer comes, if the hand goes on as it did in as many ticks
// before. A hand of 0.1 kg does not turn within a few milliseconds.
#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include "libcore/base/histogram.hpp"
#include "libcore/base/spsc_ring.hpp"
#include "libcore/base/triple_buffer.hpp"
#include "libcore/follow/model_traversal.hpp"
#include "libcore/model/fields.hpp"

namespace hapgrid {

/// For one hand. receive(), answer(), start() and follow() are called by one thread, in this order
/// in each tick; they never wait for the other thread, and are real-time safe when there is one.
class Beside {
 public:
  /// Steps for each grid spacing, as in ModelTraversal, so that both come to the same states. Near
  /// the end of a branch, the length of the steps can decide on which other one a large molecule
  /// ends.
  static constexpr double kStepsACell = 32;

  /// @param grid outlives this. @param model of this grid
  /// @param delay_ticks the model is asked in the tick, and its answer is given so many ticks
  /// later, at least 1; nothing: it is asked by another thread
  /// @param tell_failure is told why a model process fails. It is then not asked any more. Called
  /// by the thread that asks.
  /// @throw Error as Traversal does
  Beside(const Grid& grid, std::unique_ptr<Model> model, std::optional<std::uint32_t> delay_ticks,
         std::function<void(const std::string&)> tell_failure = {});
  /// Does not wait for a process that thinks, but for a plug-in.
  ~Beside();
  /// Ends the thread. @return whether it has ended. A plug-in that never returns keeps it for ever:
  /// then only the end of the program helps.
  bool end_within(std::chrono::milliseconds patience) noexcept;
  Beside(const Beside&) = delete;
  Beside& operator=(const Beside&) = delete;

  /// Starts the thread, if there is to be one, before the first tick. @param rate_hz ticks a second
  void begin(double rate_hz);

  /// Ends a tick in which the hand is at x: in the state that has this level at the nearest grid
  /// point, or in the one to which the model comes along the way.
  void start(const Vec3& x, Level level = 0) noexcept { tell(x, level); }
  void follow(const Vec3& x) noexcept { tell(x, std::nullopt); }
  /// Takes the newest answer, at the beginning of a tick.
  void receive() noexcept;
  /// The newest answer since the last start; null where there is none.
  const BesideAnswer* answer() const noexcept { return newest_; }
  /// Counts the ticks that have ended.
  std::uint64_t tick() const { return tick_; }

  /// How far apart two states are that differ by 1 in one component, in the unit of the tolerance.
  /// The components of a state can be of different kinds: angles beside places. Their weights are
  /// those of the model's tolerance function, in the mean over some records.
  const std::vector<double>& weights() const { return weights_; }

  /// Whether another thread asks the model.
  bool has_thread() const { return !delay_; }
  /// In how many ticks there was an answer.
  std::uint64_t kept_up() const { return ticks_kept_up_; }
  /// How many ticks old the answers were, of all ticks in which there was one.
  const Histogram& lateness() const { return lateness_; }

 private:
  struct Place {
    std::uint64_t tick = 0;
    Vec3 x{0, 0, 0};
    Vec3 ahead{0, 0, 0};            // where the hand will be when the answer comes
    std::optional<Level> begins{};  // with this level
  };
  void tell(const Vec3& x, std::optional<Level> begins) noexcept;
  Vec3 look_ahead(const Vec3& x) noexcept;
  void ask(const Place& place, BesideAnswer& answer) noexcept;
  void work(const std::stop_token& token) noexcept;
  void ask_all(std::span<const Place> places, const std::stop_token& token) noexcept;

  const std::vector<double> weights_;
  const bool is_process_;
  const Fields fields_;   // of the model, asked where that is asked
  ModelTraversal model_;  // the other thread's, if there is one
  const std::optional<std::uint32_t> delay_;
  const Box box_;
  const double near_;   // places nearer than this are passed over by a thread that is late
  double pause_s_ = 0;  // of the thread, when it has nothing to do
  const std::function<void(const std::string&)> tell_failure_;
  std::atomic<bool> ends_{false}, is_working_{false};
  bool has_given_up_ = false;  // a process that failed, which can take its time for it

  std::uint64_t tick_ = 0;
  std::uint64_t first_tick_ = 0;                       // since the last start
  static constexpr std::uint64_t kFarthestAhead = 32;  // ticks
  std::array<Vec3, kFarthestAhead> last_places_{};     // a ring
  const BesideAnswer* newest_ = nullptr;               // that is usable
  std::optional<Level> must_begin_;                    // the ring was full at the last start
  std::uint64_t ticks_kept_up_ = 0;
  Histogram lateness_;

  std::vector<BesideAnswer> held_back_;  // without a thread: of the last ticks, a ring
  SpscRing<Place> places_;
  TripleBuffer<BesideAnswer> answers_;
  std::jthread thread_;  // the last member: it ends before what it uses
};

}  // namespace hapgrid
