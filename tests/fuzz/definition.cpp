// MODEL.toml; behind a zero byte, an override. No file is read: what one would say is up to the
// model.
#include "libcore/model/definition.hpp"

#include "tests/fuzz/fuzz.hpp"

using namespace hapgrid;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view all = fuzz::text_of({data, size});
  const std::size_t zero = all.find('\0');
  const std::string text(all.substr(0, zero));
  std::vector<std::string> overrides;
  if (zero != all.npos) overrides.emplace_back(all.substr(zero + 1));
  const auto no_file = [](const std::string& name) -> std::string {
    throw Error(name + ": no file here");
  };
  fuzz::refusable([&] { read_definition(text, "fuzz", overrides, no_file); });
  fuzz::refusable([&] { read_process(text, "fuzz"); });
  return 0;
}
