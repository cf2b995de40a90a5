// Parses report descriptors (HID 1.11, Sect. 6.2.2): items, and the state that they change.
#include <string>
#include <utility>

#include "libcore/base/error.hpp"
#include "libcore/device/hid_descriptor.hpp"

namespace hapgrid {

namespace {

// These are the limits of Linux (HID_MAX_DESCRIPTOR_SIZE, HID_MAX_BUFFER_SIZE).
constexpr std::size_t kMaxDescriptorBytes = 4096;
constexpr std::uint64_t kMaxReportBytes = 16384;

/// A short item (HID 1.11, Sect. 6.2.2.2).
struct Item {
  int type = 0;  // 0 main, 1 global, 2 local, 3 reserved
  int tag = 0;
  int size = 0;  // bytes of data: 0, 1, 2 or 4
  std::uint32_t data = 0;

  std::int64_t as_signed() const {
    switch (size) {
      case 1:
        return static_cast<std::int8_t>(data);
      case 2:
        return static_cast<std::int16_t>(data);
      default:
        return static_cast<std::int32_t>(data);
    }
  }
};

/// What holds until it is set again.
struct Globals {
  std::uint16_t usage_page = 0;
  // Whether a maximum is signed depends on its minimum, which may come after it.
  Item logical_min, logical_max, physical_min, physical_max;
  std::int32_t unit_exponent = 0;
  std::uint32_t unit = 0;
  std::uint32_t report_size = 0;
  std::uint32_t report_count = 0;
  std::uint8_t report_id = 0;
};

/// What holds until the next main item.
struct Locals {
  struct Range {
    HidUsageRange usages;
    bool full = false;  // has its own page
  };
  std::vector<Range> ranges;
  std::optional<Item> minimum;
  bool in_set = false;     // between delimiters, which enclose alternatives for one usage
  bool set_taken = false;  // the first alternative, which counts, was there
};

std::int64_t maximum(const Item& min, const Item& max) {
  return min.as_signed() < 0 ? max.as_signed() : std::int64_t{max.data};
}

class Parser {
 public:
  explicit Parser(std::span<const std::uint8_t> bytes) : bytes_(bytes) {
    if (bytes.empty()) throw DeviceError("report descriptor: it is empty");
    if (bytes.size() > kMaxDescriptorBytes) {
      throw DeviceError("report descriptor: " + std::to_string(bytes.size()) + " bytes: at most " +
                        std::to_string(kMaxDescriptorBytes));
    }
  }

  HidDescriptor parse() {
    while (at_ < bytes_.size()) {
      start_ = at_;
      const std::uint8_t prefix = bytes_[at_++];
      if (prefix == 0xfe) {  // a long item, which HID 1.11 does not use
        const std::uint32_t size = take(1);
        take(1);
        skip(size);
        continue;
      }
      Item item{.type = (prefix >> 2) & 3, .tag = prefix >> 4, .size = prefix & 3};
      if (item.size == 3) item.size = 4;
      item.data = take(item.size);
      if (item.type == 0) main(item);
      if (item.type == 1) global(item);
      if (item.type == 2) local(item);
    }
    if (open_) refuse("a collection is not closed");
    return std::move(result_);
  }

 private:
  [[noreturn]] void refuse(const std::string& what) const {
    throw DeviceError("report descriptor: byte " + std::to_string(start_) + ": " + what);
  }

  void skip(std::size_t size) {
    if (size > bytes_.size() - at_) refuse("the descriptor ends inside this item");
    at_ += size;
  }

  std::uint32_t take(int size) {
    skip(static_cast<std::size_t>(size));
    std::uint32_t value = 0;
    for (int i = 1; i <= size; ++i) value = value << 8 | bytes_[at_ - static_cast<std::size_t>(i)];
    return value;
  }

  void main(const Item& item) {
    settle_pages();
    switch (item.tag) {
      case 0x8:
        add_field(HidReportKind::kInput, item.data);
        break;
      case 0x9:
        add_field(HidReportKind::kOutput, item.data);
        break;
      case 0xb:
        add_field(HidReportKind::kFeature, item.data);
        break;
      case 0xa: {
        HidCollection collection{
            .type = static_cast<std::uint8_t>(item.data), .usage = {}, .parent = open_};
        if (!locals_.ranges.empty()) collection.usage = locals_.ranges[0].usages.first;
        open_ = result_.collections.size();
        result_.collections.push_back(collection);
        break;
      }
      case 0xc:
        if (!open_) refuse("closes a collection that is not open");
        open_ = result_.collections[*open_].parent;
        break;
      default:  // reserved
        break;
    }
    locals_ = Locals();
  }

