#include "tools/devices/profile.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>

#include "libcore/base/error.hpp"
#include "libcore/base/format.hpp"
#include "libcore/base/text.hpp"
#include "libcore/base/toml.hpp"
#include "tools/devices/hid_handle.hpp"

namespace hapgrid {

namespace {

// Limits of what devices have and hands should feel; larger numbers are mistakes.
constexpr double kMaxMetres = 100;
constexpr double kMaxNewtons = 1000;
constexpr std::int64_t kMaxLength = static_cast<std::int64_t>(kMaxHidReport) - 1;
constexpr std::size_t kMaxReports = 32;
constexpr double kOrthogonal = 1e-3;  // tolerance for numbers written with four digits

constexpr const char* kAxes[] = {"x", "y", "z"};

class Reader : private TomlFile {
 public:
  using TomlFile::TomlFile;

  Profile read(const std::string& name) const {
    Profile p;
    p.file = name;
    only_keys(root(), "",
              {"name", "match", "input", "output", "force", "reports", "timing", "workspace"});
    p.name = printable_line(text(required(root(), "", "name"), "name"));
    match(table(root(), "match"), p.match);
    input(table(root(), "input"), p);
    if (root().contains("output")) outputs(p);
    if (root().contains("reports")) reports(table(root(), "reports"), p);
    if (root().contains("timing")) timing(table(root(), "timing"), p.timing);
    if (!p.keep_alive.empty() && p.timing.keep_alive <= 0)
      fail(*root().get("reports"), "reports.keep_alive needs a timing.keep_alive_ms");
    workspace(table(root(), "workspace"), p);
    return p;
  }

 private:
  std::optional<std::uint16_t> number16(const toml::table& in, const std::string& prefix,
                                        const char* key) const {
    const toml::node* node = in.get(key);
    if (!node) return std::nullopt;
    return static_cast<std::uint16_t>(whole(*node, prefix + key, 0, 0xffff));
  }

  bool flag(const toml::table& in, const std::string& prefix, const char* key, bool usual) const {
    const toml::node* node = in.get(key);
    return node ? boolean(*node, prefix + key) : usual;
  }

  double bounded(const toml::node& node, const std::string& key, double least, double most) const {
    const double value = number(node, key);
    if (value < least || value > most)
      fail(node, format("{} must be from {} to {}, not {}", key, to_text(least), to_text(most),
                        to_text(value)));
    return value;
  }

  /// A number of either sign, but not zero.
  double factor(const toml::table& in, const std::string& prefix, const char* key, double least,
                double most) const {
    const toml::node& node = required(in, prefix, key);
    const double value = number(node, prefix + key);
    if (std::abs(value) < least || std::abs(value) > most)
      fail(node, format("{}{} must have a magnitude from {} to {}, not {}", prefix, key,
                        to_text(least), to_text(most), to_text(value)));
    return value;
  }

  void match(const toml::table& in, HidMatch& match) const {
    only_keys(in, "match.", {"vid", "pid", "interface", "usage_page", "usage", "serial"});
    required(in, "match.", "vid");
    required(in, "match.", "pid");
    match.vid = number16(in, "match.", "vid");
    match.pid = number16(in, "match.", "pid");
    match.usage_page = number16(in, "match.", "usage_page");
    match.usage = number16(in, "match.", "usage");
    if (const toml::node* node = in.get("interface"))
      match.interface = static_cast<int>(whole(*node, "match.interface", -1, 255));
    if (const toml::node* node = in.get("serial")) match.serial = text(*node, "match.serial");
  }

  std::uint8_t report_id(const toml::table& in, const std::string& prefix) const {
    const toml::node* node = in.get("id");
    return node ? static_cast<std::uint8_t>(whole(*node, prefix + "id", 0, 255)) : 0;
  }

  std::size_t length(const toml::table& in, const std::string& prefix) const {
    return static_cast<std::size_t>(
        whole(required(in, prefix, "length"), prefix + "length", 1, kMaxLength));
  }

