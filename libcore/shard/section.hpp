// Which sections an input holds, known from their headers and footers.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "libcore/base/file.hpp"
#include "libcore/shard/format.hpp"

namespace hapgrid {

/// One section of an input, known from its header and footer.
struct Section {
  std::shared_ptr<const InputFile> file;
  std::uint64_t begin = 0;         ///< offset behind the header's frame
  std::uint64_t end = 0;           ///< offset behind the footer's frame
  std::uint64_t stored_bytes = 0;  ///< of the whole section
  SectionHeader header;
  SectionFooter footer;
};

/// The sections of all inputs, by input and place. Only headers and footers are decoded.
/// @throw FormatError when an input is empty, truncated or damaged, or when the headers do not
/// describe the same grid; std::system_error.
std::vector<Section> open_sections(const std::vector<std::string>& names);
/// Of one input.
std::vector<Section> open_sections(const std::shared_ptr<const InputFile>& file);

/// The generation of what the sections hold together: the youngest.
std::uint32_t generation_of(const std::vector<Section>& sections);

/// @throw FormatError, naming input and content, unless every section holds `content`; and unless
/// all are of one generation. A part of a grid may be older than the others if it has no frontier:
/// the last rounds did not come near it.
void require_content(const std::vector<Section>& sections, Content content);

/// @throw FormatError where numbers may be off by other bounds in one section than in another.
void require_same_precision(const std::vector<Section>& sections);
/// @throw FormatError where the numbers of a section may be off: nothing can be computed from them.
void require_lossless(const std::vector<Section>& sections);

}  // namespace hapgrid
