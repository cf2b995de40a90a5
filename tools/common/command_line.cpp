#include "tools/common/command_line.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <sstream>
#include <utility>

namespace hapgrid {

namespace {

constexpr std::size_t kColumns = 100;
constexpr std::size_t kNameColumns = 32;

/// The columns that UTF-8 takes; none of our texts has wide characters.
std::size_t columns(const std::string& text) {
  std::size_t n = 0;
  for (const char c : text) n += (static_cast<unsigned char>(c) & 0xc0) != 0x80;
  return n;
}

/// Where a line's text goes on: below what follows its last run of blanks, which in the list of
/// options is the description.
std::size_t hanging_indent(const std::string& line) {
  const std::size_t blanks = line.rfind("  ");
  return blanks == std::string::npos ? 0 : blanks + 2;
}

std::string wrapped(std::string line) {
  const std::size_t indent = hanging_indent(line);
  std::string text;
  while (columns(line) > kColumns) {
    std::size_t cut = line.rfind(' ', kColumns);
    if (cut == std::string::npos || cut <= indent) cut = line.find(' ', indent);
    if (cut == std::string::npos) break;
    text += line.substr(0, cut) + "\n";
    line = std::string(indent, ' ') + line.substr(cut + 1);
  }
  return text + line;
}

class HelpFormatter : public CLI::Formatter {
 public:
  HelpFormatter() { column_width(kNameColumns); }

  std::string make_help(const CLI::App* app, std::string name,
                        CLI::AppFormatMode mode) const override {
    std::istringstream lines(Formatter::make_help(app, name, mode));
    std::string help;
    bool blank = false;
    for (std::string line; std::getline(lines, line);) {
      if (!blank || !line.empty()) help += wrapped(line) + "\n";
      blank = line.empty();
    }
    return help;
  }
};

/// As CLI::App::add_option() does it, in a tenth of the templates.
template <class Value>
CLI::Option* add_value(CLI::App& app, const std::string& names, Value& value,
                       const std::string& help) {
  return app.add_option(
      names,
      [&value](const CLI::results_t& given) {
        return CLI::detail::lexical_cast(given.back(), value);
      },
      help, false, [&value] { return CLI::detail::to_string(value); });
}

/// How many letters have to be put in, left out or replaced to make the one of the other.
std::size_t edits(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t before = std::exchange(row[0], i);
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = before + (a[i - 1] != b[j - 1]);
      before = std::exchange(row[j], std::min({row[j] + 1, row[j - 1] + 1, replaced}));
    }
  }
  return row.back();
}

/// The option that is nearest to one that there is not, in words; empty when none is near.
std::string suggestion(const CLI::App& app) {
  std::string nearest;
  std::size_t least = 3;  // letters
  for (const std::string& given : app.remaining()) {
    const std::string name = given.substr(0, given.find('='));
    if (name.rfind("--", 0) != 0) continue;
    for (const CLI::Option* option : app.get_options())
      for (const std::string& known : option->get_lnames())
        if (const std::size_t far = edits(name, "--" + known); far < least) {
          least = far;
          nearest = "--" + known;
        }
  }
  return nearest.empty() ? "" : "; did you mean " + nearest + "?";
}

}  // namespace

Option& Option::type(const std::string& name) {
  option_->type_name(name);
  return *this;
}

Option& Option::required() {
  option_->required();
  return *this;
}

Option& Option::shows_default() {
  option_->capture_default_str();
  return *this;
}

Option& Option::repeatable() {
  option_->expected(1)->allow_extra_args(
      false);  // the argument after the value is not another value
  option_->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  return *this;
}

Option& Option::comma_separated() {
  option_->delimiter(',');
  return *this;
}

Option& Option::needs(const Option& other) {
  option_->needs(other.option_);
  return *this;
}

Option& Option::excludes(const Option& other) {
  option_->excludes(other.option_);
  return *this;
}

Option& Option::check(std::function<bool(const std::string&)> good,
                      const std::string& description) {
  option_->check([good = std::move(good), description](const std::string& text) {
    return good(text) ? std::string() : "'" + text + "' is not " + description;
  });
  return *this;
}

Option& Option::one_of(const std::vector<std::string>& texts) {
  option_->check(CLI::IsMember(texts));
  return *this;
}

