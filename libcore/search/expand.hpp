// The expand filter: C in 26 directions for each frontier record (procedure expand_state).
#pragma once

#include "libcore/search/converter.hpp"
#include "libcore/search/frontier.hpp"

namespace hapgrid {

/// Evaluates every conversion of the records that next(FrontierRecord&) gives until it answers
/// false, and gives what was reached to out(point, level, directions, rows), record by record in
/// the same order: `rows` has room for 26 rows, of which those of the `directions` are set. Memory:
/// one batch.
/// @throw ModelError; what `next` and `out` throw
template <class Next, class Sink>
void expand(Next&& next, Converter& converter, const GridSpec& spec, Sink&& out) {
  Batch batch(spec);
  FrontierRecord record;
  for (bool more = true; more;) {
    while (!batch.is_full() && (more = next(record)))
      batch.add(record.point, record.level, record.state, record.todo);
    converter.convert(batch);
    for (std::size_t i = 0; i < batch.size(); ++i)
      out(batch.point(i), batch.level(i), batch.todo(i), batch.reached(i));
    batch.clear();
  }
}

}  // namespace hapgrid
