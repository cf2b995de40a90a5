#include "tools/play/viewers.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <string>
#include <utility>

#include "libcore/base/file.hpp"
#include "libcore/base/format.hpp"
#include "libcore/base/text.hpp"
#include "tools/common/tool.hpp"

namespace hapgrid {

namespace {

/// What the frames show of the grid's model.
Scene describe_scene(const GridSpec& spec, const Fields& fields, const PlayOptions& options) {
  return {.model = spec.model,
          .length_unit = spec.length_unit,
          .energy_unit = spec.energy_unit,
          .box = spec.box,
          .state_size = spec.state_size,
          .hip_radius = spec.hip_radius,
          .spheres = fields.spheres(),
          .torsions = fields.torsions(),
          .keys = keys_of(*options.device)};
}

/// Energy and shape of a frame.
void complete(const Fields& fields, Frame& frame) {
  if (fields.has_energy()) frame.energy = fields.energy(frame.position, frame.row);
  if (fields.has_own_energy()) frame.own_energy = fields.own_energy(frame.row);
  fields.shape(frame.position, frame.row, frame.centres);
}

/// Real-time safe: the snapshot's vectors have their sizes already.
void fill(Snapshot& snapshot, const Tick& tick, double rate_hz) noexcept {
  snapshot.tick = tick.number;
  snapshot.time_s = static_cast<double>(tick.number) / rate_hz;
  snapshot.hip = tick.hip;
  snapshot.position = tick.traversal.position();
  snapshot.force = tick.force.force;
  snapshot.raw_force = tick.raw_force;
  snapshot.levels = tick.traversal.levels();
  snapshot.jumps = tick.traversal.jumps();
  const auto row = tick.traversal.row();
  std::copy(row.begin(), row.end(), snapshot.row.begin());
}

/// Says which units viewers will take for other ones.
void print_imd_units(const Scene& scene, bool has_energy, int version) {
  const ImdUnits units(version, scene.length_unit, scene.energy_unit);
  const auto print = [](const char* what, const std::string& unit, const char* taken_for) {
    say("play", format("IMD: {} go out in {}, viewers take them for {}", what,
                       unit.empty() ? "a unit without a name" : unit, taken_for));
  };
  if (!units.length_known) print("lengths", scene.length_unit, "angstrom");
  if (has_energy && !units.energy_known)
    print("energies", scene.energy_unit, ImdUnits::energy_name(version));
}

}  // namespace

Viewers::Viewers(const PlayOptions& options) : options_(options), file_(!options.frames.empty()) {
  if (!options.imd_port) return;
  imd_.emplace(options.imd);
  say("play", format("IMD version {} on {}", options.imd.version, imd_->name()));
}

void Viewers::start(const GridSpec& spec, const MakeModel& create, double rate_hz, bool paced,
                    const std::atomic<int>& stop) {
  if (!imd_ && !file_) return;
  rate_hz_ = rate_hz;
  fields_.emplace(spec, create, /*wants_shape=*/true);
  const Scene scene = describe_scene(spec, *fields_, options_);
  FramePublisher::Show show;
  if (imd_) {
    print_imd_units(scene, fields_->has_energy(), options_.imd.version);
    imd_->start(scene, fields_->has_energy(), 1 / rate_hz, paced);
    show = [this](const Frame& frame) { imd_->publish(frame); };
  }
  std::optional<OutputFile> file;
  if (file_) file.emplace(options_.frames, /*binary=*/false);
  publisher_.emplace(
      std::move(file), scene, spec.row_size(), [this](Frame& frame) { complete(*fields_, frame); },
      paced, rate_hz, stop, std::move(show));
}

void Viewers::wait(double seconds, const std::atomic<int>& stop) {
  if (imd_ && seconds > 0 && !imd_->wait_for_viewer(std::chrono::duration<double>(seconds), stop) &&
      stop.load() == 0)
    say("play", format("IMD: no viewer within {:g} s", seconds));
}

void Viewers::show(const Tick& tick) {
  if (!publisher_) return;
  fill(publisher_->next(), tick, rate_hz_);
  publisher_->publish();
}

void Viewers::finish() {
  if (publisher_) counts_ = publisher_->finish();
  // The viewer at the end of a pipe learns now that this was all, and gives the terminal back.
  if (options_.frames == "-") ::dup2(FileDescriptor(::open("/dev/null", O_WRONLY)).get(), 1);
  if (imd_) imd_counts_ = imd_->finish();
}

void Viewers::print_summary() const {
  if (file_)
    say("play", format("frames written {}, dropped {}{}", counts_->written, counts_->dropped,
                       counts_->closed ? "; the viewer closed its end before the last one"
                       : counts_->cut  ? "; the viewer stopped reading, the last one is cut"
                                       : ""));
  if (imd_counts_)
    say("play",
        format("IMD viewers {}, frames sent {}, dropped {}; closed because they did not read {}",
               imd_counts_->viewers, imd_counts_->sent, imd_counts_->dropped, imd_counts_->slow));
}

}  // namespace hapgrid
