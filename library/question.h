// A query of the C interface, checked, and how it is solved.
#pragma once

#include "harness/ask/ask.h"
#include "harness/ask/tolerance.h"
#include "library/hausbench.h"
#include "library/pair.h"

namespace hausbench::library {

// One question about a pair. Make it in the thread that called the library, which calls the cancel function.
class Question {
public:
    // `argument` is the number of the argument `query` of the function that was called. Throws ArgumentError.
    Question(hausbench_pair* pair, const hausbench_query* query, int argument);
    Question(const Question&) = delete;

    Query query;  // tolerance, poses, limits; the caller sets the rest
    ResolvedTolerance tolerance;

    // Returns the answer for a quantity.
    Answer solve(Quantity quantity);

    // Writes what solve() returned.
    void answer(const Answer& solved, hausbench_answer& answer) const;

    Pair& pair() const { return *pair_; }
    const hausbench_query& caller_query() const { return caller_query_; }

private:
    Opened open(const Query& directed, bool backward);  // as OpenSession
    void show(const Result& so_far);                    // to the caller's progress function
    int status_of(const Result& result) const;
    static int asks_to_stop(void* question);  // the hook of interrupt_

    std::shared_ptr<Pair> pair_;
    hausbench_query caller_query_;
    Interrupt interrupt_;
    bool stop_ = false;  // the progress function has asked to stop
    Chain* chain_ = nullptr;
};

// Returns the pose of a 4 x 4 matrix as in hausbench_query. Throws ArgumentError, with `of` before the name, if it is none.
Pose pose_of(const double* matrix, const char* name, int argument, const char* of = "");

}  // namespace hausbench::library
