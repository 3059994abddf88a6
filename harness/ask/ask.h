// Asks for a quantity of two shapes, with as many queries as the answer needs, all within one time limit.
#pragma once

#include "algorithms/solver.h"

#include <functional>
#include <memory>
#include <optional>

namespace hausbench {

class Session;

// What ask() has found. Times are wall times, in seconds.
struct Answer {
    Result result;
    // For H(A,B) in both directions: the answers for h(A,B) and h(B,A), as far as they were asked. In all three the
    // source point of the witness is on A.
    std::optional<Result> forward, backward;
    double prepare_seconds = 0;  // to open sessions
    double solve_seconds = 0, forward_seconds = 0, backward_seconds = 0;
};

// A session that answers a query. `state` belongs to a chain of nearby poses; null: none.
struct Opened {
    std::shared_ptr<const Session> session;
    State* state = nullptr;
};

// Returns the session for a query. If `backward`, the query is about h(B,A): its poses are swapped, and the source of the
// session must be B. May throw BuildingStopped if the interrupt of the query asks to stop.
using OpenSession = std::function<Opened(const Query& query, bool backward)>;

// How to ask for H(A,B) if the tolerance is a fraction of the lower bound: a direction of distance 0 would then never end.
enum class Directions {
    unknown,  // one query, for H(A,B) alone
    known,    // the same, and then each direction with the gap allowed for H(A,B), if that converged
};

// Answers a query, which may be about H(A,B). With an absolute tolerance, H(A,B) is answered by h(A,B) and h(B,A), each to
// the full tolerance. If h(A,B) alone is above the cutoff, h(B,A) is not asked for, and H(A,B) has no upper bound, unless
// a certificate is wanted. (Symmetric in algorithms/session/ answers H(A,B) alone: it may stop the second direction once
// that is known to be below the first.)
//
// Calls `closer` with bounds on the way. If the interrupt of the query ends it while a structure is built, the answer has
// the bounds [0, infinity] and the status `time_limit`. Throws what Session::solve() throws.
Answer ask(const Query& query, const OpenSession& open, Directions directions,
           const std::function<void(const Answer&)>& closer = nullptr);

}  // namespace hausbench
