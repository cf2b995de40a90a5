#include "tools/stats/vti.hpp"

#include <bit>
#include <cstdint>
#include <limits>
#include <vector>

#include "libcore/base/file.hpp"
#include "libcore/base/format.hpp"
#include "libcore/base/text.hpp"

namespace hapgrid {

static_assert(std::endian::native == std::endian::little);

namespace {

/// An array of point data: `width` numbers from `offset` of the rows.
struct Array {
  std::string name;
  std::uint32_t offset, width;
};

/// Data in pieces, behind their length, as the appended data have them.
template <class T, class Fill>
void write_appended(OutputFile& output, const Grid& grid, std::size_t width, Fill&& fill) {
  const std::uint64_t bytes = grid.box().points() * width * sizeof(T);
  output.write(std::as_bytes(std::span(&bytes, 1)));
  constexpr std::size_t kBuffer = 1 << 17;  // numbers
  std::vector<T> numbers;
  for (PointIndex p = 0; p < grid.box().points(); ++p) {
    fill(p, numbers);
    if (numbers.size() < kBuffer && p + 1 < grid.box().points()) continue;
    output.write(std::as_bytes(std::span(numbers)));
    numbers.clear();
  }
}

std::string header(const Grid& grid, const std::vector<Array>& arrays) {
  const Box& box = grid.box();
  const Vec3& o = box.origin;
  const std::string extent =
      format("0 {} 0 {} 0 {}", box.counts[0] - 1, box.counts[1] - 1, box.counts[2] - 1);
  std::string xml = format(
      "<?xml version=\"1.0\"?>\n"
      "<VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"LittleEndian\" "
      "header_type=\"UInt64\">\n"
      "<ImageData WholeExtent=\"{0}\" Origin=\"{1} {2} {3}\" Spacing=\"{4} {4} {4}\">\n"
      "<Piece Extent=\"{0}\">\n"
      "<PointData Scalars=\"levels\">\n",
      extent, to_text(o[0]), to_text(o[1]), to_text(o[2]), to_text(box.spacing));
  std::uint64_t offset = 0;
  const auto add = [&](const std::string& name, const std::string& type, std::size_t width,
                       std::size_t bytes) {
    xml += format(
        "<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"appended\" "
        "offset=\"{}\"/>\n",
        type, name, width, offset);
    offset += sizeof(std::uint64_t) + box.points() * width * bytes;
  };
  add("levels", "UInt16", 1, sizeof(std::uint16_t));
  for (const Array& array : arrays) add(array.name, "Float64", array.width, sizeof(double));
  return xml + "</PointData>\n</Piece>\n</ImageData>\n<AppendedData encoding=\"raw\">\n_";
}

}  // namespace

void write_vti(const Grid& grid, const std::function<RecordIndex(PointIndex)>& record_at,
               const std::string& name) {
  const GridSpec& spec = grid.spec();
  std::vector<Array> arrays{{"state", 0, spec.state_size}};
  if (spec.stored.force) arrays.push_back({"force", spec.force_offset(), 3});
  if (spec.stored.energy) arrays.push_back({"energy", spec.energy_offset(), 1});
  OutputFile output(name);
  output.write(header(grid, arrays));
  write_appended<std::uint16_t>(output, grid, 1, [&](PointIndex p, std::vector<std::uint16_t>& to) {
    to.push_back(static_cast<std::uint16_t>(grid.levels(p)));
  });
  for (const Array& array : arrays)
    write_appended<double>(output, grid, array.width, [&](PointIndex p, std::vector<double>& to) {
      const RecordIndex record = record_at(p);
      if (record == Grid::kNoRecord) {
        to.insert(to.end(), array.width, std::numeric_limits<double>::quiet_NaN());
        return;
      }
      const auto row = grid.row(record).subspan(array.offset, array.width);
      to.insert(to.end(), row.begin(), row.end());
    });
  output.write("\n</AppendedData>\n</VTKFile>\n");
  output.commit();
}

}  // namespace hapgrid
