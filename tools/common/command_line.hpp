// The command line of a filter. To compile CLI11 takes 4 s for each source that includes it: only
// one source does.
#pragma once

#include <cstdint>
#include <functional>
#include <initializer_list>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace hapgrid {

/// The command line is wrong, which may show only when its options are put together.
struct UsageError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Whether two names are the same file, also through links.
bool same_file(const std::string& a, const std::string& b);

class CommandLine;

/// An option that was added to a CommandLine; copies are the same option. Other options that are
/// given by their names may be added later. An option that would do nothing beside the others is
/// refused, and never ignored.
class Option {
 public:
  /// What --help calls the value, in capitals.
  Option& type(const std::string& name);
  Option& required();
  /// --help gives the value that the variable has now as the default.
  Option& shows_default();
  /// Takes one value each time that it is given.
  Option& repeatable();
  /// Takes several values with commas between them.
  Option& comma_separated();
  Option& needs(const Option& other);
  Option& excludes(const Option& other);
  /// Does nothing without one of `others`, so it is refused there.
  Option& needs_one_of(std::vector<std::string> others);
  /// Of all other options and positionals, only `others` do something beside this one: the rest are
  /// refused.
  Option& goes_with(std::vector<std::string> others);
  /// Names a file that is written. Two such options cannot name the same one.
  Option& writes();
  /// A text that is not `good` is refused with the message "'TEXT' is not DESCRIPTION".
  Option& check(std::function<bool(const std::string&)> good, const std::string& description);
  /// One of these texts, which --help shows in place of a type.
  Option& one_of(const std::vector<std::string>& texts);
  Option& positive();
  /// A whole number in [low, high].
  Option& whole(std::int64_t low, std::int64_t high);
  /// A number in [low, high], not NaN; `description` says so: "a rate from ...".
  Option& within(double low, double high, const std::string& description);

 private:
  friend class CommandLine;
  Option(CommandLine& app, CLI::Option* option) : app_(&app), option_(option) {}
  CommandLine* app_;
  CLI::Option* option_;
};

/// `names` are "-o,--output", or without a dash those of a positional. A `help` is a sentence or
/// two with a subject, a unit and a default. Variables keep their values where the option is not
/// given, and must outlive parse(), as functions must, which are called for each value.
class CommandLine {
 public:
  explicit CommandLine(const std::string& about);
  ~CommandLine();

  Option add(const std::string& names, std::string& value, const std::string& help);
  template <class Number>
  requires std::is_arithmetic_v<Number> Option add(const std::string& names, Number& value,
                                                   const std::string& help);
  Option add(const std::string& names, std::optional<double>& value, const std::string& help);
  Option add(const std::string& names, std::vector<std::string>& values, const std::string& help);
  Option add(const std::string& names, std::function<void(const std::string&)> use,
             const std::string& help);
  Option add_flag(const std::string& name, bool& value, const std::string& help);
  /// A flag that may have a value behind '=', as in "--terminal{auto}".
  Option add_flag(const std::string& name, std::string& value, const std::string& help);

  /// The heading of the options that are added from now on.
  void group(const std::string& name);
  Option option(const std::string& name);
  bool has(const std::string& name) const;
  /// Whether the parsed command line has it.
  bool given(const std::string& name) const;

  /// Names the program, and gives it --version and a --help that ends with `details` and the table
  /// of exit codes; `more_exits` are further lines of that table ("  130  ...\n"). The lines of
  /// both have at most 80 columns, to which everything else in the help is wrapped.
  void set_help(const std::string& name, const std::string& details = "",
                const std::string& more_exits = "");
  std::string name() const;
  /// @return what --help or --version print, when one of them was asked for
  /// @throw UsageError
  std::optional<std::string> parse(int argc, char** argv);

 private:
  friend class Option;
  struct Rule {
    CLI::Option* option;
    std::vector<std::string> others;
  };
  void exclude_the_rest();
  void check_rules() const;

  std::unique_ptr<CLI::App> app_;
  std::vector<Rule> need_one_of_, go_with_;
  std::vector<CLI::Option*> outputs_;
};

}  // namespace hapgrid
