// Many questions are on their way to a process at once. A process that dies or hangs is replaced by
// another, and the questions that it had are asked again.
//
// When a process fails, any of the questions that it had may be to blame. Each of them is asked
// again alone, so that one that kills every process cannot take others with it, and it fails after
// kMaxAttempts in all. Where the process itself says what is wrong (it prints where it should
// answer, or an exception ends it), nothing is asked again. What is reached does not depend on any
// of this: an answer belongs to its question by its id.
#include "libcore/model/process_model.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <deque>
#include <optional>
#include <system_error>
#include <utility>

#include "libcore/base/error.hpp"
#include "libcore/base/format.hpp"
#include "libcore/base/signals.hpp"
#include "libcore/base/text.hpp"
#include "libcore/model/process.hpp"
#include "libcore/model/protocol.hpp"

namespace hapgrid {

/// What all copies of one model process share.
struct ProcessGroup {
  std::vector<std::string> command;  // program and arguments
  std::filesystem::path directory;
  ProcessOptions options;
  std::string handshake;
  std::optional<ModelInfo> info;  // what the first process said; all later ones must say the same
  Launcher launcher;
  std::atomic<bool> has_hinted{false};
  std::atomic<bool> is_abandoned{false};
};

namespace {

constexpr unsigned kInFlight = 4;     // where neither the user nor the model says another number
constexpr unsigned kMaxAttempts = 3;  // for one question, and to start a process

std::chrono::nanoseconds nanoseconds(double seconds) {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
      std::chrono::duration<double>(seconds));
}

/// @param when what follows on how it ended
/// @throw LastingError when the process has ended itself and said why, as an exception that nobody
/// catches does; ModelError
[[noreturn]] void throw_how_it_ended(ChildProcess& child, const std::string& when) {
  const std::string last_words = printable_line(child.rest());
  std::string what = child.how_it_ended() + when;
  if (!last_words.empty()) what += format(" (last words: '{}')", last_words);
  const std::string error_line = child.last_error_line();
  if (!error_line.empty()) what += ": " + error_line;
  if (error_line.starts_with("ModuleNotFoundError"))
    what += format(" (the program is {})", child.program());
  if (child.has_given_up() && !error_line.empty()) throw LastingError(what);
  throw ModelError(what);
}

std::string who(const ProcessGroup& group, const std::string& what) {
  return format("process '{}' {}", command_text(group.command), what);
}

constexpr const char* kUnflushed =
    "waits for input, though it owes an answer: does it flush its output after each line (in C "
    "fflush(stdout))?";

/// Waits as child.pump() does. A process that owes an answer and waits for input has written it
/// into a buffer of its own, as C does with a pipe: the user gets a hint, long before the deadline.
/// @throw LastingError when the model is abandoned
ChildProcess::Event pump(ProcessGroup& group, ChildProcess& child,
                         ChildProcess::Clock::time_point deadline) {
  constexpr std::chrono::seconds kPatience{2};
  constexpr std::chrono::milliseconds kLook{100};
  const auto soon = ChildProcess::Clock::now() + kPatience;
  bool may_hint = group.options.hint && !group.has_hinted && deadline > soon;
  for (;;) {
    if (group.is_abandoned) throw LastingError("is not needed any more");
    const auto now = ChildProcess::Clock::now();
    if (may_hint && now >= soon) {
      may_hint = false;
      if (child.waits_for_input() && !group.has_hinted.exchange(true))
        group.options.hint(who(group, kUnflushed));
    }
    const ChildProcess::Event event = child.pump(std::min(deadline, now + kLook));
    if (event != ChildProcess::Event::kTimeout || ChildProcess::Clock::now() >= deadline)
      return event;
  }
}

/// What the system refused, and what its user can do: each thread has a process, and each process
/// has three pipes. To ask again would not help.
LastingError refusal(const std::vector<std::string>& command, const std::system_error& e) {
  std::string why = e.code().message();
  if (e.code() == std::errc::too_many_files_open)
    why += "; have fewer (-j), or raise the limit (ulimit -n)";
  if (e.code() == std::errc::resource_unavailable_try_again)
    why += "; have fewer (-j), or raise the limit (ulimit -u)";
  return LastingError(format("process '{}' cannot be started: {}", command_text(command), why));
}

/// Waits for the first line of a process. @throw Error
ModelInfo hear_first_line(ProcessGroup& group, ChildProcess& child) {
  const double seconds =
      std::max(group.options.timeout_seconds, group.options.start_timeout_seconds);
  const auto deadline = ChildProcess::Clock::now() + nanoseconds(seconds);
  std::string_view line;
  while (!child.next_line(line)) {
    if (child.rest().size() > kMaxFirstLineBytes)
      throw ModelError("wrote a first line that does not end");
    const ChildProcess::Event event = pump(group, child, deadline);
    if (event == ChildProcess::Event::kEnded)
      throw_how_it_ended(child, " before it had said what it is");
    if (event == ChildProcess::Event::kTimeout)
      throw ModelError(
          format("did not say what it is within {} s; a longer timeout in [model] gives it more",
                 to_text(seconds)));
  }
  return read_first_line(line);
}

/// Starts a process. The first one of a group tells what the model is.
/// @throw RefusedError when the model refuses its parameters; LastingError; ModelError
std::unique_ptr<ChildProcess> start(ProcessGroup& group) {
  std::unique_ptr<ChildProcess> child;
  try {
    child = std::make_unique<ChildProcess>(group.launcher, group.command, group.directory);
    child->send(group.handshake);
    ModelInfo info = hear_first_line(group, *child);
    if (!group.info)
      group.info = std::move(info);
    else if (info != *group.info)
      throw ModelError("says other things of itself than at its first start");
    return child;
  } catch (const RefusedError&) {
    throw;
  } catch (const LastingError& e) {
    child->kill();
    throw LastingError(who(group, e.what()));
  } catch (const Error& e) {
    if (child) child->kill();
    throw ModelError(who(group, e.what()));
  } catch (const std::system_error& e) {
    throw refusal(group.command, e);
  }
}

class ProcessModel final : public Model {
 public:
  /// @param child a process that has said what it is; without one, it starts with the first
  /// question.
  ProcessModel(std::shared_ptr<ProcessGroup> group, std::unique_ptr<ChildProcess> child)
      : Model(*group->info),
        group_(std::move(group)),
        child_(std::move(child)),
        in_flight_(info().in_flight > 0 ? info().in_flight : kInFlight) {}

