#include "libcore/search/expand.hpp"

namespace hapgrid {

void expand(FrontierReader& frontier, Converter& converter, const GridSpec& spec,
            const RequestSink& out) {
  Wavefront wave(spec);
  Wavefront::Slot converted = wave.end();
  const auto emit = [&out, &wave](PointIndex target, int q, Wavefront::Slot slot,
                                  const double* row) { out(target, q, wave.level(slot), row); };
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
