// The lines of a model process: what it says of itself, then answers to questions. If the first
// line cannot be read as such, all lines are answers of a fixed model.
#include <algorithm>

#include "libcore/model/protocol.hpp"
#include "tests/fuzz/fuzz.hpp"

using namespace hapgrid;

namespace {

void read(std::string_view line, const ModelInfo& model) {
  const Answer answer = read_answer(line);
  std::vector<double> row(model.row_size());
  for (const Operation operation : {Operation::kConvert, Operation::kEvaluate})
    fuzz::refusable([&] { write_row(answer, model, operation, row.data()); });
  fuzz::refusable([&] {
    if (states_of(answer, model).size() % model.state_size != 0)
      throw std::logic_error("half a state");
  });
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  ModelInfo model;
  model.state_size = 2;
  model.stored = {true, true, true};
  model.spheres.resize(1);
  bool first = true;
  for (std::string_view rest = fuzz::text_of({data, size}); !rest.empty();) {
    const std::string_view line = rest.substr(0, rest.find('\n'));
    rest.remove_prefix(std::min(rest.size(), line.size() + 1));
    if (first) fuzz::refusable([&] { model = read_first_line(line); });
    first = false;
    fuzz::refusable([&] { read(line, model); });
  }
  return 0;
}