  std::vector<double> known_states(const Vec3& x) override {
    std::vector<double> states;
    Question question{.operation = Operation::kKnownStates, .states = &states};
    question.conversion.x = x;
    if (!ask(question)) throw ModelError("known states: " + error_);
    return states;
  }
  bool convert(const double* s, const Vec3& x, const Vec3& d, double* row) override {
    return ask({.operation = Operation::kConvert, .conversion = {s, x, d, row, 0}});
  }
  bool complete(const Vec3& x, double* row) override {
    return ask({.operation = Operation::kEvaluate, .conversion = {row, x, {}, row, 0}});
  }
  void convert_all(const NextConversion& next, const ConversionDone& done) override {
    ask_all([&](Question& question, bool idle) { return next(question.conversion, idle); },
            [&](const Question& question, std::string_view e) { done(question.conversion, e); });
  }
  void hang_up() override {
    if (child_) child_->hang_up();
  }
  std::uint64_t memory_bytes() const override { return child_ ? child_->memory_bytes() : 0; }
  void abandon() noexcept override { group_->is_abandoned = true; }

 private:
  using Clock = ChildProcess::Clock;

  struct Question {
    Operation operation = Operation::kConvert;
    Conversion conversion{};
    std::vector<double>* states = nullptr;
    std::uint64_t id = 0;
    unsigned attempts = 0;
    Clock::time_point sent{};
  };
  using NextQuestion = std::function<bool(Question&, bool idle)>;
  using QuestionDone = std::function<void(const Question&, std::string_view error)>;

