// Two lookups that planning and `explain` do for every case. They take O(log n), because a motion may have tens of
// thousands of cases. The comparison is a template parameter, so that a test can count its calls.
#pragma once

#include <cmath>
#include <cstddef>
#include <functional>
#include <iterator>
#include <map>
#include <utility>
#include <vector>

namespace hausbench {

// Maps each row that is run to the rows whose answers are read off its trace (see FromTrace in plan.h). Each function
// takes O(log n).
template <class Less = std::less<std::size_t>> class RowsReadOff {
public:
    explicit RowsReadOff(Less less = {}) : rows_(less) {}

    // Records that the answer to `row` is read off the trace of row `of`.
    void add(std::size_t of, std::size_t row) { rows_[of].push_back(row); }

    const std::vector<std::size_t>& of(std::size_t row) const {
        static const std::vector<std::size_t> none;
        const auto at = rows_.find(row);
        return at == rows_.end() ? none : at->second;
    }

private:
    std::map<std::size_t, std::vector<std::size_t>, Less> rows_;
};

// Values known from earlier runs, sorted by expected work (above 0). Finds the value with the most similar work in
// O(log n).
template <class Known, class Less = std::less<double>> class NearestByWork {
public:
    explicit NearestByWork(Less less = {}) : known_(less) {}

    bool empty() const { return known_.empty(); }
    void add(double work, Known value) { known_.emplace(work, std::move(value)); }

    // Returns the value whose work differs from `work` by the smallest factor. If several values have that work,
    // returns the one that was added first. Requires at least one value.
    const Known& nearest(double work) const {
        const auto distance = [&](double other) { return std::abs(std::log(other / work)); };
        const auto above = known_.lower_bound(work);
        if (above == known_.begin()) return above->second;
        const double below = std::prev(above)->first;
        if (above != known_.end() && distance(above->first) < distance(below)) return above->second;
        return known_.lower_bound(below)->second;
    }

private:
    std::multimap<double, Known, Less> known_;
};

}  // namespace hausbench
