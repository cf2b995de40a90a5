// The expand filter: C in 26 directions for each frontier record (procedure expand_state).
#pragma once

#include "libcore/search/converter.hpp"
#include "libcore/search/frontier.hpp"

namespace hapgrid {

/// Evaluates every conversion that `frontier` asks for and gives what was reached to
/// out(point, level, directions, rows), record by record, ascending: `rows` has room for 26 rows,
/// of which those of the `directions` are set. Memory: one batch.
/// @throw ModelError, FormatError, std::system_error; what `out` throws
template <class Sink>
void expand(FrontierReader& frontier, Converter& converter, const GridSpec& spec, Sink&& out) {
  Batch batch(spec);
  const auto finish_batch = [&] {
    converter.convert(batch);
    for (std::size_t i = 0; i < batch.size(); ++i)
      out(batch.point(i), batch.level(i), batch.todo(i), batch.reached(i));
    batch.clear();
  };
  FrontierReader::Record record;
  while (frontier.next(record)) {
    batch.add(record.point, record.level, record.state, record.todo);
    if (batch.is_full()) finish_batch();
  }
  finish_batch();
}

}  // namespace hapgrid
