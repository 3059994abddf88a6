#include "algorithms/session/prepared_solver.h"

#include "algorithms/contract.h"
#include "algorithms/kernel/watched.h"

#include <cmath>
#include <thread>

#include <fmt/format.h>

namespace hausbench {
namespace {

// If the status claims an answer, replaces it with the status that follows from the bounds. If none follows, sets it to
// `stalled` and says why in the note. Lengths in `query` and `result` are scaled by 2^exponent; the note gives them in
// the unit of the input.
void hold_to_its_status(const Query& query, int exponent, Result& result) {
    if (!claims_an_answer(result.status)) return;
    if (query.quantity == Quantity::distribution) {
        if (query.within_tolerance(result.statistics)) return;
        result.note = "the solver reports converged, but a statistic is not within the tolerance";
        result.status = Status::stalled;
        return;
    }
    const auto [lower, upper] = result.bounds;
    const bool possible = may_bound_a_distance(result.bounds);
    if (const auto answer = query.answer(lower, upper); answer && possible) {
        result.status = *answer;
        return;
    }
    const auto length = [&](double scaled) { return std::ldexp(scaled, -exponent); };
    std::string why;
    if (!possible)
        why = fmt::format("its bounds [{:.6g}, {:.6g}] are not an interval of distances", length(lower), length(upper));
    else if (result.status == Status::below_floor)
        why = fmt::format("its upper bound {:.6g} is above the floor {:.6g}", length(upper), length(query.floor));
    else if (result.status == Status::above_cutoff)
        why = fmt::format("its lower bound {:.6g} is not above the cutoff {:.6g}", length(lower), length(query.cutoff));
    else
        why = fmt::format("its gap {:.6g} is above the tolerance {:.6g}", length(upper - std::max(lower, query.floor)),
                          length(query.tolerance.gap(lower)));
    result.note = fmt::format("the solver reports {}, but {}", to_string(result.status), why);
    if (WATCHED("session: a status that its bounds do not show", true)) result.status = Status::stalled;
}

}  // namespace

int usable_threads(int threads) {
    const auto cores = static_cast<int>(std::thread::hardware_concurrency());  // 0: unknown
    return cores > 0 ? std::min(threads, cores) : threads;
}

SolverMaker::SolverMaker(SolverEntry entry, Options options, Prepare build)
    : entry_(std::move(entry)), options_(std::move(options)), build_(build) {}

std::unique_ptr<Solver> SolverMaker::make() const {
    return make_solver(entry_, Options(entry_.info.name, entry_.info.parameters, options_.values(), options_.folder()));
}

Needs SolverMaker::needs_of(const Solver& solver, const Scene& scene, const QuerySet& queries) const {
    if (WATCHED_ELSE("session: nothing is left out", build_ == Prepare::needed_only, true))
        return checked_needs(entry_, solver, scene, queries);
    // Every structure that the solver may ever need, except those that cannot be built over these kinds of shapes.
    Needs needs = entry_.info.may_need;
    std::erase_if(needs, [&](const Need& need) {
        const Shape& shape = need.side == Side::source ? scene.source : scene.target;
        return !need.structure.fits(kind_of(shape));
    });
    return needs;
}

Threads SolverMaker::builders(const QuerySet& queries) const {
    return Threads(entry_.info.can(Ability::threads) ? usable_threads(queries.threads) : 1);
}

PreparedSolver::PreparedSolver(const SolverMaker& maker, const SharedPreparedShape& source,
                               const SharedPreparedShape& target, const QuerySet& queries)
    : exponent_(source->exponent()), scene_{source->shape(), target->shape()}, solver_(maker.make()) {
    needs_ = maker.needs_of(*solver_, scene_, queries);
    prepared_.emplace(source, target, needs_, maker.builders(queries));
    const WallClock clock;
    held_to_contract(maker.info().name, "prepare()", [&] { solver_->prepare(scene_, *prepared_); });
    solver_seconds_ = clock.elapsed();
}

Result PreparedSolver::solve(const Query& query, State* state, Trace& trace) const {
    Result result = solver_->solve(query, state, trace);
    hold_to_its_status(query, exponent_, result);
    return result;
}

Books PreparedSolver::books() const {
    Books books{needs_, prepared_->times()};
    books.times.push_back({"solver", solver_seconds_, solver_->prepared_bytes()});
    return books;
}

}  // namespace hausbench
