// Messages of schemas/session.capnp.
#include "libcore/base/message.hpp"

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

#include "libcore/base/error.hpp"
#include "libcore/base/format.hpp"
#include "libcore/base/text.hpp"
#include "libcore/grid/box_message.hpp"
#include "libcore/session/format.hpp"
#include "libcore/session/session.hpp"
#include "session.capnp.h"

namespace hapgrid {

namespace {

// A hand moves smoothly: from tick to tick sign, exponent and the upper bits of the fraction hardly
// change. But zstd, which looks for repeated bytes, does not see that through the noise of the
// lower bits. The difference of neighbours has zeros in place of the bits that stay the same, and
// bytes of one significance side by side keep the zeros together. schemas/session.capnp defines
// each bit.

/// Signed differences as small numbers: 0, -1, 1, -2, ... are 0, 1, 2, 3, ...
constexpr std::uint64_t zigzag(std::uint64_t difference) {
  return difference << 1 ^ (0 - (difference >> 63));
}
constexpr std::uint64_t unzigzag(std::uint64_t z) { return z >> 1 ^ (0 - (z & 1)); }

/// Byte b of the number i of n is at b n + i.
void put_bytes(std::uint8_t* to, std::size_t n, std::size_t i, std::uint64_t u) {
  for (std::size_t b = 0; b < 8; ++b) to[b * n + i] = static_cast<std::uint8_t>(u >> 8 * b);
}
std::uint64_t get_bytes(const std::uint8_t* from, std::size_t n, std::size_t i) {
  std::uint64_t u = 0;
  for (std::size_t b = 0; b < 8; ++b) u |= std::uint64_t{from[b * n + i]} << 8 * b;
  return u;
}

/// Three columns of differences to the tick before; `to` has 24 bytes a tick.
void encode_differences(std::span<const TickRecord> ticks, Vec3 TickRecord::*member,
                        std::uint8_t* to) {
  const std::size_t n = ticks.size();
  for (int axis = 0; axis < 3; ++axis, to += 8 * n)
    for (std::uint64_t i = 0, before = 0; i < n; ++i) {
      const auto bits = std::bit_cast<std::uint64_t>((ticks[i].*member)[axis]);
      put_bytes(to, n, i, zigzag(bits - before));
      before = bits;
    }
}
void decode_differences(const std::uint8_t* from, Vec3 TickRecord::*member,
                        std::span<TickRecord> ticks) {
  const std::size_t n = ticks.size();
  for (int axis = 0; axis < 3; ++axis, from += 8 * n)
    for (std::uint64_t i = 0, bits = 0; i < n; ++i) {
      bits += unzigzag(get_bytes(from, n, i));
      (ticks[i].*member)[axis] = std::bit_cast<double>(bits);
    }
}

/// Three columns of the bits in which the force differs from the raw one; `to` has 24 bytes a tick.
void encode_force(std::span<const TickRecord> ticks, std::uint8_t* to) {
  const std::size_t n = ticks.size();
  for (int axis = 0; axis < 3; ++axis, to += 8 * n)
    for (std::size_t i = 0; i < n; ++i)
      put_bytes(to, n, i,
                std::bit_cast<std::uint64_t>(ticks[i].force[axis]) ^
                    std::bit_cast<std::uint64_t>(ticks[i].raw_force[axis]));
}
void decode_force(const std::uint8_t* from, std::span<TickRecord> ticks) {
  const std::size_t n = ticks.size();
  for (int axis = 0; axis < 3; ++axis, from += 8 * n)
    for (std::size_t i = 0; i < n; ++i)
      ticks[i].force[axis] = std::bit_cast<double>(
          get_bytes(from, n, i) ^ std::bit_cast<std::uint64_t>(ticks[i].raw_force[axis]));
}

constexpr std::uint64_t kMagic = 0x6861706772696473;  // "hapgrids"
constexpr std::uint32_t kFormatVersion = 2;
constexpr double kMinRate = 1e-6;  // so that times and numbers of ticks are far from overflow
constexpr double kMaxRate = 1e9;
constexpr std::size_t kMaxText = 255;  // bytes of a name, unit or digest

template <class Fill>
MessageWords build(std::size_t words, Fill&& fill) {
  MessageWords scratch, message;
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

MessageWords encode_header(const SessionHeader& header) {
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

namespace {
bool begins_session(session_schema::Message::Reader message) {
  return message.isHeader() && message.getHeader().getMagic() == kMagic;
}
}  // namespace

bool is_header(const MessageWords& message) {
  return read_message<session_schema::Message>(message, begins_session);
}

SessionHeader decode_header(const MessageWords& message) {
  return read_message<session_schema::Message>(
      message, [](session_schema::Message::Reader in_message) {
        if (!begins_session(in_message)) throw FormatError("not a session");
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

MessageWords encode_ticks(std::span<const TickRecord> ticks, std::uint64_t dropped) {
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

std::uint64_t decode_ticks(const MessageWords& message, std::vector<TickRecord>& ticks) {
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
