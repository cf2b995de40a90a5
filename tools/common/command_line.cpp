#include "tools/common/command_line.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <sstream>
#include <system_error>
#include <utility>

#include "libcore/base/text.hpp"
#include "tools/common/spelling.hpp"

namespace hapgrid {

namespace {

constexpr std::size_t kColumns = 80;
constexpr std::size_t kNameColumns = 24;

/// `text` in lines of at most kColumns, which begin with `indent` blanks, but for the first line.
std::string filled(const std::string& text, std::size_t indent) {
  std::istringstream words(text);
  std::string lines, line;
  for (std::string word; words >> word;) {
    if (!line.empty() && indent + text_width(line) + 1 + text_width(word) > kColumns) {
      lines += line + "\n" + std::string(indent, ' ');
      line.clear();
    }
    line += (line.empty() ? "" : " ") + word;
  }
  return lines + line;
}

/// A line of a footer. The text of one such as "  NAME  TEXT" goes on below itself; any other is
/// part of a text that has line ends of its own.
std::string wrapped(const std::string& line) {
  if (text_width(line) <= kColumns || !line.starts_with("  ")) return line;
  const std::size_t indent = line.rfind("  ") + 2;
  const std::string begin = line.substr(0, indent);
  return begin + filled(line.substr(indent), text_width(begin));
}

/// "-o, --output FILE", "--terminal[=MODE]", or "GRID" for a positional.
std::string option_name(const CLI::Option& option) {
  std::string value = option.get_type_name();
  if (option.get_positional()) return value;
  std::string name;
  for (const std::string& letter : option.get_snames()) name += "-" + letter + ", ";
  name += "--" + option.get_lnames().at(0);
  if (value.empty()) return name;
  return option.get_items_expected_min() == 0 ? name + "[=" + value + "]" : name + " " + value;
}

std::string option_text(const CLI::Option& option) {
  std::string text = option.get_description();
  if (text.back() != '.' && text.back() != '?') text += '.';
  const std::string value = option.get_default_str();
  return value.empty() ? text : text + " Default: " + value + ".";
}

std::string option_entry(const CLI::Option& option) {
  std::string name = "  " + option_name(option);
  const std::size_t width = text_width(name);
  if (width + 2 > kNameColumns)
    name += "\n" + std::string(kNameColumns, ' ');
  else
    name.append(kNameColumns - width, ' ');
  return name + filled(option_text(option), kNameColumns) + "\n";
}

/// What the program does, how it is called, and a sentence for each option, in at most 80 columns.
class HelpFormatter : public CLI::FormatterBase {
 public:
  std::string make_help(const CLI::App* app, std::string, CLI::AppFormatMode) const override {
    std::string usage = "hapgrid " + app->get_name() + " [OPTION...]";
    std::string positionals;
    for (const CLI::Option* option : app->get_options()) {
      if (!option->get_positional()) continue;
      const std::string name =
          option->get_type_name() + (option->get_items_expected_max() > 1 ? "..." : "");
      usage += option->get_required() ? " " + name : " [" + name + "]";
      positionals += option_entry(*option);
    }
    std::string help = filled(app->get_description(), 0) + "\n\nUsage: " + usage + "\n";
    if (!positionals.empty()) help += "\nArguments:\n" + positionals;
    for (const std::string& group : app->get_groups()) {
      std::string entries;
      for (const CLI::Option* option : app->get_options())
        if (option->nonpositional() && option->get_group() == group)
          entries += option_entry(*option);
      if (!entries.empty()) help += "\n" + group + ":\n" + entries;
    }
    std::istringstream footer("\n" + app->get_footer());
    for (std::string line; std::getline(footer, line);) help += wrapped(line) + "\n";
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

/// The option that is nearest to one that there is not, in words; empty when none is near.
std::string suggestion(const CLI::App& app) {
  std::vector<std::string> known;
  for (const CLI::Option* option : app.get_options())
    for (const std::string& name : option->get_lnames()) known.push_back("--" + name);
  for (const std::string& given : app.remaining()) {
    const std::string name = given.substr(0, given.find('='));
    if (name.rfind("--", 0) != 0) continue;
    if (const auto near = nearest(name, known)) return "; did you mean " + known[*near] + "?";
  }
  return "";
}

}  // namespace

bool same_file(const std::string& a, const std::string& b) {
  std::error_code ignored;  // when one of them does not exist they are not the same
  return !a.empty() && (a == b || std::filesystem::equivalent(a, b, ignored));
}

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

Option& Option::needs_one_of(std::vector<std::string> others) {
  app_->need_one_of_.push_back({option_, std::move(others)});
  return *this;
}

Option& Option::goes_with(std::vector<std::string> others) {
  app_->go_with_.push_back({option_, std::move(others)});
  return *this;
}

Option& Option::writes() {
  app_->outputs_.push_back(option_);
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
  std::string choice;
  for (const std::string& text : texts) choice += (choice.empty() ? "" : "|") + text;
  option_->check(CLI::IsMember(texts).description(""))->type_name(choice);
  return *this;
}

Option& Option::positive() {
  option_->check(CLI::Validator(CLI::PositiveNumber).description(""));
  return *this;
}

Option& Option::whole(std::int64_t low, std::int64_t high) {
  option_->check(CLI::Range(low, high).description(""));
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
  return Option(*this, add_value(*app_, names, value, help)->type_name("TEXT"));
}

template <class Number>
requires std::is_arithmetic_v<Number> Option CommandLine::add(const std::string& names,
                                                              Number& value,
                                                              const std::string& help) {
  return Option(*this, add_value(*app_, names, value, help));
}
template Option CommandLine::add(const std::string&, double&, const std::string&);
template Option CommandLine::add(const std::string&, int&, const std::string&);
template Option CommandLine::add(const std::string&, unsigned&, const std::string&);
template Option CommandLine::add(const std::string&, std::uint64_t&, const std::string&);

Option CommandLine::add(const std::string& names, std::optional<double>& value,
                        const std::string& help) {
  return Option(*this, app_->add_option(
                           names,
                           [&value](const CLI::results_t& given) {
                             return CLI::detail::lexical_cast(given.back(), value.emplace());
                           },
                           help));
}

Option CommandLine::add(const std::string& names, std::vector<std::string>& values,
                        const std::string& help) {
  const auto set_values = [&values](const CLI::results_t& given) {
    values = given;
    return true;
  };
  return Option(*this, app_->add_option(names, set_values, help)
                           ->type_name("TEXT")
                           ->expected(CLI::detail::expected_max_vector_size));
}

Option CommandLine::add(const std::string& names, std::function<void(const std::string&)> use,
                        const std::string& help) {
  const auto use_each = [use = std::move(use)](const CLI::results_t& given) {
    for (const std::string& text : given) use(text);
    return true;
  };
  return Option(*this, app_->add_option(names, use_each, help)->type_name("TEXT"));
}

Option CommandLine::add_flag(const std::string& name, bool& value, const std::string& help) {
  return Option(*this, app_->add_flag(name, value, help));
}

Option CommandLine::add_flag(const std::string& name, std::string& value, const std::string& help) {
  return Option(*this, app_->add_flag(name, value, help));
}

void CommandLine::group(const std::string& name) { app_->option_defaults()->group(name); }
Option CommandLine::option(const std::string& name) {
  return Option(*this, app_->get_option(name));
}
bool CommandLine::has(const std::string& name) const { return app_->get_option_no_throw(name); }
bool CommandLine::given(const std::string& name) const { return app_->count(name) > 0; }

void CommandLine::set_help(const std::string& name, const std::string& details,
                           const std::string& more_exits) {
  app_->name(name);
  app_->set_help_flag("-h,--help", "Print this help and exit.")->group("Options");
  app_->set_version_flag("-V,--version", "hapgrid " + name + " " HAPGRID_VERSION,
                         "Print the version and exit.")
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

void CommandLine::exclude_the_rest() {
  for (const Rule& rule : go_with_) {
    std::vector<CLI::Option*> allowed{rule.option};
    for (const std::string& name : rule.others) allowed.push_back(app_->get_option(name));
    for (CLI::Option* option : app_->get_options())
      if (std::find(allowed.begin(), allowed.end(), option) == allowed.end())
        rule.option->excludes(option);
  }
}

void CommandLine::check_rules() const {
  for (const Rule& rule : need_one_of_) {
    const auto given = [&](const std::string& name) { return app_->count(name) > 0; };
    if (rule.option->count() == 0 || std::any_of(rule.others.begin(), rule.others.end(), given))
      continue;
    std::string names = rule.others.front();
    for (std::size_t i = 1; i < rule.others.size(); ++i)
      names += (i + 1 < rule.others.size() ? ", " : " or ") + rule.others[i];
    throw UsageError(rule.option->get_name() + " requires " + names);
  }
  for (auto a = outputs_.begin(); a != outputs_.end(); ++a)
    for (auto b = a + 1; b != outputs_.end(); ++b)
      if ((*a)->count() > 0 && (*b)->count() > 0 &&
          same_file((*a)->results().back(), (*b)->results().back()))
        throw UsageError((*a)->get_name() + " and " + (*b)->get_name() + " cannot both be " +
                         (*a)->results().back());
}

std::optional<std::string> CommandLine::parse(int argc, char** argv) {
  exclude_the_rest();
  try {
    app_->parse(argc, argv);
    check_rules();
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
