#include "tools/play/viewers.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <utility>

#include "libcore/base/file.hpp"
#include "libcore/base/format.hpp"
#include "libcore/base/text.hpp"
#include "tools/common/scene.hpp"
#include "tools/common/tool.hpp"

namespace hapgrid {

namespace {

/// Energy and shape of a frame.
void complete(const Fields& fields, Frame& frame) {
  if (fields.has_energy()) frame.energy = fields.energy(frame.position, frame.row);
  if (fields.has_own_energy()) frame.own_energy = fields.own_energy(frame.row);
  fields.shape(frame.position, frame.row, frame.centres);
}

/// Real-time safe: the frame's vectors have their sizes already.
void fill(Frame& frame, const Tick& tick, double rate_hz) noexcept {
  frame.tick = tick.number;
  frame.time_s = static_cast<double>(tick.number) / rate_hz;
  frame.hip = tick.hip;
  frame.hand = tick.hand;
  frame.position = tick.traversal.position();
  frame.force = tick.force.force;
  frame.jumps = tick.traversal.jumps();
  const auto row = tick.traversal.row();
  std::copy(row.begin(), row.end(), frame.row.begin());
}

}  // namespace

/// What the slow thread uses.
struct Viewers::Slow {
  Slow(const GridSpec& of, const MakeModel& create)
      : spec(of), fields(spec, create, /*wants_shape=*/true) {}

  const GridSpec spec;
  Fields fields;
  std::optional<FramePublisher> publisher;
};

Viewers::Viewers(std::string frames, const std::string& keys, const GridSpec& spec,
                 const MakeModel& create, double rate_hz, bool paced, const std::atomic<int>& stop,
                 double largest_force)
    : name_(std::move(frames)), rate_hz_(rate_hz) {
  if (name_.empty()) return;
  slow_ = std::make_unique<Slow>(spec, create);
  Scene scene = scene_of(spec, slow_->fields);
  scene.keys = keys;
  scene.largest_force = largest_force;
  slow_->publisher.emplace(
      OutputFile(name_, /*binary=*/false), scene, spec.row_size(),
      [&fields = slow_->fields](Frame& frame) { complete(fields, frame); }, paced, rate_hz, stop);
}

Viewers::~Viewers() = default;

void Viewers::show(const Tick& tick) {
  if (!slow_) return;
  fill(slow_->publisher->next(), tick, rate_hz_);
  slow_->publisher->publish();
}

void Viewers::finish() {
  if (slow_) counts_ = slow_->publisher->finish();
  if (counts_ && counts_->lacking) static_cast<void>(slow_.release());  // its thread still runs
  // The viewer at the end of a pipe learns now that this was all, and gives the terminal back.
  if (name_ == "-") ::dup2(FileDescriptor(::open("/dev/null", O_WRONLY)).get(), 1);
}

void Viewers::print_summary() const {
  if (counts_)
    say("play", format("frames written {}, dropped {}{}", counts_->written, counts_->dropped,
                       counts_->closed    ? "; the viewer closed its end before the last one"
                       : counts_->cut     ? "; the viewer stopped reading, the last one is cut"
                       : counts_->lacking ? "; the model did not give the shape of the last one"
                                          : ""));
}

}  // namespace hapgrid
