#include "tools/view/grid_page.hpp"

#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <system_error>

#include "libcore/base/error.hpp"
#include "libcore/base/file.hpp"
#include "libcore/base/format.hpp"
#include "libcore/base/text.hpp"
#include "libcore/base/zstd_frame.hpp"
#include "libcore/model/plugin_model.hpp"
#include "libcore/scene/scene.hpp"
#include "tools/page/pack.hpp"
#include "tools/view/page/page.hpp"

namespace hapgrid {

extern const char* const kPagePlayer;  // in hex; embed.cmake makes it

namespace {

// The page keeps itself from asking anybody for anything.
constexpr char kForbids[] =
    "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; script-src "
    "'unsafe-inline' 'wasm-unsafe-eval'; style-src 'unsafe-inline'; img-src data: blob:\">\n";
constexpr double kMostBytes = 20e6;  // what mail and phones still take

/// As deflate has it, with the head of zlib, in base64.
std::string squeezed(const std::string& bytes) {
  uLongf size = ::compressBound(bytes.size());
  std::string deflated(size, '\0');
  if (::compress2(reinterpret_cast<Bytef*>(deflated.data()), &size,
                  reinterpret_cast<const Bytef*>(bytes.data()), bytes.size(), 9) != Z_OK)
    throw std::bad_alloc();
  deflated.resize(size);
  constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve(size / 3 * 4 + 4);
  for (std::size_t i = 0; i < size; i += 3) {
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k)
      bits = bits << 8 | (i + k < size ? static_cast<unsigned char>(deflated[i + k]) : 0U);
    for (std::size_t k = 0; k < 4; ++k)
      text += i + k > size ? '=' : kDigits[bits >> (18 - 6 * k) & 63];
  }
  return text;
}

std::string player_bytes() {
  std::string bytes;
  const auto digit = [](char c) { return c <= '9' ? c - '0' : c - 'a' + 10; };
  for (const char* at = kPagePlayer; *at != '\0'; at += 2)
    bytes += static_cast<char>(digit(at[0]) << 4 | digit(at[1]));
  return bytes;
}

/// What player.js makes frames of.
nlohmann::ordered_json player_data(const PackedGrid& packed, const std::string& grid) {
  const Scene& scene = packed.scene;
  nlohmann::ordered_json data = {
      {"start", packed.first.position},
      {"energy_unit", scene.energy_unit.empty() ? "" : counted_unit(scene.energy_unit, 2)},
      {"force_scale", packed.lowest ? packed.force_scale : 0},
      {"lowest", packed.lowest.value_or(0)},
      {"snaps", packed.snaps},
      {"torsions", nlohmann::json::array()},
      {"grid",
       printable_line(grid == "-" ? scene.model : std::filesystem::path(grid).filename().string())},
      {"version", HAPGRID_VERSION}};
  for (std::size_t i = 0; i < scene.torsions.size(); ++i) {
    const Torsion& t = scene.torsions[i];
    data["torsions"].push_back(
        {t.spheres[1], t.spheres[2], printable_line(t.name, 24), packed.profiles[i]});
  }
  return data;
}

}  // namespace

bool is_grid(const std::string& name) {
  // A pipe is not even opened: its writer would take that for its reader.
  struct stat status {};
  if ((name == "-" ? ::fstat(STDIN_FILENO, &status) : ::stat(name.c_str(), &status)) != 0)
    throw std::system_error(errno, std::generic_category(), name);
  return S_ISREG(status.st_mode) && starts_with_zstd_frame(InputFile(name));
}

std::string grid_page(const std::string& grid, const RenderOptions& render) {
  if (*kPagePlayer == '\0')
    throw Error(
        "--html: this view cannot make a page of a grid, since it was built without clang for "
        "WebAssembly: install clang, lld, wasi-libc, libc++-dev-wasm32, libclang-rt-dev-wasm32, "
        "and build anew");
  const Grid loaded = load_grid(grid);
  const GridSpec& spec = loaded.spec();
  const std::string name = grid == "-" ? "standard input" : grid;
  Camera camera;
  camera.azimuth_degrees = render.azimuth_degrees;
  camera.elevation_degrees = render.elevation_degrees;
  const auto create = [&] { return Plugin(spec.model, model_path()).create(spec.parameters); };
  const PackedGrid packed = pack_grid(loaded, name, create, camera.near());
  nlohmann::ordered_json data = page_scene(packed.scene, packed.first, render);
  data["own"] = player_data(packed, grid);
  std::string text = page_text(
      script_of(data), "",
      format(R"({{"player":"{}","grid":"{}"}})", squeezed(player_bytes()), squeezed(packed.bytes)));
  text.insert(text.find("<title>"), kForbids);
  const auto bytes = static_cast<double>(text.size());
  if (bytes > kMostBytes)
    throw Error(format(
        "{}: its page would have {} MB, and {} MB is the most: a grid of a spacing "
        "of {} would fit",
        name, rounded(bytes / 1e6), kMostBytes / 1e6, spacing_for(spec, kMostBytes / bytes)));
  return text;
}

}  // namespace hapgrid
