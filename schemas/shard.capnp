# The stream format of hapgrid's shards. A shard is a sequence of zstd frames, each with its content
# checksum; each frame holds one Cap'n Proto message with the root Message. A section is a header,
# any number of chunks, and a footer; shards are concatenated by concatenating their sections.
#
#   zstd -dc x.grid | capnp decode schemas/shard.capnp Message
#
# prints any of them. schemas/README.md says how this file may change.
@0xc1d5f0a96e3b7d42;

using Common = import "common.capnp";
using Box = Common.Box;
using Sphere = Common.Sphere;
$Common.namespace("hapgrid::schema");

struct Message {
  union {
    header @0 :Header;
    records @1 :RecordChunk;
    requests @2 :RequestChunk;
    footer @3 :Footer;
    coded @4 :CodedChunk;
    reached @5 :ReachedChunk;
  }
}

struct Header {
  magic @0 :UInt64;
  # 0x6861706772696431, "hapgrid1" in ASCII.

  version @1 :UInt32;
  # Format version: 1, or 2 where `coding` says how the chunks are coded. A reader refuses any other.

  content @2 :Content;

  generation @3 :UInt32;
  # The youngest generation. In a grid, the records of this generation are the frontier; a frontier
  # shard holds some of them, and requests were found from them.

  box @4 :Box;
  model @5 :Text;
  # The plug-in's plain name, never a path; of a model that is a process (equality says so), the
  # name that its user gave it. What to run never stands in a shard.

  parameters @6 :List(Parameter);
  # The model's parameters in full, ascending by key.

  stateSize @7 :UInt32;
  # n, the number of components of a state.

  tolerance @8 :Float64;
  # The bound that the model's tolerance function applies, in toleranceUnit.

  toleranceUnit @9 :Text;

  maxLevels @10 :UInt32;
  # Level limit: how many levels a point may have, 1 to 254.

  stored @11 :Stored;
  # What each record of a grid, and each request, carries beside its state.

  spheres @12 :List(Sphere);
  # The spheres whose centres are stored; empty where the shape is not.

  equality @13 :Equality;
  # The tolerance function, so that merge and verify need no model process.

  lengthUnit @14 :Text;
  energyUnit @15 :Text;
  hipRadius @16 :Float64;
  # For people and pictures; empty or 0 where the model does not say. hipRadius: of the ball that
  # the HIP moves.

  coding @17 :Coding;
  # Of a grid in version 2: its chunks are CodedChunks. Never set in version 1.

  enum Content {
    grid @0;
    # All records that are known.
    frontier @1;
    # A part of the frontier's conversions: records with the directions to be expanded.
    requests @2;
  }
}

struct Equality {
  norm @0 :Norm;
  weights @1 :List(Float64);
  # One a component of the state, finite and not negative; empty: all 1.

  enum Norm {
    plugin @0;
    # The model is a plug-in, and its own function decides.
    max @1;
    # The model is a process; states a and b are equal when max_c w_c |a_c - b_c| <= tolerance.
    rms @2;
    # The same, with sqrt((1/n) sum_c (w_c (a_c - b_c))^2) <= tolerance.
  }
}

struct Stored {
  force @0 :Bool;
  energy @1 :Bool;
  shape @2 :Bool;
}

struct Coding {
  precision @0 :Float64;
  # 0: the numbers are the plain grid's, bit by bit. Else they may be off by this share of the
  # range that each column of the numbers has in the whole grid.

  bounds @1 :List(Float64);
  # Where precision is not 0: by how much each column of the numbers may be off, in its own unit;
  # 0: not at all. One a column, in the order of CodedChunk.
}

struct Parameter {
  key @0 :Text;
  # Tables are flattened: "probe.radius".

  value :union {
    boolean @1 :Bool;
    number @2 :Float64;
    text @3 :Text;
    numbers @4 :List(Float64);
    texts @5 :List(Text);
  }
}

# Chunks are columnar: entry r of each column belongs to row r, and a chunk is near 256 KiB, of a
# grid near 64 KiB. In a grid a chunk never crosses a multiple of the points that one chunk holds at one
# level a point, so that a change of one record leaves the other chunks' bytes alone; but in a layer,
# or the tip, of a grid (merge --layer), which never changes, it ends where it is full.
#
# A grid can be in several sections, with each record in one of them; those that have no frontier may be of
# older generations.

struct RecordChunk {
  # Records ascend by (point, level) through a section.

  point @0 :List(UInt32);
  # p = i + nx (j + ny k).

