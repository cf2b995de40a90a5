#include "libcore/shard/merged_rows.hpp"

#include <algorithm>
#include <limits>

namespace hapgrid {

namespace {
template <class Rows>
RowKey key(const Rows& rows, std::size_t r) {
  return record_key(rows.point[r], rows.level[r]);
}
}  // namespace

template <class Rows>
struct MergedRows<Rows>::Source {
  explicit Source(const Section& section) : reader(section) {}
  RowKey head() const { return key(rows, position); }
  /// Makes head() valid; false behind the last row.
  bool fill() {
    while (position == rows.size()) {
      position = 0;
      if (!reader.next(rows)) return false;
    }
    return true;
  }

  SectionReader reader;
  Rows rows;
  std::size_t position = 0;
};

template <class Rows>
MergedRows<Rows>::MergedRows(const std::vector<Section>& sections) {
  for (const Section& section : sections) waiting_.push_back(&section);
  std::stable_sort(waiting_.begin(), waiting_.end(), [](const Section* a, const Section* b) {
    return a->footer.first_point() > b->footer.first_point();
  });
}

template <class Rows>
MergedRows<Rows>::~MergedRows() = default;

template <class Rows>
void MergedRows<Rows>::open_next() {
  open_.push_back(std::make_unique<Source>(*waiting_.back()));
  waiting_.pop_back();
  if (!open_.back()->fill()) open_.pop_back();
}

template <class Rows>
void MergedRows<Rows>::end_run() {
  // The rows of the last run are given back only now.
  if (current_ && !current_->fill())
    std::erase_if(open_, [&](const auto& source) { return source.get() == current_; });
  current_ = nullptr;
}

template <class Rows>
SectionReader* MergedRows<Rows>::whole_chunk_next() {
  if (open_.size() > 1) return nullptr;
  if (!open_.empty()) {
    Source& source = *open_.front();
    if (source.position < source.rows.size()) return nullptr;
    if (source.reader.peek()) return alone(source) ? &source.reader : nullptr;
    // Behind the last chunk: this compares the sums of the footer, and ends the section.
    current_ = nullptr;
    source.fill();
    open_.clear();
  }
  if (waiting_.empty()) return nullptr;
  const Section& section = *waiting_.back();
  if (section.footer.chunks.empty()) return nullptr;
  open_.push_back(std::make_unique<Source>(section));
  waiting_.pop_back();
  Source& source = *open_.front();
  current_ = &source;
  return alone(source) ? &source.reader : nullptr;
}

template <class Rows>
bool MergedRows<Rows>::alone(const Source& source) const {
  return waiting_.empty() ||
         waiting_.back()->footer.first_point() > source.reader.peek()->last_point;
}

template <class Rows>
Run<Rows> MergedRows<Rows>::next() {
  end_run();
  while (open_.empty() && !waiting_.empty()) open_next();
  if (open_.empty()) return {};
  const auto smallest = [&] {
    return std::min_element(open_.begin(), open_.end(),
                            [](const auto& a, const auto& b) { return a->head() < b->head(); })
        ->get();
  };
  Source* source = smallest();
  while (!waiting_.empty() && waiting_.back()->footer.first_point() <= key_point(source->head())) {
    open_next();
    source = smallest();
  }
  // The run ends where another source, or a section that is still closed, has the next row.
  RowKey limit = std::numeric_limits<RowKey>::max();
  for (const auto& other : open_)
    if (other.get() != source) limit = std::min(limit, other->head());
  if (!waiting_.empty())
    limit = std::min(limit, record_key(waiting_.back()->footer.first_point(), 0));
  const Rows& rows = source->rows;
  const std::size_t begin = source->position;
  std::size_t end = begin + 1;
  if (key(rows, rows.size() - 1) < limit) {
    end = rows.size();
  } else {
    while (end < rows.size() && key(rows, end) < limit) ++end;
  }
  source->position = end;
  current_ = source;
  return {&rows, begin, end};
}

template class MergedRows<RecordRows>;
template class MergedRows<RequestRows>;

}  // namespace hapgrid
