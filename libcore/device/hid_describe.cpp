#include "libcore/device/hid_describe.hpp"

#include <algorithm>
#include <array>
#include <string_view>

namespace hapgrid {

namespace {

struct Name {
  HidUsage usage;
  std::string_view text;
};

// Usages of devices for the hand (HID Usage Tables 1.12; Device Class Definition for PID 1.0).
constexpr Name kNames[] = {
    {{0x01, 0x01}, "Pointer"},
    {{0x01, 0x02}, "Mouse"},
    {{0x01, 0x04}, "Joystick"},
    {{0x01, 0x05}, "Gamepad"},
    {{0x01, 0x06}, "Keyboard"},
    {{0x01, 0x08}, "Multi-axis Controller"},
    {{0x01, 0x30}, "X"},
    {{0x01, 0x31}, "Y"},
    {{0x01, 0x32}, "Z"},
    {{0x01, 0x33}, "Rx"},
    {{0x01, 0x34}, "Ry"},
    {{0x01, 0x35}, "Rz"},
    {{0x01, 0x36}, "Slider"},
    {{0x01, 0x37}, "Dial"},
    {{0x01, 0x38}, "Wheel"},
    {{0x01, 0x39}, "Hat Switch"},
    {{0x0f, 0x21}, "Set Effect Report"},
    {{0x0f, 0x22}, "Effect Block Index"},
    {{0x0f, 0x23}, "Parameter Block Offset"},
    {{0x0f, 0x25}, "Effect Type"},
    {{0x0f, 0x26}, "Constant Force"},
    {{0x0f, 0x27}, "Ramp"},
    {{0x0f, 0x30}, "Square"},
    {{0x0f, 0x31}, "Sine"},
    {{0x0f, 0x32}, "Triangle"},
    {{0x0f, 0x33}, "Sawtooth Up"},
    {{0x0f, 0x34}, "Sawtooth Down"},
    {{0x0f, 0x40}, "Spring"},
    {{0x0f, 0x41}, "Damper"},
    {{0x0f, 0x42}, "Inertia"},
    {{0x0f, 0x43}, "Friction"},
    {{0x0f, 0x50}, "Duration"},
    {{0x0f, 0x51}, "Sample Period"},
    {{0x0f, 0x52}, "Gain"},
    {{0x0f, 0x53}, "Trigger Button"},
    {{0x0f, 0x54}, "Trigger Repeat Interval"},
    {{0x0f, 0x55}, "Axes Enable"},
    {{0x0f, 0x56}, "Direction Enable"},
    {{0x0f, 0x57}, "Direction"},
    {{0x0f, 0x5a}, "Set Envelope Report"},
    {{0x0f, 0x5f}, "Set Condition Report"},
    {{0x0f, 0x6e}, "Set Periodic Report"},
    {{0x0f, 0x70}, "Magnitude"},
    {{0x0f, 0x73}, "Set Constant Force Report"},
    {{0x0f, 0x74}, "Set Ramp Force Report"},
    {{0x0f, 0x77}, "Effect Operation Report"},
    {{0x0f, 0x78}, "Effect Operation"},
    {{0x0f, 0x79}, "Effect Start"},
    {{0x0f, 0x7a}, "Effect Start Solo"},
    {{0x0f, 0x7b}, "Effect Stop"},
    {{0x0f, 0x7c}, "Loop Count"},
    {{0x0f, 0x7d}, "Device Gain Report"},
    {{0x0f, 0x7e}, "Device Gain"},
    {{0x0f, 0x7f}, "PID Pool Report"},
    {{0x0f, 0x80}, "RAM Pool Size"},
    {{0x0f, 0x83}, "Simultaneous Effects Max"},
    {{0x0f, 0x89}, "PID Block Load Report"},
    {{0x0f, 0x8b}, "Block Load Status"},
    {{0x0f, 0x8c}, "Block Load Success"},
    {{0x0f, 0x8d}, "Block Load Full"},
    {{0x0f, 0x8e}, "Block Load Error"},
    {{0x0f, 0x90}, "PID Block Free Report"},
    {{0x0f, 0x92}, "PID State Report"},
    {{0x0f, 0x94}, "Effect Playing"},
    {{0x0f, 0x95}, "PID Device Control Report"},
    {{0x0f, 0x96}, "PID Device Control"},
    {{0x0f, 0x97}, "Enable Actuators"},
    {{0x0f, 0x98}, "Disable Actuators"},
    {{0x0f, 0x99}, "Stop All Effects"},
    {{0x0f, 0x9a}, "Device Reset"},
    {{0x0f, 0x9b}, "Device Pause"},
    {{0x0f, 0x9c}, "Device Continue"},
    {{0x0f, 0x9f}, "Device Paused"},
    {{0x0f, 0xa0}, "Actuators Enabled"},
    {{0x0f, 0xa4}, "Safety Switch"},
    {{0x0f, 0xa6}, "Actuator Power"},
    {{0x0f, 0xa7}, "Start Delay"},
    {{0x0f, 0xa9}, "Device Managed Pool"},
    {{0x0f, 0xaa}, "Shared Parameter Blocks"},
    {{0x0f, 0xab}, "Create New Effect Report"},
    {{0x0f, 0xac}, "RAM Pool Available"},
};

constexpr std::array<std::string_view, 3> kKinds = {"input", "output", "feature"};
constexpr std::size_t kMaxRangesShown = 16;

std::string hex(unsigned value, int digits) {
  std::string text;
  for (int shift = 4 * (digits - 1); shift >= 0; shift -= 4) {
    text += "0123456789abcdef"[value >> shift & 15];
  }
  return text;
}

std::string name(HidUsage usage) {
  const auto known = std::find_if(std::begin(kNames), std::end(kNames),
                                  [&](const Name& n) { return n.usage == usage; });
  if (known != std::end(kNames)) return std::string(known->text);
  if (usage.page == 0x09) return "Button " + std::to_string(usage.id);
  return hex(usage.page, 4) + ":" + hex(usage.id, 4);
}

std::string usages(const HidField& field) {
  if (field.usages.empty()) return field.constant ? "padding" : "no usage";
  std::string text;
  for (std::size_t i = 0; i < field.usages.size(); ++i) {
    const HidUsageRange& range = field.usages[i];
    if (i > 0) text += ", ";
    if (i == kMaxRangesShown) {
      text += "and " + std::to_string(field.usages.size() - i) + " more";
      break;
    }
    text += name(range.first);
    if (range.last_id != range.first.id) text += " to " + name({range.first.page, range.last_id});
  }
  return text;
}

std::string line(const HidDescriptor& descriptor, const HidField& field) {
  std::string text = std::string(kKinds[static_cast<std::size_t>(field.kind)]) + " " +
                     std::to_string(field.report_id) + ": byte " +
                     std::to_string(1 + field.bit_offset / 8) + " bit " +
                     std::to_string(field.bit_offset % 8) + ": ";
  if (field.count > 1) text += std::to_string(field.count) + " x ";
  text += std::to_string(field.bit_size) + (field.bit_size == 1 ? " bit: " : " bits: ");
  text += field.variable || field.usages.empty() ? "" : "one of ";
  text += usages(field);
  int shown = 0;  // PID reports have two: one groups the choices, one names the report
  for (auto c = field.collection; c && shown < 2; c = descriptor.collections[*c].parent) {
    const HidCollection& collection = descriptor.collections[*c];
    if (collection.type != 2 || collection.usage == HidUsage()) continue;
    text += " (in " + name(collection.usage) + ")";
    ++shown;
  }
  if (field.usages.empty() && field.constant) return text;
  text +=
      ": logical " + std::to_string(field.logical_min) + ".." + std::to_string(field.logical_max);
  if (field.physical_min != 0 || field.physical_max != 0) {
    text += ", physical " + std::to_string(field.physical_min) + ".." +
            std::to_string(field.physical_max);
  }
  if (field.unit != 0) text += ", unit 0x" + hex(field.unit, 8);
  if (field.unit_exponent != 0) text += ", times 10^" + std::to_string(field.unit_exponent);
  if (field.relative) text += ", relative";
  if (field.constant) text += ", constant";
  return text;
}

}  // namespace

std::string describe(const HidDescriptor& descriptor) {
  std::string text;
  std::optional<HidUsage> application;
  for (const HidField& field : descriptor.fields) {
    const HidUsage now = descriptor.application(field);
    if (application != now) {
      application = now;
      text += name(now) + "\n";
    }
    text += "  " + line(descriptor, field) + "\n";
  }
  return text;
}

}  // namespace hapgrid
