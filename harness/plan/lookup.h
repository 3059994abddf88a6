// The two lookups that planning and `explain` do for every case. A motion may have tens of thousands of cases, so
// neither lookup may go through all other cases. The comparison is a parameter, so that a test can count its calls.
#pragma once

#include <cmath>
#include <cstddef>
#include <functional>
#include <iterator>
#include <map>
#include <utility>
#include <vector>

namespace hausbench {

// For each row that is run, the rows whose answers are read off its trace (see FromTrace in plan.h). Each function
// takes O(log n).
template <class Less = std::less<std::size_t>> class RowsReadOff {
public:
    explicit RowsReadOff(Less less = {}) : rows_(less) {}

    // Notes that `row` is read off the trace of row `of`.
    void add(std::size_t of, std::size_t row) { rows_[of].push_back(row); }

    const std::vector<std::size_t>& of(std::size_t row) const {
        static const std::vector<std::size_t> none;
        const auto at = rows_.find(row);
        return at == rows_.end() ? none : at->second;
    }

private:
    std::map<std::size_t, std::vector<std::size_t>, Less> rows_;
};

// Facts about the runs of other cases, sorted by the expected work of the case (above 0). Each function takes O(log n).
template <class Known, class Less = std::less<double>> class NearestByWork {
public:
    explicit NearestByWork(Less less = {}) : known_(less) {}

    bool empty() const { return known_.empty(); }
    void add(double work, Known known) { known_.emplace(work, std::move(known)); }

    // Returns the fact whose work differs from `work` by the smallest factor. If several facts have that work, returns
    // the one that was added first. There must be at least one fact.
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
