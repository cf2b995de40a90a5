// Between CodedChunk and Cap'n Proto's builder and reader. Only for the sources of this folder.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libcore/shard/coding.hpp"
#include "shard.capnp.h"

namespace hapgrid {

inline void encode_coded(const CodedChunk<std::vector<std::uint8_t>>& coded,
                         schema::CodedChunk::Builder out) {
  const auto bytes = [](const std::vector<std::uint8_t>& column) {
    return kj::arrayPtr(column.data(), column.size());
  };
  out.setRows(coded.rows);
  out.setPoint(bytes(coded.point));
  out.setLevel(bytes(coded.level));
  out.setLinks(bytes(coded.links));
  out.setGeneration(bytes(coded.generation));
  out.setOrder(bytes(coded.order));
  out.setShift(bytes(coded.shift));
  out.setPlanes(bytes(coded.planes));
  out.setResiduals(bytes(coded.residuals));
  out.setFirst(bytes(coded.first));
}

/// The columns look into the message.
inline CodedChunk<std::span<const std::uint8_t>> decode_coded(schema::CodedChunk::Reader in) {
  const auto bytes = [](capnp::Data::Reader data) {
    return std::span<const std::uint8_t>(data.begin(), data.size());
  };
  CodedChunk<std::span<const std::uint8_t>> coded;
  coded.rows = in.getRows();
  coded.point = bytes(in.getPoint());
  coded.level = bytes(in.getLevel());
  coded.links = bytes(in.getLinks());
  coded.generation = bytes(in.getGeneration());
  coded.order = bytes(in.getOrder());
  coded.shift = bytes(in.getShift());
  coded.planes = bytes(in.getPlanes());
  coded.residuals = bytes(in.getResiduals());
  coded.first = bytes(in.getFirst());
  return coded;
}

}  // namespace hapgrid
