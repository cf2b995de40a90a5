#include "tools/stats/session.hpp"

#include <nlohmann/json.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "libcore/base/error.hpp"
#include "libcore/base/text.hpp"
#include "libcore/session/reader.hpp"
#include "libcore/session/statistics.hpp"
#include "libcore/session/text.hpp"
#include "tools/stats/arrays.hpp"
#include "tools/stats/gnuplot.hpp"
#include "tools/stats/session_picture.hpp"
#include "tools/stats/session_report.hpp"

namespace hapgrid {

namespace {

/// Calls `use` on the ticks from seconds `from` up to `to`, a chunk at a time.
template <class F>
void for_ticks(SessionReader& session, double from, double to, F&& use) {
  session.seek(session.tick_at(from));
  const SessionHeader& header = session.header();
  for (std::vector<TickRecord> ticks; session.next(ticks);)
    for (const TickRecord& tick : ticks) {
      if (header.time_of(tick.number) >= to) return;
      use(tick);
    }
}

class Export {
 public:
  explicit Export(const std::string& name)
      : output_(name, /*binary=*/false), text_(session_text_header()) {}

  void add(const SessionHeader& header, const TickRecord& tick) {
    append_session_text(text_, header, tick);
    if (text_.size() >= kBuffer) flush();
  }
  void commit() {
    flush();
    output_.commit();
  }

 private:
  static constexpr std::size_t kBuffer = 1 << 18;

  void flush() {
    output_.write(text_);
    text_.clear();
  }

  OutputFile output_;
  std::string text_;
};

}  // namespace

void run_session(InputFile file, const SessionOptions& options) {
  SessionReader session(std::move(file), options.salvage ? SessionReader::Damage::kSalvaged
                                                         : SessionReader::Damage::kRefused);
  const SessionHeader& header = session.header();
  if (session.ticks() == 0) throw Error(session.name() + ": a session without a tick");

  std::optional<Export> text;
  if (!options.export_file.empty()) text.emplace(options.export_file);
  SessionStatistics statistics;
  HandEnergy energy(header);
  for_ticks(session, options.from, options.to, [&](const TickRecord& tick) {
    statistics.add(tick);
    energy.add(tick);
    if (text) text->add(header, tick);
  });
  if (statistics.ticks == 0)
    throw Error(session.name() + ": no tick from --from to --to: it goes from " +
                to_text(header.time_of(session.first_tick())) + " s to " +
                to_text(header.time_of(session.last_tick())) + " s");
  if (text) text->commit();
  if (!options.png.empty()) {
    // Again from the beginning: what the columns are is known now.
    SessionCurves curves(header, statistics.first, statistics.last, energy_unit(header));
    for_ticks(session, options.from, options.to, [&](const TickRecord& tick) { curves.add(tick); });
    OutputFile png(options.png);
    run_gnuplot(
        curves.script(std::to_string(statistics.ticks) + " ticks at " + rounded(header.rate_hz) +
                      " Hz, " + std::to_string(statistics.skipped) + " missed" +
                      (session.dropped() > 0 ? " or dropped" : "")),
        png);
    png.commit();
  }
  if (!options.npz.empty())
    write_session_arrays(
        header, statistics.ticks,
        [&](const auto& use) { for_ticks(session, options.from, options.to, use); }, options.npz);
  if (text || !options.png.empty() || !options.npz.empty()) return;

  OutputFile output(options.output, /*binary=*/false);
  if (options.format == "text")
    output.write(printable_text(session_text(session, statistics, energy)));
  else  // "replace": a session's strings need not be UTF-8
    output.write(
        session_json(session, statistics, energy)
            .dump(2, ' ', /*ensure_ascii=*/true, nlohmann::ordered_json::error_handler_t::replace) +
        "\n");
  output.commit();
}

}  // namespace hapgrid
