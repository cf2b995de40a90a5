#include "libcore/model/definition.hpp"

#include <algorithm>
#include <sstream>
#include <string_view>

#include "libcore/base/error.hpp"
#include "libcore/base/format.hpp"
#include "libcore/base/toml.hpp"
#include "libcore/model/model.hpp"

namespace hapgrid {

namespace {

class Reader : private TomlFile {
 public:
  Reader(const std::string& text, const std::string& name,
         const std::vector<std::string>& overrides)
      : TomlFile(text, name) {
    for (const std::string& entry : overrides) set(entry);
  }

  Definition read(const std::function<std::string(const std::string&)>& read_file) const {
    Definition d;
    only_keys(root(), "", {"model", "grid", "search", "seeds", "play"});
    const toml::table& model = table(root(), "model");
    only_keys(model, "model.", {"plugin", "process", "name", "timeout", "parameters", "files"});
    if (model.contains("process")) {
      process(model, d);
    } else {
      d.model = text(required(model, "model.", "plugin"), "model.plugin");
      if (const toml::node* name = model.get("name"))
        fail(*name, "model.name is for a model.process; a plug-in has its own");
      if (const toml::node* timeout = model.get("timeout"))
        fail(*timeout, "model.timeout is for a model.process");
    }
    if (model.contains("parameters")) parameters(table(model, "parameters"), "", d.parameters);
    if (model.contains("files")) files(table(model, "files"), read_file, d.parameters);
    std::sort(d.parameters.begin(), d.parameters.end(),
              [](const Parameter& a, const Parameter& b) { return a.key < b.key; });

    const toml::table& grid = table(root(), "grid");
    only_keys(grid, "grid.", {"origin", "spacing", "counts"});
    d.box.origin = position(required(grid, "grid.", "origin"), "grid.origin");
    d.box.spacing = number(required(grid, "grid.", "spacing"), "grid.spacing");
    const toml::array& counts = array(required(grid, "grid.", "counts"), "grid.counts");
    if (counts.size() != 3) fail(counts, "grid.counts has three entries");
    for (int a = 0; a < 3; ++a)
      d.box.counts[a] = static_cast<std::uint32_t>(
          whole(*counts.get(a), "grid.counts", 1, std::int64_t{0xffffffff}));
    try {
      d.box.validate();
    } catch (const Error& e) {
      fail(grid, e.what());
    }

    if (root().contains("search")) {
      const toml::table& search = table(root(), "search");
      only_keys(search, "search.", {"max_levels", "store"});
      if (const toml::node* limit = search.get("max_levels"))
        d.max_levels =
            static_cast<std::uint32_t>(whole(*limit, "search.max_levels", 1, kMaxLevels));
      if (search.contains("store")) d.store = store(array(*search.get("store"), "search.store"));
    }
    if (root().contains("seeds")) seeds(table(root(), "seeds"), d.seeds);
    return d;
  }

  Definition read_process() const {
    const toml::table& model = table(root(), "model");
    if (!model.contains("process")) fail(model, "the key model.process is missing");
    Definition d;
    process(model, d);
    return d;
  }

 private:
  /// Sets one "key=value".
  void set(const std::string& entry) {
    const std::size_t equals = entry.find('=');
    if (equals == std::string::npos || equals == 0)
      throw Error(format("--set {}: needs the form key=value", entry));
    const std::string key = entry.substr(0, equals);
    const std::string value = entry.substr(equals + 1);
    toml::table parsed{{"value", value}};
    try {
      parsed = TomlFile("value = " + value, key).root();
    } catch (const Error&) {  // a word without quotes is a text
    }
    if (parsed.size() != 1) throw Error(format("--set {}: more than one value", entry));
    toml::table* at = &root();
    std::istringstream parts(key);
    std::vector<std::string> names;
    for (std::string part; std::getline(parts, part, '.');) names.push_back(part);
    if (std::count(names.begin(), names.end(), "") > 0 || key.back() == '.')
      throw Error(format("--set {}: an empty key", entry));
    for (std::size_t i = 0; i + 1 < names.size(); ++i) {
      toml::node* next = at->get(names[i]);
      if (!next) next = &at->insert(names[i], toml::table{}).first->second;
      at = next->as_table();
      if (!at) throw Error(format("--set {}: {} is no table", entry, names[i]));
    }
    at->insert_or_assign(names.back(), *parsed.get("value"));
  }

  Stored store(const toml::array& names) const {
    Stored stored;
    for (const toml::node& node : names) {
      const std::string name = text(node, "search.store");
      if (name != "energy" && name != "force" && name != "shape")
        fail(node, format("search.store names {}; energy, force and shape are possible", name));
      (name == "energy" ? stored.energy : name == "force" ? stored.force : stored.shape) = true;
    }
    return stored;
  }

