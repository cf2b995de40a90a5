#include "libcore/device/hid_descriptor.hpp"

namespace hapgrid {

std::uint64_t HidField::usage_count() const {
  std::uint64_t count = 0;
  for (const HidUsageRange& range : usages) count += range.last_id - range.first.id + 1U;
  return count;
}

std::optional<HidUsage> HidField::usage(std::uint64_t position) const {
  for (const HidUsageRange& range : usages) {
    const std::uint64_t size = range.last_id - range.first.id + 1U;
    if (position < size) {
      return HidUsage{range.first.page, static_cast<std::uint16_t>(range.first.id + position)};
    }
    position -= size;
  }
  return std::nullopt;
}

std::size_t HidDescriptor::report_bytes(HidReportKind kind, std::uint8_t id) const {
  const auto found = report_bits.find({kind, id});
  return found == report_bits.end() ? 0 : 1 + (found->second + 7) / 8;
}

HidUsage HidDescriptor::application(const HidField& field) const {
  HidUsage usage;
  for (auto c = field.collection; c; c = collections[*c].parent) usage = collections[*c].usage;
  return usage;
}

bool HidDescriptor::inside(const HidField& field, HidUsage collection) const {
  for (auto c = field.collection; c; c = collections[*c].parent) {
    if (collections[*c].usage == collection) return true;
  }
  return false;
}

std::optional<HidElement> HidDescriptor::find(HidReportKind kind, HidUsage usage,
                                              std::optional<HidUsage> collection,
                                              std::optional<std::uint8_t> report_id) const {
  for (const HidField& field : fields) {
    if (field.kind != kind || (collection && !inside(field, *collection)) ||
        (report_id && field.report_id != *report_id))
      continue;
    std::uint64_t position = 0;
    for (const HidUsageRange& range : field.usages) {
      if (range.first.page == usage.page && range.first.id <= usage.id &&
          usage.id <= range.last_id) {
        position += usage.id - range.first.id;
        if (field.variable && position >= field.count) break;  // a usage too many: no value for it
        const auto index = static_cast<std::uint32_t>(field.variable ? position : 0);
        return HidElement{
            .kind = kind,
            .report_id = field.report_id,
            .bit_offset = field.bit_offset + index * field.bit_size,
            .bit_size = field.bit_size,
            .logical_min = field.logical_min,
            .logical_max = field.logical_max,
            .variable = field.variable,
            .choice = field.variable ? 1 : field.logical_min + static_cast<std::int64_t>(position)};
      }
      position += range.last_id - range.first.id + 1U;
    }
  }
  return std::nullopt;
}

}  // namespace hapgrid
