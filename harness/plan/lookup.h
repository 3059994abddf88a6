// The two lookups that planning and `explain` do for every case. A motion has tens of thousands of cases, so neither
// may look at all others. The comparison is a parameter, so that a test can count its calls.
#pragma once

#include <cmath>
#include <cstddef>
#include <functional>
#include <iterator>
#include <map>
#include <utility>
#include <vector>

namespace hausbench {

// The rows that are read off the trace of each row. O(log n), plus the rows found.
template <class Less = std::less<std::size_t>> class RowsReadOff {
public:
    explicit RowsReadOff(Less less = {}) : rows_(less) {}

    void add(std::size_t of, std::size_t row) { rows_[of].push_back(row); }

    const std::vector<std::size_t>& of(std::size_t row) const {
        static const std::vector<std::size_t> none;
        const auto at = rows_.find(row);
        return at == rows_.end() ? none : at->second;
    }

private:
    std::map<std::size_t, std::vector<std::size_t>, Less> rows_;
};

// Facts about runs of other cases, sorted by their expected work (positive). O(log n) each.
template <class Known, class Less = std::less<double>> class NearestByWork {
public:
    explicit NearestByWork(Less less = {}) : known_(less) {}

    bool empty() const { return known_.empty(); }
    void add(double work, Known known) { known_.emplace(work, std::move(known)); }

    // Returns the fact whose work has the ratio to `work` that is nearest to 1; the first added, if several have that
    // work. The set must not be empty.
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