  /// The place of a value. The caller has checked the keys.
  BitField field(const toml::table& in, const std::string& prefix, std::size_t report_length,
                 bool is_bit) const {
    BitField f;
    f.is_signed = !is_bit && flag(in, prefix, "signed", true);
    const auto room = static_cast<std::int64_t>(8 * report_length);
    const toml::node& bit = required(in, prefix, "bit");
    f.bit = static_cast<std::size_t>(whole(bit, prefix + "bit", 0, room - 1));
    f.bits =
        is_bit ? 1
               : static_cast<unsigned>(whole(required(in, prefix, "bits"), prefix + "bits", 2, 32));
    if (const toml::node* node = in.get("endian")) {
      const std::string endian = text(*node, prefix + "endian");
      if (endian != "little" && endian != "big")
        fail(*node, prefix + "endian is \"little\" or \"big\"");
      f.big_endian = endian == "big";
      if (f.big_endian && (f.bit % 8 != 0 || f.bits % 8 != 0))
        fail(*node, prefix + "endian = \"big\" needs whole bytes");
    }
    if (f.bit + f.bits > 8 * report_length)
      fail(bit, format("{}bit: the field ends behind the report, which has {} bits", prefix, room));
    return f;
  }

  /// Three rows that keep lengths, so that a newton stays one.
  Matrix3 axes(const toml::table* in, const std::string& prefix) const {
    Matrix3 m{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
    const toml::node* node = in ? in->get("axes") : nullptr;
    if (!node) return m;
    const std::string key = prefix + "axes";
    const toml::array& rows = array(*node, key);
    if (rows.size() != 3) fail(rows, key + " has three rows of three numbers");
    for (std::size_t i = 0; i < 3; ++i) {
      const std::vector<double> row = numbers(*rows.get(i), key);
      if (row.size() != 3) fail(rows, key + " has three rows of three numbers");
      m[i] = {row[0], row[1], row[2]};
    }
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t k = 0; k < 3; ++k) {
        const double dot = m[i][0] * m[k][0] + m[i][1] * m[k][1] + m[i][2] * m[k][2];
        if (!(std::abs(dot - (i == k ? 1 : 0)) <= kOrthogonal))
          fail(rows, key + " may exchange, mirror and turn axes, not scale or skew them");
      }
    return m;
  }

  void input(const toml::table& in, Profile& p) const {
    only_keys(in, "input.", {"id", "length", "axes", "x", "y", "z", "clutch", "next"});
    p.input_id = report_id(in, "input.");
    p.input_length = length(in, "input.");
    p.input_axes = axes(&in, "input.");
    for (std::size_t a = 0; a < 3; ++a) {
      if (!in.contains(kAxes[a])) continue;
      const std::string prefix = std::string("input.") + kAxes[a] + ".";
      const toml::table& t = table(in, kAxes[a]);
      only_keys(t, prefix, {"bit", "bits", "signed", "endian", "scale", "offset"});
      Profile::InputAxis axis{.field = field(t, prefix, p.input_length, false)};
      axis.scale = factor(t, prefix, "scale", 1e-12, 1);
      if (const toml::node* node = t.get("offset"))
        axis.offset = bounded(*node, prefix + "offset", -kMaxMetres, kMaxMetres);
      p.inputs[a] = axis;
    }
    if (!p.inputs[0] && !p.inputs[1] && !p.inputs[2])
      fail(in, "input has none of the axes x, y, z");
    p.clutch = button(in, "clutch", p);
    p.next = button(in, "next", p);
  }

  std::optional<Profile::Button> button(const toml::table& in, const std::string& key,
                                        const Profile& p) const {
    if (!in.contains(key)) return std::nullopt;
    const std::string prefix = "input." + key + ".";
    const toml::table& t = table(in, key);
    only_keys(t, prefix, {"bit", "inverted"});
    return Profile::Button{.field = field(t, prefix, p.input_length, true),
                           .inverted = flag(t, prefix, "inverted", false)};
  }

  void outputs(Profile& p) const {
    const toml::table& force = table(root(), "force");
    only_keys(force, "force.", {"max", "axes"});
    p.max_force = bounded(required(force, "force.", "max"), "force.max", 1e-6, kMaxNewtons);
    p.force_axes = axes(&force, "force.");
    const toml::array& list = array(*root().get("output"), "output");
    if (list.empty() || list.size() > kMaxReports)
      fail(list, format("output has 1 to {} reports", kMaxReports));
    std::array<bool, 3> seen{};
    for (std::size_t i = 0; i < list.size(); ++i) {
      const std::string prefix = list.size() == 1 ? "output." : format("output {}: ", i + 1);
      if (!list.get(i)->is_table()) fail(list, "output must be written [[output]]");
      p.outputs.push_back(output(*list.get(i)->as_table(), prefix, p));
      for (std::size_t a = 0; a < 3; ++a) {
        if (!p.outputs.back().axes[a]) continue;
        if (seen[a]) fail(*list.get(i), prefix + kAxes[a] + " is in another output, too");
        seen[a] = true;
      }
    }
    if (!seen[0] && !seen[1] && !seen[2]) fail(list, "output has none of the axes x, y, z");
  }

