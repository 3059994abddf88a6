// hausbench._core.Pair, Query and Chain: questions to the library.
#pragma once

#include "library/hausbench.h"
#include "python/core/shape.h"
#include "python/core/working.h"

#include <array>
#include <atomic>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace hausbench_python {

// Returns the numbers of a pose, which is None or an array of 4 x 4 numbers.
std::optional<std::array<double, 16>> matrix_of(const pybind11::object& pose);

// The options of a question, checked by the library when it is asked.
class Query {
public:
    // A pose is None or an array of 4 x 4 numbers.
    Query(double tolerance, int relative_to, int threads, double time_limit, const pybind11::object& source_pose,
          const pybind11::object& target_pose, double share_tolerance, bool weigh_by_number);

    // Returns the query for one call.
    hausbench_query with(Working& working, hausbench_chain* chain) const;

private:
    using Matrix = std::array<double, 16>;
    hausbench_query query_ = HAUSBENCH_QUERY_INIT;
    std::optional<Matrix> source_pose_, target_pose_;
};

// Two shapes and the structures over both. Several threads may ask one pair at the same time.
class Pair {
public:
    // `solver` is empty for the library's choice. `moves`: 1 for poses of the source, 2 of the target, 3 of both.
    // Prepares nothing yet.
    Pair(const Shape& source, const Shape& target, const std::string& solver,
         const std::vector<std::string>& parameters, int threads, int moves);

    // Each returns the members of hausbench_answer as a tuple, see _core.pyi. A chain that another thread is using is
    // not used, which changes no bound's truth. `progress` is None or a function of a list of (lower, upper).
    class Chain;
    pybind11::tuple directed(const Query& query, Chain* chain, const pybind11::object& progress) const;
    pybind11::tuple symmetric(const Query& query, Chain* chain, const pybind11::object& progress) const;
    pybind11::tuple within(bool symmetric, double length, const Query& query, Chain* chain,
                           const pybind11::object& progress) const;
    pybind11::tuple certify(bool symmetric, const Query& query, const pybind11::bytes& path) const;

    // Returns an array (n, 2) of bounds, one row for each statistic, and the answer.
    pybind11::tuple distribution(const std::vector<std::string>& statistics, const Query& query,
                                 const pybind11::object& progress) const;

    // Returns an array (n, 2) of bounds, and one (n) of rows of the target, for the `count` vertices of the source.
    pybind11::tuple field(const Query& query, pybind11::ssize_t count) const;

private:
    struct Release {
        void operator()(hausbench_pair* pair) const { hausbench_pair_release(pair); }
    };
    std::unique_ptr<hausbench_pair, Release> pair_;
};

// A chain of answers for nearby poses of one pair, which it keeps alive.
class Pair::Chain {
public:
    explicit Chain(const Pair& pair);

    // Takes the chain for one call; empty while another call has it.
    class Use {
    public:
        explicit Use(Chain* chain);
        ~Use();
        Use(const Use&) = delete;
        Use& operator=(const Use&) = delete;
        hausbench_chain* get() const { return chain_ ? chain_->chain_.get() : nullptr; }

    private:
        Chain* chain_;
    };

private:
    struct Release {
        void operator()(hausbench_chain* chain) const { hausbench_chain_release(chain); }
    };
    std::unique_ptr<hausbench_chain, Release> chain_;
    std::atomic_flag used_;
};

void define_pair(pybind11::module_& module);

}  // namespace hausbench_python
