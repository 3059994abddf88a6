// A query of the C interface, checked, and how it is solved.
#pragma once

#include "algorithms/session/adapter.h"
#include "harness/ask/tolerance.h"
#include "library/hausbench.h"
#include "library/pair.h"

#include <functional>

namespace hausbench::library {

// One question about a pair. Make it in the thread that called the library, which calls the cancel function.
class Question {
public:
    // `argument` is the number of the argument `query` of the function that was called. Throws ArgumentError.
    Question(hausbench_pair* pair, const hausbench_query* query, int argument);
    Question(const Question&) = delete;

    Query query;  // tolerance, poses, limits; the caller sets the rest
    ResolvedTolerance tolerance;

    // Return the answer for h(A,B), or another quantity of `query`; and for H(A,B).
    Result solve();
    Result solve_symmetric();

    // Writes what solve() returned.
    void answer(const Result& result, hausbench_answer& answer) const;

    Pair& pair() const { return *pair_; }
    const hausbench_query& asked() const { return asked_; }

private:
    struct Way {
        Query query;
        Pair::Kind kind;
        std::shared_ptr<const Session> session;
    };
    Way way(Query one, bool backward);
    using Show = std::function<void(const Result&)>;  // gets bounds on the way
    Result ask(bool backward, const Show& show);      // for h(A,B) or h(B,A)
    Result solved(const Way& way, const Show& show);
    void show(const Result& so_far);  // to the caller's progress function
    int status_of(const Result& result) const;
    static int asks_to_stop(void* question);  // the hook of interrupt_

    std::shared_ptr<Pair> pair_;
    hausbench_query asked_;
    Interrupt interrupt_;
    bool stop_ = false;  // the progress function has asked to stop
    Chain* chain_ = nullptr;
    double prepare_seconds_ = 0, solve_seconds_ = 0;
};

// Returns the pose of a 4 x 4 matrix as in hausbench_query. Throws ArgumentError, with `of` before the name, if it is none.
Pose pose_of(const double* matrix, const char* name, int argument, const char* of = "");

}  // namespace hausbench::library