  bool ask(const Question& question);
  void ask_all(const NextQuestion& next, const QuestionDone& done);
  bool has_room() const;
  bool require_child();
  bool send(Question question);
  Clock::time_point deadline() const;
  void listen(const QuestionDone& done);
  void read_lines(const QuestionDone& done);
  void handle(const Answer& answer, const QuestionDone& done);
  void give_up(const std::string& what, bool is_lasting, const QuestionDone& done);

  std::shared_ptr<ProcessGroup> group_;  // declared first: its launcher outlives the child
  std::unique_ptr<ChildProcess> child_;
  unsigned in_flight_;
  std::uint64_t last_id_ = 0;
  std::vector<Question> sent_;  // and not answered, ascending by id
  std::deque<Question> again_;  // lost with a process, in the order in which they were first sent
  Clock::time_point last_answer_;
  std::string line_;
  std::string dead_;  // why no process can be started any more
};

bool ProcessModel::ask(const Question& question) {
  bool is_asked = false;
  ask_all(
      [&](Question& next, bool) {
        next = question;
        return !std::exchange(is_asked, true);
      },
      [this](const Question&, std::string_view error) { error_ = error; });
  return error_.empty();
}

void ProcessModel::ask_all(const NextQuestion& next, const QuestionDone& done) {
  const NoSigpipe no_sigpipe;
  for (;;) {
    while (has_room()) {
      Question question;
      if (!again_.empty()) {
        question = again_.front();
        again_.pop_front();
      } else if (!next(question, sent_.empty())) {
        break;
      }
      if (!send(question)) done(question, dead_);
    }
    if (sent_.empty()) return;
    try {
      listen(done);
    } catch (const LastingError& e) {
      give_up(e.what(), /*is_lasting=*/true, done);
    } catch (const ModelError& e) {
      give_up(e.what(), /*is_lasting=*/false, done);
    } catch (const std::system_error& e) {
      give_up(e.what(), /*is_lasting=*/true, done);
    }
  }
}

/// Whether the process may have another question: one that is asked again is asked alone.
bool ProcessModel::has_room() const {
  const bool alone = !again_.empty() || (!sent_.empty() && sent_.front().attempts > 1);
  return sent_.size() < (alone ? 1 : in_flight_);
}

/// Answers whether there is a process; dead_ says why there can be none.
bool ProcessModel::require_child() {
  for (unsigned attempt = 1; !child_ && dead_.empty(); ++attempt) {
    try {
      child_ = start(*group_);
    } catch (const RefusedError& e) {
      dead_ = who(*group_, format("now refuses its parameters: {}", e.what()));
    } catch (const LastingError& e) {
      dead_ = e.what();
    } catch (const ModelError& e) {
      if (attempt == kMaxAttempts) dead_ = e.what();
    }
  }
  return child_ != nullptr;
}

bool ProcessModel::send(Question question) {
  if (!require_child()) return false;
  question.id = ++last_id_;
  ++question.attempts;
  question.sent = Clock::now();
  line_.clear();
  const Conversion& c = question.conversion;
  append_question(line_, question.id, question.operation, state_size(), c.s, c.x, c.d);
  child_->send(line_);
  sent_.push_back(question);
  return true;
}

/// A process that works on one question after the other is given the whole limit for each. One that
/// answers others and never this one gets no more time than if it did so.
ProcessModel::Clock::time_point ProcessModel::deadline() const {
  const auto limit = nanoseconds(group_->options.timeout_seconds);
  const Clock::time_point oldest = sent_.front().sent;
  return std::min(std::max(oldest, last_answer_) + limit, oldest + in_flight_ * limit);
}

/// Hears what comes next. @throw ModelError when the process is of no use any more
void ProcessModel::listen(const QuestionDone& done) {
  switch (pump(*group_, *child_, deadline())) {
    case ChildProcess::Event::kMoved:
      return read_lines(done);
    case ChildProcess::Event::kTimeout:
      throw ModelError(
          format("gave no answer within {} s", to_text(group_->options.timeout_seconds)));
    case ChildProcess::Event::kEnded:
      throw_how_it_ended(*child_, "");
  }
}

void ProcessModel::read_lines(const QuestionDone& done) {
  std::string_view line;
  while (child_->next_line(line)) {
    handle(read_answer(line), done);
  }
  const std::size_t limit =
      max_answer_bytes(info(), sent_.empty() ? Operation::kConvert : sent_.front().operation);
  if (child_->rest().size() > limit)
    throw ModelError(format("wrote a line of more than {} bytes", limit));
}

void ProcessModel::handle(const Answer& answer, const QuestionDone& done) {
  const auto found = std::find_if(sent_.begin(), sent_.end(),
                                  [&](const Question& q) { return q.id == answer.id; });
  if (found == sent_.end())
    throw ModelError(format("answered a question {} that it does not have", answer.id));
  if (!answer.error) {
    if (found->operation == Operation::kKnownStates)
      *found->states = states_of(answer, info());
    else
      write_row(answer, info(), found->operation, found->conversion.row);
  }
  const Question question = *found;
  sent_.erase(found);
  last_answer_ = Clock::now();
  if (!answer.error) return done(question, {});
  done(question, answer.error->empty() ? "no reason given" : *answer.error);
}

/// Ends the process, and takes back the questions that it had: each is asked again, or fails. Where
/// asking again cannot help, all fail: the search ends with the first.
void ProcessModel::give_up(const std::string& what, bool is_lasting, const QuestionDone& done) {
  child_->kill();
  child_.reset();
  const std::string why = who(*group_, what);
  const std::vector<Question> lost = std::exchange(sent_, {});
  for (auto question = lost.rbegin(); question != lost.rend() && !is_lasting; ++question)
    if (question->attempts < kMaxAttempts) again_.push_front(*question);
  for (const Question& question : lost)
    if (is_lasting)
      done(question, why);
    else if (question.attempts >= kMaxAttempts)
      done(question, format("{}; asked {} times", why, question.attempts));
}

}  // namespace