  Profile::Output output(const toml::table& in, const std::string& prefix, const Profile& p) const {
    only_keys(in, prefix, {"id", "length", "fixed", "x", "y", "z"});
    Profile::Output out;
    const std::size_t size = length(in, prefix);
    out.report.assign(1 + size, 0);
    out.report[0] = report_id(in, prefix);
    check_id(in, prefix + "id", out.report[0], p);
    std::vector<bool> taken(8 * size);
    const auto claim = [&](const toml::node& node, const std::string& key, std::size_t bit,
                           std::size_t bits) {
      for (std::size_t i = bit; i < bit + bits; ++i) {
        if (taken[i]) fail(node, format("{}: bit {} is taken already", key, i));
        taken[i] = true;
      }
    };
    if (const toml::node* fixed = in.get("fixed")) {
      const std::string key = prefix + "fixed";
      for (const toml::node& entry : array(*fixed, key)) {
        if (!entry.is_table()) fail(entry, key + " has entries {byte = 0, hex = \"48\"}");
        const toml::table& t = *entry.as_table();
        only_keys(t, key + ".", {"byte", "hex"});
        const auto at = static_cast<std::size_t>(whole(
            required(t, key + ".", "byte"), key + ".byte", 0, static_cast<std::int64_t>(size) - 1));
        const toml::node& node = required(t, key + ".", "hex");
        const HidReport bytes = hex(node, key + ".hex", text(node, key + ".hex"));
        if (bytes.size() > size - at) fail(node, key + ".hex ends behind the report");
        claim(node, key, 8 * at, 8 * bytes.size());
        std::copy(bytes.begin(), bytes.end(),
                  out.report.begin() + static_cast<std::ptrdiff_t>(1 + at));
      }
    }
    for (std::size_t a = 0; a < 3; ++a) {
      if (!in.contains(kAxes[a])) continue;
      const toml::table& t = table(in, kAxes[a]);
      const std::string key = prefix + kAxes[a] + ".";
      out.axes[a] = output_axis(t, key, size, p.max_force);
      claim(t, key + "bit", out.axes[a]->field.bit, out.axes[a]->field.bits);
    }
    return out;
  }

  Profile::OutputAxis output_axis(const toml::table& in, const std::string& prefix,
                                  std::size_t report_length, double max_force) const {
    only_keys(in, prefix,
              {"bit", "bits", "signed", "endian", "newtons_per_count", "zero", "low", "high"});
    Profile::OutputAxis axis{.field = field(in, prefix, report_length, false)};
    axis.newtons_per_count = factor(in, prefix, "newtons_per_count", 1e-12, kMaxNewtons);
    const auto count = [&](const char* key, std::int64_t usual) {
      const toml::node* node = in.get(key);
      return node ? whole(*node, prefix + key, axis.field.least(), axis.field.most()) : usual;
    };
    axis.low = count("low", axis.field.least());
    axis.high = count("high", axis.field.most());
    axis.zero = count("zero", 0);
    if (axis.zero < axis.low || axis.zero > axis.high)
      fail(in, format("{0}zero must lie from {0}low to {0}high", prefix));
    // A force that is cut on one axis alone would change its direction. Less than a count is cut on
    // every axis, since forces are rounded towards zero.
    const auto room = static_cast<double>(std::min(axis.high - axis.zero, axis.zero - axis.low));
    const double newtons = std::abs(axis.newtons_per_count);
    if (max_force >= (room + 1) * newtons)
      fail(in, format("{0}low to {0}high hold {1} N, force.max is {2} N", prefix,
                      to_text(room * newtons), to_text(max_force)));
    return axis;
  }

  /// A device has ids in all its reports or in none.
  void check_id(const toml::node& node, const std::string& key, std::uint8_t id,
                const Profile& p) const {
    if ((id == 0) != (p.input_id == 0))
      fail(node,
           format("{}: reports have ids all or none (0), and input.id is {}", key, p.input_id));
  }