  Vec3 position(const toml::node& node, const std::string& key) const {
    const std::vector<double> values = numbers(node, key);
    if (values.size() != 3) fail(node, key + " has three entries");
    return {values[0], values[1], values[2]};
  }

  void process(const toml::table& model, Definition& d) const {
    if (const toml::node* plugin = model.get("plugin"))
      fail(*plugin, "model.plugin and model.process exclude each other");
    const toml::node& name = required(model, "model.", "name");
    d.model = text(name, "model.name");
    if (!is_valid_name(d.model))
      fail(name, format("model.name '{}': it has only letters, digits, '-' and '_'", d.model));
    const toml::array& words = array(*model.get("process"), "model.process");
    for (const toml::node& word : words) {
      d.command.push_back(text(word, "model.process"));
      if (d.command.back().find('\0') != std::string::npos)
        fail(word, "model.process has a text with a zero byte");
    }
    if (words.empty() || d.command.front().empty()) fail(words, "model.process names no program");
    if (const toml::node* timeout = model.get("timeout")) {
      d.timeout_seconds = number(*timeout, "model.timeout");
      if (!(d.timeout_seconds > 0 && d.timeout_seconds <= 1e6))
        fail(*timeout, "model.timeout is above 0 and at most 1000000 s");
    }
  }

  void parameters(const toml::table& in, const std::string& prefix,
                  std::vector<Parameter>& out) const {
    for (const auto& [k, node] : in) {
      const std::string key = prefix + std::string(k.str());
      const std::string shown = "model.parameters." + key;
      if (node.is_table()) {
        parameters(*node.as_table(), key + ".", out);
      } else if (node.is_boolean()) {
        out.push_back({key, **node.as_boolean()});
      } else if (node.is_number()) {
        out.push_back({key, number(node, shown)});
      } else if (node.is_string()) {
        out.push_back({key, text(node, shown)});
      } else if (node.is_array()) {
        const toml::array& entries = *node.as_array();
        if (!entries.empty() && entries.get(0)->is_string()) {
          std::vector<std::string> texts;
          for (const toml::node& entry : entries) texts.push_back(text(entry, shown));
          out.push_back({key, std::move(texts)});
        } else {
          out.push_back({key, numbers(node, shown)});
        }
      } else {
        fail(node,
             shown + " must be a number, a text, true or false, or an array of numbers or texts");
      }
    }
  }

  void files(const toml::table& in, const std::function<std::string(const std::string&)>& read_file,
             std::vector<Parameter>& out) const {
    std::size_t bytes = 0;
    const auto contents = [&](const toml::node& node, const std::string& shown) {
      std::string text_of_file = read_file(text(node, shown));
      if (text_of_file.find('\0') != std::string::npos) fail(node, shown + ": is no text file");
      bytes += text_of_file.size();
      if (bytes > kMaxFileBytes)
        fail(node,
             format("the files of [model.files] have more than {} bytes in all", kMaxFileBytes));
      return text_of_file;
    };
    for (const auto& [k, node] : in) {
      const std::string key(k.str());
      const std::string shown = "model.files." + key;
      if (std::any_of(out.begin(), out.end(), [&](const Parameter& p) { return p.key == key; }))
        fail(node, key + " is both in [model.parameters] and in [model.files]");
      if (!node.is_array()) {
        out.push_back({key, contents(node, shown)});
        continue;
      }
      std::vector<std::string> texts;
      for (const toml::node& entry : *node.as_array()) texts.push_back(contents(entry, shown));
      out.push_back({key, std::move(texts)});
    }
  }

  void seeds(const toml::table& in, std::vector<SeedDefinition>& out) const {
    only_keys(in, "seeds.", {"points", "states"});
    const toml::array& points = array(required(in, "seeds.", "points"), "seeds.points");
    if (points.empty()) fail(points, "seeds.points is empty");
    for (const toml::node& point : points) out.push_back({position(point, "seeds.points"), {}});
    const toml::node* states = in.get("states");
    if (!states) return;
    const toml::array& lists = array(*states, "seeds.states");
    if (lists.size() != out.size())
      fail(lists, format("seeds.states has {} entries for {} points", lists.size(), out.size()));
    for (std::size_t i = 0; i < out.size(); ++i) {
      for (const toml::node& state : array(*lists.get(i), "seeds.states"))
        out[i].states.push_back(numbers(state, "seeds.states"));
      if (out[i].states.empty()) fail(*lists.get(i), "seeds.states has a point without a state");
    }
  }
};

}  // namespace

Definition read_definition(const std::string& text, const std::string& name,
                           const std::vector<std::string>& overrides,
                           const std::function<std::string(const std::string&)>& read_file) {
  return Reader(text, name, overrides).read(read_file);
}

Definition read_process(const std::string& text, const std::string& name) {
  return Reader(text, name, {}).read_process();
}

}  // namespace hapgrid
