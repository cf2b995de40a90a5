#include "libcore/model/process_model.hpp"

#include <algorithm>
#include <utility>

#include "libcore/base/error.hpp"
#include "libcore/base/text.hpp"

namespace hapgrid {

namespace {

std::chrono::nanoseconds nanoseconds(double seconds) {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
      std::chrono::duration<double>(seconds));
}

std::string ending(ChildProcess& child) {
  const std::string last_words = printable_line(child.rest());
  return child.how_it_ended() + (last_words.empty() ? "" : " (last words: '" + last_words + "')");
}

}  // namespace

ProcessModel::ProcessModel(std::shared_ptr<ProcessGroup> group) : group_(std::move(group)) {
  const NoSigpipe no_sigpipe;
  if (const std::string why = start(); !why.empty()) throw ModelError(why);
  fill_table();
}

ProcessModel::ProcessModel(std::shared_ptr<ProcessGroup> group, Description expected)
    : group_(std::move(group)), description_(std::move(expected)), described_(true) {
  fill_table();
}

void ProcessModel::fill_table() {
  table_.interface_version = HAPGRID_MODEL_INTERFACE;
  table_.equal = [](const hapgrid_model* model, const double* a, const double* b) -> int {
    const Description& d = of(model).description_;
    return are_equal(d.equality, d.tolerance, d.state_size, a, b);
  };
}

std::string ProcessModel::who(const std::string& what) const {
  return "process '" + to_text(group_->command) + "' " + what;
}

/// Starts a process and hears its description. Answers why that failed, empty when it did not.
/// @throw RefusedError when the model refuses its parameters
std::string ProcessModel::start() {
  if (!group_) return "this model's process was not started";
  try {
    child_ = group_->starter.start(group_->command);
    child_->send(group_->handshake);
    const ProcessOptions& options = group_->options;
    const double seconds = std::max(options.timeout_seconds, options.start_timeout_seconds);
    const auto limit = Clock::now() + nanoseconds(seconds);
    std::string_view line;
    while (!child_->next_line(line)) {
      if (child_->rest().size() > kMaxDescriptionBytes)
        throw ModelError("wrote a first line that does not end");
      const ChildProcess::Event event = child_->pump(limit);
      if (event == ChildProcess::Event::kEnded)
        throw ModelError(ending(*child_) + " before it had said what it is");
      if (event == ChildProcess::Event::kTimeout)
        throw ModelError("did not say what it is within " + to_text(seconds) + " s");
    }
    Description description = read_description(line);
    if (described_ && !(description == description_))
      throw ModelError("says another thing of itself than at its first start");
    description_ = std::move(description);
    described_ = true;
    return "";
  } catch (const RefusedError&) {
    child_.reset();
    throw;
  } catch (const Error& e) {
    if (child_) child_->kill();
    child_.reset();
    return who(e.what());
  }
}

void ProcessModel::hang_up() {
  if (child_) child_->hang_up();
}

bool ProcessModel::send(Request& request, std::string& why) {
  for (unsigned attempt = 1; !child_ && dead_.empty(); ++attempt) {
    try {
      why = start();
    } catch (const RefusedError& e) {
      why = who(std::string("now refuses its parameters: ") + e.what());
      attempt = kMaxAttempts;
    }
    if (!child_ && attempt >= kMaxAttempts) dead_ = why;
  }
  if (!child_) {
    why = dead_;
    return false;
  }
  request.id = ++last_id_;
  ++request.attempts;
  request.sent = Clock::now();
  line_.clear();
  const Conversion& c = request.conversion;
  append_request(line_, request.id, request.operation, description_.state_size, c.s, c.x, c.d);
  child_->send(line_);
  flying_.push_back(request);
  return true;
}

/// A process that works on one request after the other is given the whole limit for each; one that
/// answers others and never this one is not waited for longer than if it did so.
ProcessModel::Clock::time_point ProcessModel::deadline() const {
  const auto limit = nanoseconds(group_->options.timeout_seconds);
  const Clock::time_point oldest = flying_.front().sent;
  return std::min(std::max(oldest, last_answer_) + limit,
                  oldest + group_->options.in_flight * limit);
}

