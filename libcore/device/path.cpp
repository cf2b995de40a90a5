#include "libcore/device/path.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <system_error>

#include "libcore/base/error.hpp"
#include "libcore/base/file.hpp"
#include "libcore/base/format.hpp"
#include "libcore/base/text.hpp"

namespace hapgrid {

namespace {

constexpr std::string_view kBlanks = " \t\r";  // '\r' ends lines in files of other systems
constexpr std::uint64_t kMaxBytes = std::uint64_t{1} << 30;

/// Removes the next word from the line. @return the word, empty at the end of the line
std::string_view next_word(std::string_view& line) {
  line.remove_prefix(std::min(line.find_first_not_of(kBlanks), line.size()));
  const std::string_view word = line.substr(0, line.find_first_of(kBlanks));
  line.remove_prefix(word.size());
  return word;
}

/// Reads one coordinate. @return what is wrong with it, empty when nothing is
std::string_view parse_coordinate(std::string_view word, double& value) {
  // from_chars knows no plus sign.
  if (word.size() > 1 && word[0] == '+' && word[1] != '-') word.remove_prefix(1);
  const char* const end = word.data() + word.size();
  const auto [rest, error] = std::from_chars(word.data(), end, value);
  if (error == std::errc::result_out_of_range) return "is beyond double precision";
  if (error != std::errc() || rest != end) return "is not a number";
  if (!std::isfinite(value)) return "is not finite";
  return {};
}

/// What a line of a path has; nothing if it has only blanks and a comment.
/// @throw Error that says what is wrong with the line.
std::optional<DeviceInput> parse_tick(std::string_view line) {
  line = line.substr(0, line.find('#'));
  DeviceInput tick;
  int count = 0;
  for (std::string_view word; !(word = next_word(line)).empty(); ++count) {
    if (count == 3 && word == "next" && next_word(line).empty()) {
      tick.next = true;
      break;
    }
    if (count == 3) throw Error("more than the 3 numbers x y z");
    const std::string_view wrong = parse_coordinate(word, tick.position[count]);
    if (!wrong.empty()) throw Error(format("'{}' {}", printable_line(word, 40), wrong));
  }
  if (count == 0) return std::nullopt;
  if (count != 3) throw Error(format("the 3 numbers x y z are needed, found {}", count));
  return tick;
}

}  // namespace

std::vector<DeviceInput> parse_path(std::string_view text, const std::string& name) {
  std::vector<DeviceInput> ticks;
  for (std::size_t number = 1; !text.empty(); ++number) {
    const std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(line.size() + 1, text.size()));
    try {
      if (const auto tick = parse_tick(line)) ticks.push_back(*tick);
    } catch (const Error& e) {
      throw Error(format("{}: line {}: {}", name, number, e.what()));
    }
  }
  if (ticks.empty()) throw Error(format("{}: no position in it", name));
  return ticks;
}

std::vector<DeviceInput> read_path(const std::string& file) {
  return parse_path(read_text(file, kMaxBytes), file == "-" ? "standard input" : file);
}

DeviceStatus ReplayDevice::read(DeviceInput& input) noexcept {
  if (next_ == ticks_.size()) return DeviceStatus::kEnd;
  input = ticks_[next_++];
  return DeviceStatus::kOk;
}

DeviceStatus ReplayDevice::send(const Vec3& force) noexcept {
  force_ = force;
  return DeviceStatus::kOk;
}

}  // namespace hapgrid