std::unique_ptr<Model> ProcessSource::create(const std::vector<Parameter>& parameters,
                                             const Stored& store) const {
  try {
    std::string handshake = handshake_line(parameters);
    if (group_ && group_->handshake == handshake)
      return std::make_unique<ProcessModel>(group_, nullptr);
    group_.reset();
    auto group = std::make_shared<ProcessGroup>();
    group->command = command_;
    group->directory = directory_;
    group->options = options_;
    group->handshake = std::move(handshake);
    const NoSigpipe no_sigpipe;
    std::unique_ptr<ChildProcess> first = start(*group);
    const Stored& given = group->info->stored;
    if ((store.force && !given.force) || (store.energy && !given.energy) ||
        (store.shape && !given.shape))
      throw ModelError("what is to be stored must be in its \"stored\"");
    group_ = group;
    return std::make_unique<ProcessModel>(group_, std::move(first));
  } catch (const ModelError& e) {
    throw ModelError(format("model {}: {}", name_, e.what()));
  } catch (const std::system_error& e) {
    throw ModelError(format("model {}: {}", name_, refusal(command_, e).what()));
  }
}

std::string command_text(const std::vector<std::string>& command) {
  constexpr std::size_t kShown = 200;
  std::string text;
  for (const std::string& word : command) text += (text.empty() ? "" : " ") + word;
  if (text.size() > kShown) text = text.substr(0, kShown) + "...";
  return text;
}

}  // namespace hapgrid