  /// A usage without a page of its own gets the page that is current at the main item (Sect.
  /// 6.2.2.8). But a usage whose page was set again before the main item keeps the earlier page, as
  /// devices expect and Linux does.
  void settle_pages() {
    for (auto range = locals_.ranges.rbegin(); range != locals_.ranges.rend(); ++range) {
      if (range->full) continue;
      if (range->usages.first.page == globals_.usage_page) break;
      range->usages.first.page = globals_.usage_page;
    }
  }

  void add_field(HidReportKind kind, std::uint32_t flags) {
    const Globals& g = globals_;
    std::uint32_t& bits = result_.report_bits[{kind, g.report_id}];
    const std::uint64_t added = std::uint64_t{g.report_size} * g.report_count;
    if (bits + added > 8 * (kMaxReportBytes - 1)) {
      refuse("report " + std::to_string(g.report_id) + " gets longer than " +
             std::to_string(kMaxReportBytes) + " bytes");
    }
    if (added == 0) return;
    HidField field{.kind = kind,
                   .report_id = g.report_id,
                   .bit_offset = bits,
                   .bit_size = g.report_size,
                   .count = g.report_count,
                   .constant = (flags & 1) != 0,
                   .variable = (flags & 2) != 0,
                   .relative = (flags & 4) != 0,
                   .usages = {},
                   .logical_min = g.logical_min.as_signed(),
                   .logical_max = maximum(g.logical_min, g.logical_max),
                   .physical_min = g.physical_min.as_signed(),
                   .physical_max = maximum(g.physical_min, g.physical_max),
                   .unit = g.unit,
                   .unit_exponent = g.unit_exponent,
                   .collection = open_};
    for (const Locals::Range& range : locals_.ranges) field.usages.push_back(range.usages);
    bits += static_cast<std::uint32_t>(added);
    result_.fields.push_back(std::move(field));
  }

  void global(const Item& item) {
    Globals& g = globals_;
    switch (item.tag) {
      case 0x0:
        g.usage_page = static_cast<std::uint16_t>(item.data);
        break;
      case 0x1:
        g.logical_min = item;
        break;
      case 0x2:
        g.logical_max = item;
        break;
      case 0x3:
        g.physical_min = item;
        break;
      case 0x4:
        g.physical_max = item;
        break;
      case 0x5:
        // The standard wants a nibble, but many devices write a whole signed number.
        g.unit_exponent = static_cast<std::int32_t>(
            item.data < 16 ? (item.data < 8 ? item.data : std::int64_t{item.data} - 16)
                           : item.as_signed());
        break;
      case 0x6:
        g.unit = item.data;
        break;
      case 0x7:
        g.report_size = item.data;
        break;
      case 0x8:
        if (item.data < 1 || item.data > 255) {
          refuse("report id " + std::to_string(item.data) + ": 1 to 255 are there");
        }
        g.report_id = static_cast<std::uint8_t>(item.data);
        break;
      case 0x9:
        g.report_count = item.data;
        break;
      case 0xa:
        pushed_.push_back(g);
        break;
      case 0xb:
        if (pushed_.empty()) refuse("pops what was not pushed");
        g = pushed_.back();
        pushed_.pop_back();
        break;
      default:  // reserved
        break;
    }
  }

  HidUsage usage(const Item& item) const {
    return {item.size == 4 ? static_cast<std::uint16_t>(item.data >> 16) : globals_.usage_page,
            static_cast<std::uint16_t>(item.data)};
  }

  void add_usages(HidUsage first, std::uint16_t last_id, bool full) {
    if (locals_.in_set && std::exchange(locals_.set_taken, true)) return;
    locals_.ranges.push_back({{first, last_id}, full});
  }

  void local(const Item& item) {
    switch (item.tag) {
      case 0x0:
        add_usages(usage(item), usage(item).id, item.size == 4);
        break;
      case 0x1:
        locals_.minimum = item;
        break;
      case 0x2: {
        if (!locals_.minimum) break;  // a range without a minimum means nothing
        const HidUsage first = usage(*locals_.minimum);
        const HidUsage last = usage(item);
        const bool full = locals_.minimum->size == 4 || item.size == 4;
        if (first.page == last.page && first.id <= last.id) add_usages(first, last.id, full);
        locals_.minimum.reset();
        break;
      }
      case 0xa:
        locals_.in_set = item.data != 0;
        locals_.set_taken = false;
        break;
      default:  // designators and strings
        break;
    }
  }

  std::span<const std::uint8_t> bytes_;
  std::size_t at_ = 0;
  std::size_t start_ = 0;  // of the item at hand
  HidDescriptor result_;
  Globals globals_;
  Locals locals_;
  std::vector<Globals> pushed_;
  std::optional<std::size_t> open_;  // the innermost collection
};

}  // namespace

HidDescriptor parse_hid_descriptor(std::span<const std::uint8_t> bytes) {
  return Parser(bytes).parse();
}

}  // namespace hapgrid
