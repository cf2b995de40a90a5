#include "tools/check-model/together.hpp"

#include <chrono>
#include <functional>
#include <future>
#include <string_view>

#include "libcore/base/format.hpp"
#include "libcore/grid/describe.hpp"
#include "libcore/search/converter.hpp"

namespace hapgrid {

namespace {

using Clock = std::chrono::steady_clock;

constexpr const char* kMeanwhile =
    " while two threads asked two models: they share data, which a plug-in must not have. "
    "With info.processes = 1 one thread asks one model, and hapgrid rounds --parts N gives each a "
    "process of its own";

/// What one thread was told.
struct Told {
  std::vector<std::vector<double>> rows;
  std::vector<std::string> errors;
};

Told ask(Model& model, std::span<const Made> made, Clock::time_point end) {
  Told told;
  told.rows.resize(made.size());
  told.errors.resize(made.size());
  std::size_t next = 0;
  model.convert_all(
      [&](Conversion& conversion, bool) {
        if (next == made.size() || Clock::now() > end) return false;
        const Made& m = made[next];
        told.rows[next].resize(m.row.size());
        current_conversion() = {m.point, 0, m.q, kMeanwhile};
        conversion = {m.from.data(), m.x, m.d, told.rows[next].data(), next};
        ++next;
        return true;
      },
      [&](const Conversion& conversion, std::string_view error) {
        told.errors[conversion.tag] = error;
      });
  current_conversion() = {};
  told.rows.resize(next);
  return told;
}

void compare(const Told& told, std::span<const Made> made, const char* otherwise,
             const Difference& difference, const std::function<std::string(const Made&)>& text_of,
             Findings& found) {
  for (std::size_t k = 0; k < told.rows.size(); ++k) {
    ++found.counted;
    const Made& m = made[k];
    const std::string differs = told.errors[k].empty() ? difference(m, told.rows[k]) : "";
    if (told.errors[k].empty() && differs.empty()) continue;
    found.offend([&] {
      const std::size_t n = m.from.size();
      const std::string what =
          told.errors[k].empty()
              ? format("alone {}, {} {}{}", state_text(std::span(m.row).first(n)), otherwise,
                       state_text(std::span(told.rows[k]).first(n)), differs)
              : told.errors[k];
      return text_of(m) + ": " + what;
    });
  }
}

Clock::time_point in_seconds(double seconds) {
  return Clock::now() +
         std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
}

}  // namespace

Findings ask_at_a_time(Model& model, std::span<const Made> made, double seconds,
                       const Difference& difference,
                       const std::function<std::string(const Made&)>& text_of) {
  Findings found;
  compare(ask(model, made, in_seconds(seconds)), made, "among others", difference, text_of, found);
  return found;
}

Findings ask_together(Model& one, Model& other, std::span<const Made> made, double seconds,
                      const Difference& difference,
                      const std::function<std::string(const Made&)>& text_of) {
  const auto end = in_seconds(seconds);
  std::future<Told> others = std::async(std::launch::async, ask, std::ref(other), made, end);
  const Told told = ask(one, made, end);
  Findings found;
  for (const Told& t : {told, others.get()})
    compare(t, made, "together", difference, text_of, found);
  return found;
}

}  // namespace hapgrid
