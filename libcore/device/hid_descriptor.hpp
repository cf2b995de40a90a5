// A parsed HID report descriptor: which bits of which report have which usage.
//
// In the descriptor a device describes its reports in a small language (Device Class Definition for
// HID 1.11, Sect. 6.2.2). It is hostile input: a few bytes can claim a billion usages or a report
// of gigabytes. So usages stay ranges as they were written, and memory grows with the descriptor's
// own bytes, of which there are 4096 at most.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace hapgrid {

/// The meaning of a value: a usage page, and a number on that page (HID Usage Tables).
struct HidUsage {
  std::uint16_t page = 0;
  std::uint16_t id = 0;
  friend bool operator==(const HidUsage&, const HidUsage&) = default;
};

/// The usages first, first + 1, ..., last_id of one page.
struct HidUsageRange {
  HidUsage first;
  std::uint16_t last_id = 0;  ///< at least first.id
};

enum class HidReportKind { kInput, kOutput, kFeature };

/// A group of fields. Collections are nested.
struct HidCollection {
  std::uint8_t type = 0;  ///< 0 physical, 1 application, 2 logical, ...
  HidUsage usage;         ///< 0:0 when it has none
  std::optional<std::size_t> parent;
};

/// `count` values of `bit_size` bits, one after the other, least significant bit first.
/// A variable field has a usage for each value. Each value of an array field chooses a usage: it is
/// logical_min + the position of the usage in the list.
struct HidField {
  HidReportKind kind = HidReportKind::kInput;
  std::uint8_t report_id = 0;    ///< 0: the device's reports have no ids
  std::uint32_t bit_offset = 0;  ///< in the report, without the id's byte
  std::uint32_t bit_size = 0;    ///< at least 1
  std::uint32_t count = 0;       ///< at least 1
  bool constant = false;         ///< padding, if it has no usages
  bool variable = false;
  bool relative = false;
  std::vector<HidUsageRange> usages;  ///< in order; the last one holds for all further values
  /// As the descriptor gives them; values are signed when logical_min < 0.
  std::int64_t logical_min = 0;
  std::int64_t logical_max = 0;
  std::int64_t physical_min = 0;  ///< both 0: the same as logical
  std::int64_t physical_max = 0;
  std::uint32_t unit = 0;  ///< a nibble for each dimension (HID 1.11, Sect. 6.2.2.7)
  std::int32_t unit_exponent = 0;
  std::optional<std::size_t> collection;  ///< the innermost one

  /// The number of usages in the list, at most 65536 for each range.
  std::uint64_t usage_count() const;
  /// Number `position` of the list; nothing after its end.
  std::optional<HidUsage> usage(std::uint64_t position) const;
};

/// One value in a report, found by its usage.
struct HidElement {
  HidReportKind kind = HidReportKind::kInput;
  std::uint8_t report_id = 0;
  std::uint32_t bit_offset = 0;  ///< as HidField's
  std::uint32_t bit_size = 0;
  std::int64_t logical_min = 0;
  std::int64_t logical_max = 0;
  bool variable = true;  ///< as HidField's
  /// The value that says that the usage is chosen or on: its number in an array, else 1.
  std::int64_t choice = 1;
};

struct HidDescriptor {
  std::vector<HidCollection> collections;  ///< a parent comes before its children
  std::vector<HidField> fields;            ///< in the descriptor's order
  /// Bits of each report, without the id's byte.
  std::map<std::pair<HidReportKind, std::uint8_t>, std::uint32_t> report_bits;

  /// Bytes of a report with its id, or with the 0 that hidapi has instead, at most 16384; 0 when
  /// there is no such report.
  std::size_t report_bytes(HidReportKind kind, std::uint8_t id) const;
  /// The usage of the outermost collection that `field` is in.
  HidUsage application(const HidField& field) const;
  /// Whether any collection around `field` has this usage.
  bool inside(const HidField& field, HidUsage collection) const;
  /// The first value with this usage; with `collection`, in a collection of that usage; with
  /// `report_id`, in that report.
  std::optional<HidElement> find(HidReportKind kind, HidUsage usage,
                                 std::optional<HidUsage> collection = std::nullopt,
                                 std::optional<std::uint8_t> report_id = std::nullopt) const;
};

/// @throw DeviceError, one line, when the descriptor has no bytes or more than 4096, ends inside an
/// item or a collection, closes or pops what is not open, has a report id that is not 1 to 255, or
/// a report of more than 16384 bytes.
HidDescriptor parse_hid_descriptor(std::span<const std::uint8_t> bytes);

}  // namespace hapgrid
