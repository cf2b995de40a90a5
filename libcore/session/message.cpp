// Messages of schemas/session.capnp.
#include "libcore/base/message.hpp"

#include "libcore/base/error.hpp"
#include "libcore/base/format.hpp"
#include "libcore/base/text.hpp"
#include "libcore/grid/box_message.hpp"
#include "libcore/session/column.hpp"
#include "libcore/session/format.hpp"
#include "session.capnp.h"

namespace hapgrid {

namespace {

constexpr std::uint64_t kMagic = 0x6861706772696473;  // "hapgrids"
constexpr std::uint32_t kFormatVersion = 2;
constexpr double kMinRate = 1e-6;  // so that times and numbers of ticks are far from overflow
constexpr double kMaxRate = 1e9;
constexpr std::size_t kMaxText = 255;  // bytes of a name, unit or digest

template <class Fill>
Message build(std::size_t words, Fill&& fill) {
  Message scratch, message;
  build_message<session_schema::Message>(words, scratch, message, fill);
  return message;
}

void check_text(const std::string& text, std::size_t limit, const char* what) {
  if (text.size() > limit)
    throw Error(format("{} of {} bytes, the limit is {}", what, text.size(), limit));
}

}  // namespace

void SessionHeader::validate() const {
  box.validate();
  if (!(rate_hz >= kMinRate && rate_hz <= kMaxRate))
    throw Error(format("a rate of {} Hz; {} to {} are possible", to_text(rate_hz),
                       to_text(kMinRate), to_text(kMaxRate)));
  if (flags.size() > kMaxFlags)
    throw Error(format("{} flags, the limit is {}", flags.size(), kMaxFlags));
  for (const std::string& name : flags) check_text(name, kMaxText, "a flag's name");
  check_text(model, kMaxText, "a model's name");
  check_text(grid_digest, kMaxText, "a grid's digest");
  check_text(length_unit, kMaxText, "a unit");
  check_text(settings, kMaxSettings, "settings");
}

Message encode_header(const SessionHeader& header) {
  header.validate();
  return build(1024, [&](session_schema::Message::Builder message) {
    auto out = message.initHeader();
    out.setMagic(kMagic);
    out.setVersion(kFormatVersion);
    out.setModel(header.model);
    out.setGridDigest(header.grid_digest);
    out.setLengthUnit(header.length_unit);
    set_box(out.initBox(), header.box);
    out.setRate(header.rate_hz);
    auto flags = out.initFlagNames(static_cast<unsigned>(header.flags.size()));
    for (unsigned i = 0; i < header.flags.size(); ++i) flags.set(i, header.flags[i]);
    out.setSettings(header.settings);
  });
}

SessionHeader decode_header(const Message& message) {
  return read_message<session_schema::Message>(
      message, [](session_schema::Message::Reader in_message) {
        if (!in_message.isHeader() || in_message.getHeader().getMagic() != kMagic)
          throw FormatError("not a session");
        const auto in = in_message.getHeader();
        if (in.getVersion() != kFormatVersion)
          throw FormatError(format("format version {}, this program reads version {}",
                                   in.getVersion(), kFormatVersion));
        SessionHeader header;
        header.model = get_text(in.getModel(), kMaxText, "a model's name");
        header.grid_digest = get_text(in.getGridDigest(), kMaxText, "a grid's digest");
        header.length_unit = get_text(in.getLengthUnit(), kMaxText, "a unit");
        header.box = get_box(in.getBox());
        header.rate_hz = in.getRate();
        const auto flags = in.getFlagNames();
        if (flags.size() > kMaxFlags)
          throw FormatError(format("{} flags, the limit is {}", flags.size(), kMaxFlags));
        for (const auto name : flags)
          header.flags.push_back(get_text(name, kMaxText, "a flag's name"));
        header.settings = get_text(in.getSettings(), kMaxSettings, "settings");
        try {
          header.validate();
        } catch (const Error& e) {
          throw FormatError(e.what());
        }
        return header;
      });
}

Message encode_ticks(std::span<const TickRecord> ticks, std::uint64_t dropped) {
  const auto n = static_cast<unsigned>(ticks.size());
  return build(14 * ticks.size() + 64, [&](session_schema::Message::Builder message) {
    auto out = message.initTicks();
    out.setFirst(ticks[0].number);
    out.setDropped(dropped);
    auto skipped = out.initSkipped(n);
    auto flags = out.initFlags(n);
    auto lateness = out.initLateness(n);
    auto compute = out.initCompute(n);
    auto slew = out.initSlewTime(n);
    auto levels = out.initLevels(8 * n);
    for (unsigned i = 0; i < n; ++i) {
      skipped.set(i, i == 0 ? 0 : ticks[i].number - ticks[i - 1].number - 1);
      flags.set(i, ticks[i].flags);
      lateness.set(i, ticks[i].lateness_ns);
      compute.set(i, ticks[i].compute_ns);
      slew.set(i, ticks[i].slew_ns);
      for (unsigned c = 0; c < 8; ++c) levels[c * n + i] = ticks[i].levels[c];
    }
    encode_differences(ticks, &TickRecord::hip, out.initHip(24 * n).begin());
    encode_differences(ticks, &TickRecord::raw_force, out.initRawForce(24 * n).begin());
    encode_force(ticks, out.initForce(24 * n).begin());
  });
}

std::uint64_t decode_ticks(const Message& message, std::vector<TickRecord>& ticks) {
  return read_message<session_schema::Message>(
      message, [&](session_schema::Message::Reader in_message) {
        if (!in_message.isTicks()) throw FormatError("damaged: a chunk of ticks was expected");
        const auto in = in_message.getTicks();
        const std::size_t n = in.getSkipped().size();
        if (n == 0 || n > kChunkTicks)
          throw FormatError(
              format("damaged: a chunk of {} ticks; 1 to {} are possible", n, kChunkTicks));
        const auto skipped = column<std::uint64_t>(in.getSkipped(), n, "skipped");
        const auto flags = column<std::uint32_t>(in.getFlags(), n, "flags");
        const auto lateness = column<std::uint32_t>(in.getLateness(), n, "lateness");
        const auto compute = column<std::uint32_t>(in.getCompute(), n, "compute");
        const bool has_slew = in.hasSlewTime();
        const auto slew = column<std::uint32_t>(in.getSlewTime(), has_slew ? n : 0, "slewTime");
        const auto levels = column(in.getLevels(), 8 * n, "levels");
        const auto hip = column(in.getHip(), 24 * n, "hip");
        const auto raw_force = column(in.getRawForce(), 24 * n, "rawForce");
        const auto force = column(in.getForce(), 24 * n, "force");
        if (skipped[0] != 0)
          throw FormatError("damaged: ticks skipped before the first of a chunk");
        ticks.resize(n);
        std::uint64_t number = in.getFirst();
        for (std::size_t i = 0; i < n; ++i) {
          if (i > 0) {
            const std::uint64_t before = number;
            number += skipped[i] + 1;
            if (number <= before) throw FormatError("damaged: a tick's number is beyond 64 bits");
          }
          ticks[i].number = number;
          ticks[i].flags = flags[i];
          ticks[i].lateness_ns = lateness[i];
          ticks[i].compute_ns = compute[i];
          if (has_slew) ticks[i].slew_ns = slew[i];
          for (std::size_t c = 0; c < 8; ++c) ticks[i].levels[c] = levels[c * n + i];
        }
        decode_differences(hip.data(), &TickRecord::hip, ticks);
        decode_differences(raw_force.data(), &TickRecord::raw_force, ticks);
        decode_force(force.data(), ticks);
        return in.getDropped();
      });
}

}  // namespace hapgrid