  /// Bytes in hex, with or without blanks between them.
  HidReport hex(const toml::node& node, const std::string& key, std::string_view digits) const {
    HidReport bytes;
    int half = -1;
    for (const char c : digits) {
      const int value = c >= '0' && c <= '9'   ? c - '0'
                        : c >= 'a' && c <= 'f' ? c - 'a' + 10
                        : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                               : -1;
      if (value < 0 && (c != ' ' || half >= 0))
        fail(node, key + " must be bytes in hex: \"48 0f\"");
      if (value < 0) continue;
      if (half < 0) {
        half = value;
      } else {
        bytes.push_back(static_cast<std::uint8_t>(half << 4 | value));
        half = -1;
      }
    }
    if (half >= 0 || bytes.empty()) fail(node, key + " must be bytes in hex: \"48 0f\"");
    return bytes;
  }

  std::vector<Profile::Literal> literals(const toml::table& in, const char* name,
                                         bool may_be_feature, const Profile& p) const {
    std::vector<Profile::Literal> list;
    const toml::node* node = in.get(name);
    if (!node) return list;
    const std::string key = std::string("reports.") + name;
    for (const toml::node& entry : array(*node, key)) {
      if (list.size() == kMaxReports)
        fail(entry, format("{} has at most {} reports", key, kMaxReports));
      const std::string words = text(entry, key);
      std::string_view digits = words;
      Profile::Literal literal;
      constexpr std::string_view kFeature = "feature ";
      if (digits.starts_with(kFeature)) {
        if (!may_be_feature) fail(entry, key + " has output reports alone");
        literal.is_feature = true;
        digits.remove_prefix(kFeature.size());
      }
      literal.report = hex(entry, key, digits);
      if (literal.report.size() > kMaxHidReport)
        fail(entry, format("{} has a report of more than {} bytes", key, kMaxLength));
      check_id(entry, key, literal.report[0], p);
      if (!literal.is_feature) pad(entry, key, literal.report, p);
      list.push_back(std::move(literal));
    }
    return list;
  }

  /// Fills a report with zeros up to the length of the output with its id, if there is one.
  void pad(const toml::node& node, const std::string& key, HidReport& report,
           const Profile& p) const {
    for (const Profile::Output& output : p.outputs) {
      if (output.report[0] != report[0]) continue;
      if (report.size() > output.report.size())
        fail(node, format("{} has a report longer than its output, {} bytes behind the id", key,
                          output.report.size() - 1));
      report.resize(output.report.size());
      return;
    }
  }

  void reports(const toml::table& in, Profile& p) const {
    only_keys(in, "reports.", {"init", "keep_alive", "stop"});
    p.init = literals(in, "init", true, p);
    for (Profile::Literal& l : literals(in, "keep_alive", false, p))
      p.keep_alive.push_back(std::move(l.report));
    for (Profile::Literal& l : literals(in, "stop", false, p))
      p.stop.push_back(std::move(l.report));
  }

  void timing(const toml::table& in, ProfileTiming& timing) const {
    only_keys(in, "timing.", {"stall_ms", "watchdog_ms", "keep_alive_ms"});
    const auto seconds = [&](const char* key, std::int64_t least, double usual) {
      const toml::node* node = in.get(key);
      return node ? static_cast<double>(whole(*node, std::string("timing.") + key, least, 10'000)) *
                        1e-3
                  : usual;
    };
    timing.stall = seconds("stall_ms", 1, timing.stall);
    timing.watchdog = seconds("watchdog_ms", 1, timing.watchdog);
    timing.keep_alive = seconds("keep_alive_ms", 0, timing.keep_alive);
  }

  void workspace(const toml::table& in, Profile& p) const {
    only_keys(in, "workspace.", {"low", "high"});
    const auto corner = [&](const char* key) {
      const std::string shown = std::string("workspace.") + key;
      const toml::node& node = required(in, "workspace.", key);
      const std::vector<double> values = numbers(node, shown);
      if (values.size() != 3) fail(node, shown + " has three entries");
      for (const double value : values)
        if (std::abs(value) > kMaxMetres)
          fail(node, shown + " is in metres, at most " + to_text(kMaxMetres));
      return Vec3{values[0], values[1], values[2]};
    };
    p.low = corner("low");
    p.high = corner("high");
    bool has_room = false;
    for (std::size_t a = 0; a < 3; ++a) {
      if (p.low[a] > p.high[a])
        fail(in, std::string("workspace.low is above workspace.high in ") + kAxes[a]);
      has_room = has_room || p.low[a] < p.high[a];
    }
    if (!has_room) fail(in, "workspace is a single point");
  }
};

}  // namespace

Profile read_profile(const std::string& text, const std::string& name) {
  return Reader(text, name).read(name);
}

}  // namespace hapgrid
