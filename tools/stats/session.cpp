#include "tools/stats/session.hpp"

#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "libcore/base/error.hpp"
#include "libcore/base/json_text.hpp"
#include "libcore/base/text.hpp"
#include "libcore/session/reader.hpp"
#include "libcore/session/statistics.hpp"
#include "libcore/session/text.hpp"
#include "tools/stats/arrays.hpp"
#include "tools/stats/session_report.hpp"

namespace hapgrid {

namespace {

/// Calls `use` on all ticks, from the first on.
template <class F>
void for_ticks(SessionReader& session, F&& use) {
  session.rewind();
  for (std::vector<TickRecord> ticks; session.next(ticks);)
    for (const TickRecord& tick : ticks) use(tick);
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
  SessionReader session(std::move(file));
  const SessionHeader& header = session.header();
  std::optional<Export> text;
  if (!options.export_file.empty()) text.emplace(options.export_file);
  SessionStatistics statistics;
  HandEnergy energy(header);
  for_ticks(session, [&](const TickRecord& tick) {
    statistics.add(tick);
    energy.add(tick);
    if (text) text->add(header, tick);
  });
  if (statistics.ticks == 0) throw Error(without_ticks(session));
  if (text) text->commit();
  if (!options.npy.empty())
    write_session_array(
        header, statistics.ticks, [&](const auto& use) { for_ticks(session, use); }, options.npy);
  if (text || !options.npy.empty()) {
    // The report has a line on it.
    if (!session.ended_early().empty())
      std::fprintf(stderr, "stats: %s: the session ended early, at %s\n",
                   printable_line(session.name()).c_str(), session.ended_early().c_str());
    return;
  }

  OutputFile output(options.output, /*binary=*/false);
  if (options.format == "text")
    output.write(printable_text(session_text(session, statistics, energy)));
  else
    output.write(json_text(session_json(session, statistics, energy)));
  output.commit();
}

}  // namespace hapgrid
