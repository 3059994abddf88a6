#include "algorithms/session/session_parts.h"

#include "algorithms/contract.h"
#include "algorithms/error.h"
#include "algorithms/kernel/rounding.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>
#include <thread>

#include <fmt/format.h>

namespace hausbench {
namespace {

void check(const Query& query) {
    const auto fail = [](const char* what, double value, const char* remedy) {
        throw InputError(fmt::format("query: {} is {}; {}", what, value, remedy));
    };
    if (!(query.tolerance.value > 0) || std::isinf(query.tolerance.value)) {
        fail("the tolerance", query.tolerance.value, "give a positive number");
    }
    if (!(query.floor >= 0) || std::isinf(query.floor)) fail("the floor", query.floor, "give a length, or 0 for none");
    if (!(query.cutoff >= 0)) fail("the cutoff", query.cutoff, "give a length, or infinity for none");
    if (!(query.time_limit >= 0)) fail("the time limit", query.time_limit, "give seconds, or infinity for none");
    if (query.threads < 1) fail("the number of threads", query.threads, "give at least 1");
    for (const Pose* pose : {&query.source_pose, &query.target_pose}) {
        if (!pose->rotation.allFinite() || !pose->translation.allFinite())
            throw InputError("query: the pose has an entry that is not finite; give a finite matrix and translation");
    }
}

// A solver's word is not enough: its status has to follow from its bounds. All lengths are scaled by 2^exponent; the note has those of
// the input.
void hold_to_its_status(const Query& query, int exponent, Result& result) {
    if (!claims_an_answer(result.status)) return;
    const auto [lower, upper] = result.bounds;
    const bool possible = may_bound_a_distance(result.bounds);
    if (const auto answer = query.answer(lower, upper); answer && possible) {
        result.status = *answer;
        return;
    }
    const auto length = [&](double scaled) { return std::ldexp(scaled, -exponent); };
    std::string why;
    if (!possible)
        why = fmt::format("its bounds [{:.6g}, {:.6g}] are no interval of distances", length(lower), length(upper));
    else if (result.status == Status::below_floor)
        why = fmt::format("its upper bound {:.6g} is above the floor {:.6g}", length(upper), length(query.floor));
    else if (result.status == Status::above_cutoff)
        why = fmt::format("its lower bound {:.6g} is not above the cutoff {:.6g}", length(lower), length(query.cutoff));
    else
        why = fmt::format("its gap {:.6g} is above the tolerance {:.6g}", length(upper - std::max(lower, query.floor)),
                          length(query.tolerance.gap(lower)));
    result.note = fmt::format("the solver reports {}, but {}", to_string(result.status), why);
    result.status = Status::stalled;
}

std::string refusal_of_shapes(const SolverInfo& info, ShapeKind source, ShapeKind target) {
    const auto text = [&](const char* side, ShapeKind kind) {
        return fmt::format("solver '{}' takes no {} as {}", info.name, to_string(kind), side);
    };
    if (!info.source.contains(source)) return text("source", source);
    if (!info.target.contains(target)) return text("target", target);
    return {};
}

}  // namespace

std::string refusal(const SolverInfo& info, ShapeKind source, ShapeKind target, Quantity quantity) {
    if (const std::string no = refusal_of_shapes(info, source, target); !no.empty()) return no;
    if (info.offers(quantity)) return {};
    if (!info.offers(Quantity::directed))
        return fmt::format("solver '{}' computes {} only, not {}", info.name, symbol(info.quantities.front()),
                           symbol(quantity));
    if (quantity == Quantity::penetration)
        return fmt::format("solver '{}' computes no penetration depth: solver 'penetration' does", info.name);
    const std::string no = refusal_of_shapes(info, target, source);  // of two directions
    return no.empty() ? no : no + ", as H(A,B) asks for";
}

bool scalable(const SolverInfo& info, ShapeKind source, ShapeKind target) {
    // The coefficients of a surface belong to its coordinates.
    return !info.original_coordinates && source != ShapeKind::surface && target != ShapeKind::surface;
}

PreparedPair prepare_pair(const SolverInfo& info, Shape source, Shape target) {
    if (!scalable(info, kind_of(source), kind_of(target)))
        return {std::make_shared<PreparedShape>(std::move(source)), std::make_shared<PreparedShape>(std::move(target))};
    const int exponent = scale_exponent(std::max(magnitude(points_of(source)), magnitude(points_of(target))));
    return {std::make_shared<PreparedShape>(std::move(source), exponent),
            std::make_shared<PreparedShape>(std::move(target), exponent)};
}

namespace {

// Copies a shape only to scale it.
PreparedPair pair_of(const SolverInfo& info, const Scene& scene) {
    if (scalable(info, kind_of(scene.source), kind_of(scene.target)))
        return prepare_pair(info, scene.source, scene.target);
    return {std::make_shared<PreparedShape>(scene.source), std::make_shared<PreparedShape>(scene.target)};
}

}  // namespace

Session::Session(const SolverEntry& entry, const Options& options, PreparedPair pair, const QuerySet& queries,
                 Leave leave)
    : Session(entry, options, std::move(pair.source), std::move(pair.target), queries, leave) {}

Session::Session(const SolverEntry& entry, const Options& options, const Scene& scene, const QuerySet& queries,
                 Leave leave)
    : Session(entry, options, pair_of(entry.info, scene), queries, leave) {}

Session::Session(const SolverEntry& entry, const Options& options, Shapes source, Shapes target,
                 const QuerySet& queries, Leave leave)
    : entry_(entry),
      options_(options),
      leave_(leave),
      queries_(queries),
      source_(std::move(source)),
      target_(std::move(target)),
      exponent_(source_->exponent()) {
    const ShapeKind a = kind_of(source_->shape()), b = kind_of(target_->shape());
    if (const std::string no = refusal_of_shapes(entry.info, a, b); !no.empty()) throw InputError(no);
    if (source_->exponent() != target_->exponent())
        throw std::logic_error("the shapes of a session are scaled by different exponents");
    scalable_ = scalable(entry.info, a, b);
    const bool own = entry.info.offers(Quantity::symmetric);
    if (queries.symmetric) expect(Quantity::symmetric);
    prepare("", source_, target_, queries, forward_);
    QuerySet turned = queries;
    std::swap(turned.moves, turned.target_moves);
    if (queries.symmetric && !own) prepare(" (B to A)", target_, source_, turned, backward_);
}

Session::~Session() = default;
Session::Session(Session&&) noexcept = default;

void Session::expect(Quantity quantity) const {
    const std::string no = refusal(entry_.info, kind_of(source_->shape()), kind_of(target_->shape()), quantity);
    if (!no.empty()) throw InputError(no);
}

Needs Session::needs_of(const Solver& solver, const Scene& scene, const QuerySet& queries) const {
    if (leave_ == Leave::out_what_is_not_needed) return checked_needs(entry_, solver, scene, queries);
    // Of all a solver may ever need, what these shapes have no use for is left out all the same.
    Needs needs = entry_.info.may_need;
    std::erase_if(needs, [&](const Need& need) {
        const Shape& shape = need.side == Side::source ? scene.source : scene.target;
        return !need.structure.fits(kind_of(shape));
    });
    return needs;
}

// Of a solver that offers none, structures are built by one, so that its time is that of one.
Threads Session::builders(const QuerySet& queries) const {
    return Threads(entry_.info.threads ? usable(queries.threads) : 1);
}

int Session::usable(int threads) {
    const auto cores = static_cast<int>(std::thread::hardware_concurrency());  // 0: not known
    return cores > 0 ? std::min(threads, cores) : threads;
}

// Unread as yet, for one more solver.
Options Session::own_options() const {
    return {entry_.info.name, entry_.info.parameters, options_.values(), options_.folder()};
}

std::unique_ptr<Session::Part> Session::make_part(const Shapes& source, const Shapes& target,
                                                  const QuerySet& queries) const {
    auto part = std::make_unique<Part>(Part{{source->shape(), target->shape()}, {}, {}, {}});
    part->solver = make_solver(entry_, own_options());
    part->needs = needs_of(*part->solver, part->scene, queries);
    part->prepared.emplace(source, target, part->needs, builders(queries));
    const auto begin = std::chrono::steady_clock::now();
    held_to_contract(entry_.info.name, "prepare()", [&] { part->solver->prepare(part->scene, *part->prepared); });
    part->solver_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    return part;
}

// Where the target moves and the solver does not offer that, each answer makes its own part: only what is built over the source is
// built here.
void Session::prepare(const std::string& suffix, const Shapes& source, const Shapes& target, QuerySet queries,
                      std::unique_ptr<Part>& part) {
    std::vector<PreparationTime> times;
    Needs needs;
    const bool undone = queries.target_moves && !queries.target_copied && entry_.info.undoes_target_motion;
    if (undone) queries.moves = true;
    if (queries.target_moves && !entry_.info.moving_target && !undone) {
        needs = needs_of(*make_solver(entry_, own_options()), {source->shape(), target->shape()}, queries);
        std::erase_if(needs, [](const Need& need) { return need.side == Side::target; });
        times = Prepared(source, target, needs, builders(queries)).times();
    } else {
        part = make_part(source, target, queries);
        needs = part->needs;
        times = part->prepared->times();
        times.push_back({"solver", part->solver_seconds, part->solver->prepared_bytes()});
    }
    if (suffix.empty()) needs_ = std::move(needs);
    for (PreparationTime& time : times) {
        if (!suffix.empty() && built_for_the_first_direction(time.name)) continue;
        time.name += suffix;
        preparation_.push_back(std::move(time));
    }
}

// Of h(B,A): what is built over its source, B, is of the target of h(A,B), and the other way round.
bool Session::built_for_the_first_direction(const std::string& name) const {
    const bool source = name.starts_with("source "), target = name.starts_with("target ");
    if (!source && !target) return false;
    const std::string other = (source ? "target " : "source ") + name.substr(7);
    return std::any_of(preparation_.begin(), preparation_.end(), [&](const auto& time) {
        return time.name == other || (source_ == target_ && time.name == name);  // one shape may stand on both sides
    });
}

const Prepared& Session::prepared() const {
    if (!forward_) throw std::logic_error("a session whose target moves keeps no structure of its target");
    return *forward_->prepared;
}

std::unique_ptr<State> Session::begin() const { return entry_.info.warm ? std::make_unique<Chain>() : nullptr; }

// One direction, in scaled units; `query` is turned already.
Result Session::directed(const Query& query, bool backward, Chain* chain, Trace& trace) const {
    const Clock clock;
    const Shapes &source = backward ? target_ : source_, &target = backward ? source_ : target_;
    const std::unique_ptr<Part>& kept = backward ? backward_ : forward_;
    Query asked = query;
    std::unique_ptr<Part> made;
    const ShapeExtent a{kind_of(source->shape()), source->largest()}, b{kind_of(target->shape()), target->largest()};
    const std::optional<Undone> undone = undo(entry_.info, query, a, b);
    if (undone) asked = Session::undone(query, *undone);
    const bool copy = !entry_.info.moving_target && !asked.target_pose.is_identity();
    if (copy || !kept) {
        // Of its own in either case, so that every pose pays for its structures, and threads share none that is not built.
        SharedShape still = target->shape();
        if (copy) {
            Shape shape = target->shape();
            points_of(shape) = posed(points_of(shape), query.target_pose);
            still = std::move(shape);
            asked.target_pose = Pose{};
        }
        QuerySet once = queries_;
        once.moves = (backward ? queries_.target_moves : queries_.moves) || !asked.source_pose.is_identity();
        once.target_moves = false;
        once.threads = query.threads;
        made = make_part(source, std::make_shared<PreparedShape>(std::move(still)), once);
        asked.time_limit = clock.left(asked.time_limit);
    }
    const Part& part = made ? *made : *kept;
    State* state = nullptr;
    if (chain) {
        auto& own = chain->states[backward ? 1 : 0];
        if (!own) own = part.solver->begin();
        state = own.get();
        if (state && chain->opposite) state->learn_from(*chain->opposite);
    }
    Result result = part.solver->solve(asked, state, trace);
    hold_to_its_status(asked, exponent_, result);
    if (undone) move_back(result, trace, *undone);
    return result;
}

Result Session::solve(const Query& query, State* state, Trace& trace) const {
    check(query);
    const bool both = query.quantity == Quantity::symmetric && !entry_.info.offers(Quantity::symmetric);
    expect(query.quantity);
    // Both, so that a pose that is refused is refused whatever the other one is.
    const bool source_far = leaves_range(*source_, query.source_pose, "A");
    const bool target_far = leaves_range(*target_, query.target_pose, "B");
    if (source_far || target_far || shrinks(query)) return solve_rescaled(query, trace);

    const Query asked = scaled(query);
    auto* chain = static_cast<Chain*>(state);
    trace.start(exponent_);
    Result result = both ? symmetric(asked, chain, trace) : directed(asked, false, chain, trace);
    if (query.quantity == Quantity::directed) {
        result.witness.direction = Witness::Direction::source_to_target;
        for (Certificate& one : result.certificates) one.direction = Witness::Direction::source_to_target;
    }
    if (!query.wanted.fields || !entry_.info.fields) result.fields.reset();
    if (!query.wanted.certificate || !entry_.info.certificates) result.certificates.clear();
    if (!query.wanted.certificate || !result.certificates.empty()) result.why_no_certificate.clear();
    scale_back(result, trace, widening(*source_, query.source_pose) + widening(*target_, query.target_pose));
    if (entry_.info.traces) trace.finish(result.bounds.lower, result.bounds.upper);

    // Scaling back may have cost what the solver had promised.
    if (claims_an_answer(result.status))
        result.status = query.answer(result.bounds.lower, result.bounds.upper).value_or(Status::precision_floor);
    return result;
}

double Session::prepare_seconds() const {
    double sum = 0;
    for (const PreparationTime& part : preparation_) sum += part.seconds;
    return sum;
}

std::size_t Session::prepare_bytes() const {
    std::size_t sum = 0;
    for (const PreparationTime& part : preparation_) sum += part.bytes;
    return sum;
}

}  // namespace hausbench