void ProcessModel::take_lines(const std::function<void(const Request&, const std::string&)>& done) {
  std::string_view line;
  while (child_->next_line(line)) {
    read_answer(line, answer_);
    const auto found = std::find_if(flying_.begin(), flying_.end(),
                                    [&](const Request& r) { return r.id == answer_.id; });
    if (found == flying_.end())
      throw ModelError("answered a request " + std::to_string(answer_.id) +
                       " that it does not have");
    if (!answer_.has_error) {
      if (found->operation == Operation::kKnownStates)
        *found->states = take_states(answer_, description_);
      else
        take_row(answer_, description_, found->operation, found->conversion.row);
    }
    const Request request = *found;
    flying_.erase(found);
    last_answer_ = Clock::now();
    done(request, !answer_.has_error      ? ""
                  : answer_.error.empty() ? "no reason given"
                                          : answer_.error);
  }
  const Operation operation = flying_.empty() ? Operation::kConvert : flying_.front().operation;
  if (child_->rest().size() > max_answer_bytes(description_, operation))
    throw ModelError("wrote a line of more than " +
                     std::to_string(max_answer_bytes(description_, operation)) + " bytes");
}

/// Hears what comes next. Answers why the process is of no use any more, empty while it is.
std::string ProcessModel::listen(
    const std::function<void(const Request&, const std::string&)>& done) {
  try {
    switch (child_->pump(deadline())) {
      case ChildProcess::Event::kMoved:
        take_lines(done);
        return "";
      case ChildProcess::Event::kTimeout:
        throw ModelError("gave no answer within " + to_text(group_->options.timeout_seconds) +
                         " s");
      case ChildProcess::Event::kEnded:
        break;
    }
    throw ModelError(ending(*child_));
  } catch (const ModelError& e) {
    child_->kill();
    child_.reset();
    return who(e.what());
  }
}

void ProcessModel::run(const std::function<bool(Request&, bool)>& next,
                       const std::function<void(const Request&, const std::string&)>& done) {
  const NoSigpipe no_sigpipe;
  std::deque<Request> again;  // ascending by the order in which they were asked first
  for (;;) {
    const auto room = [&] {
      const bool alone = !again.empty() || (!flying_.empty() && flying_.front().attempts > 1);
      return flying_.size() < (alone ? 1 : group_ ? group_->options.in_flight : 1);
    };
    while (room()) {
      Request request;
      if (!again.empty()) {
        request = again.front();
        again.pop_front();
      } else if (!next(request, flying_.empty())) {
        break;
      }
      if (std::string why; !send(request, why)) done(request, why);
    }
    if (flying_.empty()) return;
    const std::string why = listen(done);
    if (why.empty()) continue;
    for (auto request = flying_.rbegin(); request != flying_.rend(); ++request)
      if (request->attempts < kMaxAttempts) again.push_front(*request);
    const std::vector<Request> lost = std::exchange(flying_, {});
    for (const Request& request : lost)
      if (request.attempts >= kMaxAttempts)
        done(request, why + "; asked " + std::to_string(request.attempts) + " times");
  }
}

void ProcessModel::convert(const NextConversion& next, const ConversionDone& done) {
  run([&next](Request& request, bool idle) { return next(request.conversion, idle); },
      [&done](const Request& request, const std::string& error) {
        done(request.conversion, error);
      });
}

std::string ProcessModel::ask(const Request& request) {
  std::string result;
  bool asked = false;
  run(
      [&](Request& next, bool) {
        next = request;
        return !std::exchange(asked, true);
      },
      [&result](const Request&, const std::string& error) { result = error; });
  return result;
}

std::string ProcessModel::evaluate(const Vec3& x, double* row) {
  Request request;
  request.operation = Operation::kEvaluate;
  request.conversion = {row, x, {}, row, 0};
  return ask(request);
}

std::string ProcessModel::known_states(const Vec3& x, std::vector<double>& states) {
  Request request;
  request.operation = Operation::kKnownStates;
  request.conversion.x = x;
  request.states = &states;
  return ask(request);
}

}  // namespace hapgrid
