#include "tools/check-model/together.hpp"

#include <array>
#include <chrono>
#include <string_view>
#include <thread>

#include "libcore/base/format.hpp"
#include "libcore/grid/describe.hpp"
#include "libcore/search/converter.hpp"

namespace hapgrid {

namespace {

using Clock = std::chrono::steady_clock;

constexpr const char* kMeanwhile =
    " while two threads asked two models: they share data, which a plug-in must not have. "
    "hapgrid rounds --parts N gives each model a process of its own";

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

}  // namespace

Findings ask_together(
    Model& one, Model& other, std::span<const Made> made, double seconds,
    const std::function<bool(std::span<const double>, std::span<const double>)>& is_same,
    const std::function<std::string(const Made&)>& text_of) {
  const auto end = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                      std::chrono::duration<double>(seconds));
  std::array<Told, 2> told;
  {
    const std::jthread thread([&] { told[1] = ask(other, made, end); });
    told[0] = ask(one, made, end);
  }
  Findings found;
  for (const Told& t : told)
    for (std::size_t k = 0; k < t.rows.size(); ++k) {
      ++found.counted;
      if (t.errors[k].empty() && is_same(made[k].row, t.rows[k])) continue;
      found.offend([&] {
        const std::size_t n = made[k].from.size();
        const std::string what =
            t.errors[k].empty()
                ? format("alone {}, together {}", state_text(std::span(made[k].row).first(n)),
                         state_text(std::span(t.rows[k]).first(n)))
                : t.errors[k];
        return text_of(made[k]) + ": " + what;
      });
    }
  return found;
}

}  // namespace hapgrid
