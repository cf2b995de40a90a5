#include "libcore/session/text.hpp"

#include "libcore/base/text.hpp"

namespace hapgrid {

std::string session_text_header() {
  std::string text = "# t\tx\ty\tz\tforce_x\tforce_y\tforce_z\tsent_x\tsent_y\tsent_z";
  for (int i = 0; i < 8; ++i) text += "\tl" + std::to_string(i);
  return text + "\tflags\tlateness_us\tcompute_us\n";
}

void append_session_text(std::string& text, const SessionHeader& header, const TickRecord& tick) {
  const auto append = [&](double value) {
    text += '\t';
    append_digits17(text, value);
  };
  append_digits17(text, header.time_of(tick.number));
  for (const double x : tick.hip) append(x);
  for (const double f : tick.raw_force) append(f);
  for (const double f : tick.force) append(f);
  for (const std::uint8_t level : tick.levels) text += '\t' + std::to_string(level);
  text += '\t' + std::to_string(tick.flags);
  append(tick.lateness_ns / 1e3);
  append(tick.compute_ns / 1e3);
  text += '\n';
}

}  // namespace hapgrid