Option& Option::positive() {
  option_->check(CLI::PositiveNumber);
  return *this;
}

Option& Option::whole(std::int64_t low, std::int64_t high, bool shown) {
  CLI::Validator range = CLI::Range(low, high);
  option_->check(shown ? range : range.description(""));
  return *this;
}

Option& Option::within(double low, double high, const std::string& description) {
  const auto is_within = [=](const std::string& text) {
    double value = std::nan("");
    return CLI::detail::lexical_cast(text, value) && value >= low && value <= high;
  };
  return check(is_within, description);
}

CommandLine::CommandLine(const std::string& about) : app_(std::make_unique<CLI::App>(about)) {}
CommandLine::~CommandLine() = default;

Option CommandLine::add(const std::string& names, std::string& value, const std::string& help) {
  return Option(add_value(*app_, names, value, help)->type_name("TEXT"));
}

Option CommandLine::add(const std::string& names, double& value, const std::string& help) {
  return Option(add_value(*app_, names, value, help));
}

Option CommandLine::add(const std::string& names, std::optional<double>& value,
                        const std::string& help) {
  return Option(app_->add_option(
      names,
      [&value](const CLI::results_t& given) {
        return CLI::detail::lexical_cast(given.back(), value.emplace());
      },
      help));
}

Option CommandLine::add(const std::string& names, int& value, const std::string& help) {
  return Option(add_value(*app_, names, value, help));
}

Option CommandLine::add(const std::string& names, unsigned& value, const std::string& help) {
  return Option(add_value(*app_, names, value, help));
}

Option CommandLine::add(const std::string& names, std::uint64_t& value, const std::string& help) {
  return Option(add_value(*app_, names, value, help));
}

Option CommandLine::add(const std::string& names, std::vector<std::string>& values,
                        const std::string& help) {
  const auto take = [&values](const CLI::results_t& given) {
    values = given;
    return true;
  };
  return Option(app_->add_option(names, take, help)
                    ->type_name("TEXT")
                    ->expected(CLI::detail::expected_max_vector_size));
}

Option CommandLine::add(const std::string& names, std::function<void(const std::string&)> take,
                        const std::string& help) {
  const auto take_all = [take = std::move(take)](const CLI::results_t& given) {
    for (const std::string& text : given) take(text);
    return true;
  };
  return Option(app_->add_option(names, take_all, help)->type_name("TEXT"));
}

Option CommandLine::add_flag(const std::string& name, bool& value, const std::string& help) {
  return Option(app_->add_flag(name, value, help));
}

Option CommandLine::add_flag(const std::string& name, std::string& value, const std::string& help) {
  return Option(app_->add_flag(name, value, help));
}

void CommandLine::group(const std::string& name) { app_->option_defaults()->group(name); }
Option CommandLine::option(const std::string& name) { return Option(app_->get_option(name)); }
bool CommandLine::has(const std::string& name) const { return app_->get_option_no_throw(name); }
bool CommandLine::given(const std::string& name) const { return app_->count(name) > 0; }

void CommandLine::set_help(const std::string& name, const std::string& details,
                           const std::string& more_exits) {
  app_->name(name);
  app_->set_version_flag("-V,--version", "hapgrid " + name + " " HAPGRID_VERSION,
                         "Print the version and exit")
      ->group("Options");
  app_->formatter(std::make_shared<HelpFormatter>());
  app_->footer(details + (details.empty() ? "" : "\n") +
               "Exit codes:\n"
               "  0  done\n"
               "  1  could not: input, I/O, model, device, level limit\n"
               "  2  the command line is wrong; nothing was read or written\n" +
               more_exits);
}

std::string CommandLine::name() const { return app_->get_name(); }

std::optional<std::string> CommandLine::parse(int argc, char** argv) {
  try {
    app_->parse(argc, argv);
    return std::nullopt;
  } catch (const CLI::Success& e) {
    std::ostringstream text;
    app_->exit(e, text, text);
    return text.str();
  } catch (const CLI::ExtrasError& e) {
    throw UsageError(e.what() + suggestion(*app_));
  } catch (const CLI::ParseError& e) {
    throw UsageError(e.what());
  }
}

}  // namespace hapgrid