  level @1 :Data;
  # One byte a record.

  generation @2 :List(UInt32);
  # The round in which the record was stored; 0 are the seed records.

  state @3 :List(Float64);
  # Component by component: component c of row r is state[c * rows + r].

  links @4 :Data;
  # Grids only. 26 bytes a record, q ascending: the destination level in direction
  # q = (d1+1) + 3 (d2+1) + 9 (d3+1), the centre left out; 255 where the direction leaves the box,
  # 254 where it is not settled yet (the record is in the frontier).

  todo @5 :List(UInt32);
  # Frontier shards only. Bit q: the direction q is to be expanded by the taker of this shard.

  force @6 :List(Float64);
  energy @7 :List(Float64);
  shape @8 :List(Float32);
  # Grids only, where the header says that they are stored; else empty. Force on the HIP in newtons
  # (3 components), energy (1), centres of the spheres (x y z by sphere), each component by
  # component like the states.
}

struct CodedChunk {
  # A RecordChunk of a finished grid, made small: schemas/CODING.md says how to get the records
  # back. "Planes" of 4-byte integers are the lowest byte of all rows, then the next byte, and so on.

  rows @0 :UInt32;

  point @1 :Data;
  # Each row's point minus that of the row before it (0 before the first), as 4 planes.

  level @2 :Data;
  links @3 :Data;
  # As in RecordChunk.

  generation @4 :Data;
  # Each row's generation minus that of the row before it, modulo 2^32 and zigzag, as 4 planes.

  order @5 :Data;
  shift @6 :Data;
  planes @7 :Data;
  # One byte each for each column of numbers: the state's components, force (3), energy (1), shape.
  # order: how its values are predicted, i + 4 j + 16 k; shift: how many of the lowest bits are 0 in
  # each value, 0 to 52, or 255: the values are multiples of the column's step; planes: bytes a row
  # in `residuals`, 0 to 8.

  residuals @8 :Data;
  # Column by column, each as so many planes.

  first @9 :Data;
  # 8 bytes for each column, little-endian: the value of its first row; with shift 255 the multiple.
}

struct RequestChunk {
  # How requests were written before ReachedChunk, ascending by target. Not read any more.

  target @0 :List(UInt32);
  direction @1 :Data;
  level @2 :Data;
  state @3 :List(Float64);
  force @4 :List(Float64);
  energy @5 :List(Float64);
  shape @6 :List(Float32);
}

struct ReachedChunk {
  # What conversions reached: the requests of source records, which ascend by (point, level) through
  # a section. A request's target is point + offset(q), where offset = d1 + nx (d2 + ny d3).

  point @0 :List(UInt32);
  level @1 :Data;
  # Of the source record; one byte a record.

  directions @2 :List(UInt32);
  # Bit q: the request in direction q is here. All these bits, record by record and q ascending, are
  # the requests of the chunk.

  state @3 :List(Float64);
  # The state reached; component by component: component c of request i is state[c * requests + i].

  force @4 :List(Float64);
  energy @5 :List(Float64);
  shape @6 :List(Float32);
  # What is stored with the state reached, as in RecordChunk.
}

struct Footer {
  chunks @0 :List(ChunkInfo);
  # The messages between header and footer, in order.

  records @1 :UInt64;
  requests @2 :UInt64;

  frontier @3 :UInt64;
  # Records whose generation is the header's: no expand has looked at them yet.

  conversions @4 :UInt64;
  # Conversions that the section's frontier asks for.

  digestLow @5 :UInt64;
  digestHigh @6 :UInt64;
  # XXH3-128 (seed 0) of the section's decoded content: of the header's message, followed by the
  # digests of the chunks, each as its low and its high word, little-endian. So a chunk that a round
  # does not touch is copied without being decoded.
}

struct ChunkInfo {
  rows @0 :UInt32;

  frontier @1 :UInt32;
  # How many of its records are in the frontier: expand passes over a chunk without any.

  firstPoint @2 :UInt32;
  lastPoint @3 :UInt32;
  # Of requests: of their source records.

  digestLow @4 :UInt64;
  digestHigh @5 :UInt64;
  # XXH3-128 of the chunk's message.

  stored @6 :UInt64;
  # XXH3-64 of the chunk's frame as it is stored: what a copy checks instead of decoding.

  conversions @7 :UInt32;
  # What its frontier asks for: expand passes over what comes before its part. 0 is not known where
  # there is a frontier: shards of before this field have it.
}
