// A finished grid into another form: coded or plain.
#pragma once

#include <vector>

#include "libcore/shard/section.hpp"
#include "libcore/shard/writer.hpp"

namespace hapgrid {

/// The coding of a finished grid: without loss where `precision` is 0; else each number may be off
/// by `precision` times the range of its column, for which all records are read once. Numbers that
/// are not finite have no part in a range; a column whose range is not finite is kept as it is.
/// @throw FormatError, std::system_error
Coding final_coding(const std::vector<Section>& grid, double precision);

/// Writes all records of a grid, in order, and finishes the section.
/// @throw FormatError, std::system_error
void copy_records(const std::vector<Section>& grid, SectionWriter& out);

}  // namespace hapgrid
