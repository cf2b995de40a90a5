// HID report descriptors, and values in and out of the reports that they describe.
#include "libcore/device/hid_describe.hpp"
#include "libcore/device/hid_descriptor.hpp"
#include "libcore/device/hid_report.hpp"
#include "libcore/device/pid.hpp"
#include "tests/fuzz/fuzz.hpp"

using namespace hapgrid;

namespace {

constexpr HidReportKind kKinds[] = {HidReportKind::kInput, HidReportKind::kOutput,
                                    HidReportKind::kFeature};

/// A report of `size` bytes and none behind them.
void use(std::size_t size, const HidElement& element) {
  const auto bytes = std::make_unique<std::uint8_t[]>(size);
  const std::span<std::uint8_t> report(bytes.get(), size);
  std::fill(report.begin(), report.end(), std::uint8_t{0xa5});
  if (size > 0) report[0] = element.report_id;
  const bool written = write_element(report, element, element.logical_max);
  if (written != read_element(report, element).has_value())
    throw std::logic_error("what can be written and what can be read differ");
}

/// The effects of a PID device are created, used and freed.
struct Channel : HidChannel {
  void write(std::span<const std::uint8_t>) override {}
  void set_feature(std::span<const std::uint8_t>) override {}
  HidReport get_feature(std::uint8_t id, std::size_t size) override {
    HidReport report(size, 0x01);
    if (!report.empty()) report[0] = id;
    return report;
  }
};

void use_pid(const HidDescriptor& descriptor) {
  PidProtocol protocol(descriptor, PidParameters{});
  Channel channel;
  protocol.start(channel);
  const std::vector<std::uint8_t> report(64, 0x11);
  DeviceInput input;
  protocol.decode(report, input);
  std::vector<HidReport> reports;
  protocol.encode({1, -1e9, 0}, reports);
  protocol.stop();
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::refusable([&] {
    const HidDescriptor descriptor = parse_hid_descriptor({data, size});
    describe(descriptor);
    for (const HidField& field : descriptor.fields) {
      descriptor.application(field);
      descriptor.inside(field, {1, 4});
      const std::uint64_t count = field.usage_count();
      for (const std::uint64_t position : {std::uint64_t{0}, count / 2, count - 1, count})
        if (const auto usage = field.usage(position))
          for (const HidReportKind kind : kKinds)
            if (const auto element = descriptor.find(kind, *usage)) {
              const std::size_t report = descriptor.report_bytes(kind, element->report_id);
              use(report, *element);
              use(report / 2, *element);
            }
    }
    use_pid(descriptor);
  });
  return 0;
}
