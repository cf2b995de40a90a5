// kernel-fields: whether Linux reads report descriptors as libcore/device/hid_descriptor does.
//
// Plugs in a device for each descriptor of tests/hid/descriptors.h, and compares the fields that
// the kernel shows in /sys/kernel/debug/hid/*/rdesc with those of the parser, which is given the
// bytes that sysfs has. A field is written as one line; those without usages (padding) the kernel
// drops.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "libcore/device/hid_descriptor.hpp"
#include "tests/hid/descriptors.h"
#include "tests/qemu/uhid.h"

using namespace hapgrid;

namespace {

std::string hex(std::uint64_t value) {
  char text[17];
  std::snprintf(text, sizeof text, "%04x", static_cast<unsigned>(value));
  return text;
}

std::vector<std::string> parsed_fields(const HidDescriptor& descriptor) {
  static const std::string kinds[] = {"INPUT", "OUTPUT", "FEATURE"};
  std::vector<std::string> lines;
  for (const HidField& f : descriptor.fields) {
    if (f.usages.empty()) continue;
    const HidUsage application = descriptor.application(f);
    std::string line = kinds[static_cast<int>(f.kind)] + " " + std::to_string(f.report_id) +
                       " in " + hex(application.page) + "." + hex(application.id);
    const auto add = [&](const char* name, std::int64_t value) {
      line += std::string("; ") + name + " " + std::to_string(value);
    };
    add("Logical Minimum", f.logical_min);
    add("Logical Maximum", f.logical_max);
    add("Physical Minimum", f.physical_min);
    add("Physical Maximum", f.physical_max);
    add("Unit Exponent", f.unit_exponent);
    add("Report Size", f.bit_size);
    add("Report Count", f.count);
    add("Report Offset", f.bit_offset);
    line += std::string("; ") + (f.constant ? "Constant " : "") +
            (f.variable ? "Variable " : "Array ") + (f.relative ? "Relative" : "Absolute") + ";";
    // The kernel has a usage for each value too many.
    const std::uint64_t count = f.usage_count();
    for (std::uint64_t i = 0; i < std::max<std::uint64_t>(count, f.count); ++i) {
      const auto usage = f.usage(std::min(i, count - 1));
      line += " " + hex(usage->page) + "." + hex(usage->id);
    }
    lines.push_back(line);
  }
  std::sort(lines.begin(), lines.end());
  return lines;
}

/// "GenericDesktop.X", "Button.0001" or "ff00.0001" as the kernel writes it: 0001.0030.
std::string usage_number(const std::string& text) {
  // HID Usage Tables; only what these descriptors have.
  static const std::map<std::string, std::string> numbers{{"GenericDesktop", "0001"},
                                                          {"LED", "0008"},
                                                          {"Button", "0009"},
                                                          {"Ordinal", "000a"},
                                                          {"Pointer", "0001"},
                                                          {"Mouse", "0002"},
                                                          {"Joystick", "0004"},
                                                          {"GamePad", "0005"},
                                                          {"MultiAxis", "0008"},
                                                          {"PhysicalInterfaceDevice", "000f"},
                                                          {"X", "0030"},
                                                          {"Y", "0031"},
                                                          {"Z", "0032"},
                                                          {"Rx", "0033"},
                                                          {"Ry", "0034"},
                                                          {"Rz", "0035"},
                                                          {"HatSwitch", "0039"},
                                                          {"ByteCount", "003b"},
                                                          {"GenericIndicator", "004b"}};
  const auto number = [&](const std::string& word) {
    const auto found = numbers.find(word);
    return found == numbers.end() ? word : found->second;
  };
  const std::size_t dot = text.find('.');
  return number(text.substr(0, dot)) + "." + number(text.substr(dot + 1));
}

std::vector<std::string> kernel_fields(const std::filesystem::path& file) {
  std::vector<std::string> lines;
  std::ifstream in(file);
  std::string report;
  std::string application;
  std::map<std::string, std::string> values;
  std::string usages;
  std::smatch m;
  static const std::regex report_line(R"(  (INPUT|OUTPUT|FEATURE)(\((\d+)\))?\[\w+\])");
  static const std::regex application_line(R"( *Application\((.*)\))");
  static const std::regex value_line(R"( {6}(\w+ \w+)\((-?\d+)\))");
  static const std::regex usage_line(R"( {8}(\S+\.\S+))");
  static const std::regex flags_line(R"( *Flags\( (.*) \))");
  for (std::string line; std::getline(in, line);) {
    if (std::regex_match(line, m, report_line)) {
      report = m.str(1) + " " + (m[3].matched ? m.str(3) : "0");
    } else if (std::regex_match(line, m, application_line)) {
      application = usage_number(m.str(1));
    } else if (std::regex_match(line, m, value_line)) {
      values[m.str(1)] = m.str(2);
    } else if (std::regex_match(line, m, usage_line)) {
      usages += " " + usage_number(m.str(1));
    } else if (std::regex_match(line, m, flags_line)) {  // the last line of a field
      std::string all = report + " in " + application;
      for (const char* name :
           {"Logical Minimum", "Logical Maximum", "Physical Minimum", "Physical Maximum",
            "Unit Exponent", "Report Size", "Report Count", "Report Offset"}) {
        all += std::string("; ") + name + " " + (values.count(name) ? values[name] : "0");
      }
      // "Constant Variable Absolute" with further flags behind.
      std::string flags;
      std::istringstream words(m.str(1));
      for (std::string word; words >> word;) {
        if (word != "NullState") flags += (flags.empty() ? "" : " ") + word;
      }
      lines.push_back(all + "; " + flags + ";" + usages);
      values.clear();
      usages.clear();
    }
  }
  std::sort(lines.begin(), lines.end());
  return lines;
}

std::set<std::string> devices() {
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator("/sys/kernel/debug/hid")) {
    names.insert(entry.path().filename());
  }
  return names;
}

std::vector<std::uint8_t> read_bytes(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

bool compare(const char* name, std::span<const std::uint8_t> bytes) {
  const std::set<std::string> before = devices();
  const int fd = uhid_create(name, 0x1209, 1, bytes.data(), bytes.size());
  static struct uhid_event event;
  do uhid_read(fd, &event);
  while (event.type != UHID_START);
  std::string device;
  for (const std::string& each : devices()) {
    if (!before.count(each)) device = each;
  }
  const std::vector<std::uint8_t> sysfs =
      read_bytes("/sys/bus/hid/devices/" + device + "/report_descriptor");
  const std::vector<std::string> kernel =
      kernel_fields("/sys/kernel/debug/hid/" + device + "/rdesc");
  const std::vector<std::string> ours = parsed_fields(parse_hid_descriptor(sysfs));
  uhid_destroy(fd);
  close(fd);
  const bool same_bytes = std::equal(sysfs.begin(), sysfs.end(), bytes.begin(), bytes.end());
  if (same_bytes && ours == kernel && !kernel.empty()) {
    std::cout << name << ": " << kernel.size() << " fields, the same\n";
    return true;
  }
  std::cout << name << ": not the same\n";
  for (const std::string& line : kernel) std::cout << "  kernel " << line << "\n";
  for (const std::string& line : ours) std::cout << "  parser " << line << "\n";
  return false;
}

}  // namespace

int main() {
  bool same = true;
  for (const auto& d : kDescriptors) same = compare(d.name, {d.bytes, d.size}) && same;
  return same ? 0 : 1;
}
