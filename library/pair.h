// Pairs and chains behind the handles of the C interface.
#pragma once

#include "algorithms/options.h"
#include "algorithms/session/session.h"
#include "library/hausbench.h"
#include "library/shape.h"

#include <compare>
#include <map>
#include <memory>
#include <mutex>

namespace hausbench::library {

// Returns whether a plan may name this solver: its bounds hold, and it bounds h(A,B) of meshes or point sets.
bool is_for_plans(const SolverInfo& info);

// Two shapes with the sessions that answer queries about them. Thread-safe.
class Pair {
public:
    Pair(std::shared_ptr<Model> source, std::shared_ptr<Model> target, const hausbench_plan& plan);

    // The properties of a query that decide how its session is prepared. Each kind has a session of its own, so an
    // answer does not depend on earlier queries of other kinds.
    struct Kind {
        bool distribution = false;  // by the solver of distributions, not by the solver of the plan
        bool backward = false;      // h(B,A): the shapes are swapped
        bool symmetric = false, both_ways = false;
        bool moves = false, target_moves = false, target_copied = false;  // of the solver's own source and target

        auto operator<=>(const Kind&) const = default;
    };

    // Returns the kind of session for a query, whose poses are of this direction's source and target. `also` adds
    // moves.
    Kind kind_for(const Query& query, bool backward, const Kind& also) const;

    // Returns the session of this kind. The first call constructs it with up to `threads` threads.
    std::shared_ptr<const Session> session(const Kind& kind, int threads);

    Model& source() const { return *source_; }
    Model& target() const { return *target_; }
    const SolverEntry& entry() const { return entry_; }
    double extent() const { return extent_; }         // the diagonal of the box of both shapes
    const Kind& planned() const { return planned_; }  // the moves that the plan announces

private:
    std::shared_ptr<Model> source_, target_;
    SolverEntry entry_;
    ParameterMap parameters_;
    double extent_;
    Kind planned_;
    std::recursive_mutex mutex_;  // a cancel function may ask about the pair while a session is constructed
    std::map<Kind, std::shared_ptr<const Session>> sessions_;
};

// A chain of nearby poses: one state for each kind of session.
struct Chain {
    std::shared_ptr<Pair> pair;
    std::map<Pair::Kind, std::unique_ptr<State>> states;
    Pair::Kind moves;  // the shapes that have moved so far
};

}  // namespace hausbench::library

struct hausbench_pair {
    std::shared_ptr<hausbench::library::Pair> pair;
};

struct hausbench_chain {
    hausbench::library::Chain chain;
};
