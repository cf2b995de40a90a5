// The expand filter: C in 26 directions for each frontier record (procedure expand_state).
#pragma once

#include "libcore/search/converter.hpp"
#include "libcore/search/frontier.hpp"

namespace hapgrid {

/// Evaluates every conversion that `frontier` asks for and gives the requests to
/// out(target, q, source level, row) as they are found, ascending by target.
/// Memory: the frontier records between two slices of the grid, and one batch.
/// @throw ModelError, FormatError, std::system_error; what `out` throws
template <class Sink>
void expand(FrontierReader& frontier, Converter& converter, const GridSpec& spec, Sink&& out) {
  Wavefront wave(spec);
  Wavefront::Slot converted = wave.end();
  const auto emit = [&](PointIndex target, int q, Wavefront::Slot slot, const double* row) {
    out(target, q, wave.level(slot), row);
  };
  FrontierReader::Record record;
  while (frontier.next(record)) {
    wave.add(record.point, record.level, record.state, record.todo);
    if (wave.end() - converted < wave.batch_size()) continue;
    converter.convert(wave, converted, wave.end());
    converted = wave.end();
    wave.drain(wave.settled_before(record.point), emit);
  }
  converter.convert(wave, converted, wave.end());
  wave.drain(spec.box.points(), emit);
}

}  // namespace hapgrid
