#include "session.h"

#include "error.h"
#include "kernel/rounding.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <span>
#include <stdexcept>

#include <fmt/format.h>

namespace hausbench {
namespace {

double scaled_back(double value, int exponent, double (*outward)(double)) {
    const double original = std::ldexp(value, -exponent);
    return std::ldexp(original, exponent) == value || std::isinf(value) ? original : outward(original);
}

// A length that must stay positive and finite.
double scaled_tolerance(double value, int exponent) {
    return std::clamp(std::ldexp(value, exponent), std::numeric_limits<double>::denorm_min(),
                      std::numeric_limits<double>::max());
}

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

bool claims_an_answer(Status status) {
    return status == Status::converged || status == Status::below_floor || status == Status::above_cutoff;
}

void add(Counters& sum, const Counters& more) {
    for (const CounterField& field : counter_fields) sum.*field.member += more.*field.member;
}

// A solver's word is not enough: its status has to follow from its bounds.
void hold_to_its_status(const Query& query, Result& result) {
    if (!claims_an_answer(result.status)) return;
    if (const auto answer = query.answer(result.bounds.lower, result.bounds.upper)) {
        result.status = *answer;
        return;
    }
    result.note = fmt::format("the solver reports {}, but {}", to_string(result.status),
                              result.status == Status::converged     ? "its gap is above the tolerance"
                              : result.status == Status::below_floor ? "its upper bound is above the floor"
                                                                     : "its lower bound is not above the cutoff");
    result.status = Status::stalled;
}

}  // namespace

std::string_view to_string(Status status) {
    constexpr std::string_view names[] = {"converged", "below_floor",     "above_cutoff", "time_limit",
                                          "budget",    "precision_floor", "stalled"};
    return names[static_cast<std::size_t>(status)];
}

std::string_view to_string(Quantity quantity) { return quantity == Quantity::symmetric ? "symmetric" : "directed"; }

std::string_view to_string(Witness::Direction direction) {
    return direction == Witness::Direction::source_to_target ? "source to target" : "target to source";
}

std::string refusal(const SolverInfo& info, ShapeKind source, ShapeKind target) {
    const auto text = [&](const char* side, ShapeKind kind) {
        return fmt::format("solver '{}' takes no {} as {}", info.name, to_string(kind), side);
    };
    if (!info.source.contains(source)) return text("source", source);
    if (!info.target.contains(target)) return text("target", target);
    return {};
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

struct Session::Part {
    Scene scene;
    Needs needs;
    std::optional<Prepared> prepared;
    std::unique_ptr<Solver> solver;
    double solver_seconds = 0;
};

// Wall time since it was made.
struct Session::Clock {
    std::chrono::steady_clock::time_point begin = std::chrono::steady_clock::now();

    double elapsed() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count(); }
    double left(double limit) const { return std::max(0.0, limit - elapsed()); }
};

// How H(A,B) begins.
struct Session::Opening {
    bool backward = false;          // h(B,A) comes first
    std::optional<Result> forward;  // h(A,B), where it has its answer already
    double begin = 0;               // of that answer, in seconds
    Counters spent;                 // on what is not in an answer
};

struct Session::Chain final : State {
    std::unique_ptr<State> states[2];  // forward, backward; made by the first answer
};

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
    if (const std::string no = refusal(entry.info, a, b); !no.empty()) throw InputError(no);
    if (source_->exponent() != target_->exponent())
        throw std::logic_error("the shapes of a session are scaled by different exponents");
    scalable_ = scalable(entry.info, a, b);
    const bool own = entry.info.offers(Quantity::symmetric);
    if (queries.symmetric && !own) expect_both_directions();
    prepare("", source_, target_, queries, forward_);
    QuerySet turned = queries;
    std::swap(turned.moves, turned.target_moves);
    if (queries.symmetric && !own) prepare(" (B to A)", target_, source_, turned, backward_);
}

Session::~Session() = default;
Session::Session(Session&&) noexcept = default;

void Session::expect_both_directions() const {
    const std::string no = refusal(entry_.info, kind_of(target_->shape()), kind_of(source_->shape()));
    if (!no.empty()) throw InputError(no + ", as H(A,B) asks for");
}

Needs Session::needs_of(const Solver& solver, const Scene& scene, const QuerySet& queries) const {
    if (leave_ == Leave::out_what_is_not_needed) return solver.needs(scene, queries);
    // Of all a solver may ever need, what these shapes have no use for is left out all the same.
    Needs needs = entry_.info.may_need;
    std::erase_if(needs, [&](const Need& need) {
        const Shape& shape = need.side == Side::source ? scene.source : scene.target;
        return !need.structure.fits(kind_of(shape));
    });
    return needs;
}

std::unique_ptr<Session::Part> Session::make_part(const Shapes& source, const Shapes& target,
                                                  const QuerySet& queries) const {
    auto part = std::make_unique<Part>(Part{{source->shape(), target->shape()}, {}, {}, {}});
    const SolverInfo& info = entry_.info;
    const Options own(info.name, info.parameters, options_.values());
    part->solver = entry_.make(own);
    if (const auto unread = own.unread(); !unread.empty())
        throw std::logic_error("solver '" + info.name + "' does not read its parameter '" + unread.front() + "'");

    part->needs = needs_of(*part->solver, part->scene, queries);
    for (const Need& need : part->needs) {
        if (std::find(info.may_need.begin(), info.may_need.end(), need) == info.may_need.end())
            throw std::logic_error("solver '" + info.name + "' needs a " + to_string(need) +
                                   " that is not in may_need");
    }
    part->prepared.emplace(source, target, part->needs);
    const auto begin = std::chrono::steady_clock::now();
    part->solver->prepare(part->scene, *part->prepared);
    part->solver_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    return part;
}

// Where the target moves and the solver does not offer that, each answer makes its own part: only what is built over the source is
// built here.
void Session::prepare(const std::string& suffix, const Shapes& source, const Shapes& target, const QuerySet& queries,
                      std::unique_ptr<Part>& part) {
    std::vector<PreparationTime> times;
    Needs needs;
    if (queries.target_moves && !entry_.info.moving_target) {
        const Options own(entry_.info.name, entry_.info.parameters, options_.values());
        needs = needs_of(*entry_.make(own), {source->shape(), target->shape()}, queries);
        std::erase_if(needs, [](const Need& need) { return need.side == Side::target; });
        times = Prepared(source, target, needs).times();
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
    return std::any_of(preparation_.begin(), preparation_.end(), [&](const auto& time) { return time.name == other; });
}

const Prepared& Session::prepared() const {
    if (!forward_) throw std::logic_error("a session whose target moves keeps no structure of its target");
    return *forward_->prepared;
}

std::unique_ptr<State> Session::begin() const { return entry_.info.warm ? std::make_unique<Chain>() : nullptr; }

// At least the largest |coordinate| that any step of posing the shape can reach, scaled: S below.
double Session::posed_extent(const PreparedShape& shape, const Pose& pose) const {
    double translation = 0;
    for (const double t : pose.translation) translation = std::max(translation, std::abs(std::ldexp(t, exponent_)));
    return 3 * (pose.rotation.cwiseAbs().maxCoeff() * shape.largest()) + translation;
}

// How far the points of one shape that the solver measures may be from those that the definition means, in scaled units. The distance
// changes by no more than A's and B's together.
//
// Scaling: a coordinate that it rounds is off by 2^-1075, so a point by less than 2^-1074, which is `lost`.
//
// Posing: in each coordinate the definition says D = s fl(R v + t), and the solver measures C = fl(R v' + t'), where s is the
// power of two 2^e, and v' and t' are the scaled v and t. Where v' = s v, t' = s t and no product underflows in either unit,
// they are the same bits: scaling by s commutes with each rounding, and a sum that underflows is exact. Otherwise both are
// held against the exact value s (R v + t). With r = max |R_ij| and S = 3 r max |v'| + max |t'|, the roundings of products and
// sums are 4u(1 + 4u) S on either side, each of the three products may lose 2^-1075 in its own unit, t' may lose 2^-1075, and
// the products carry what v' has lost, 3 r 2^-1075. With q = 2^(max(e, 0) - 1074), the coarser of the two units of underflow,
//   |C - D| <= 8.01 u S + (3 + 3 + 1) q / 2 + 1.5 r lost,
// and in length, with sqrt 3 < 1.733, 13.9 u S + 6.1 q + 2.6 r lost. What is computed below rounds by less than 8u of itself
// and underflows by less than q: 8 q covers the two.
double Session::widening(const PreparedShape& shape, const Pose& pose) const {
    if (pose.is_identity()) return shape.lost();
    if (exponent_ == 0) return 0;
    double least = std::numeric_limits<double>::infinity();
    for (const double entry : pose.rotation.reshaped()) {
        if (entry != 0) least = std::min(least, std::abs(entry));
    }
    const bool exact_translation = pose.translation.unaryExpr([&](double t) {
        return std::ldexp(std::ldexp(t, exponent_), -exponent_);
    }) == pose.translation;
    // Exponents, so that no product here underflows itself.
    const auto exponent_of = [](double x) { return std::isfinite(x) ? std::ilogb(x) : 0; };
    const int product = exponent_of(least) + exponent_of(shape.smallest());
    const bool same_bits = shape.lost() == 0 && exact_translation && product >= -1022 && product - exponent_ >= -1022;
    if (same_bits) return 0;
    const double most = pose.rotation.cwiseAbs().maxCoeff();
    return 3 * (most * shape.lost()) + 14 * unit_roundoff * posed_extent(shape, pose) +
           8 * std::ldexp(1.0, std::max(exponent_, 0) - 1074);
}

// Whether the pose needs another scale.
bool Session::leaves_range(const PreparedShape& shape, const Pose& pose, const char* name) const {
    if (pose.is_identity()) return false;
    if (kind_of(shape.shape()) == ShapeKind::surface) {
        throw InputError(
            "query: an algebraic surface cannot be moved; write the motion into its polynomial, or triangulate it "
            "first");
    }
    const double extent = posed_extent(shape, pose);
    if (extent <= largest_safe_coordinate && std::ldexp(extent, -exponent_) < 0x1p1023) return false;
    const Points there = posed(shape.original(), pose);
    if (!there.allFinite()) {
        throw InputError(fmt::format(
            "query: the pose moves a point of {} beyond the largest double, 1.8e308; give a smaller rotation "
            "and translation, or both shapes in a larger unit",
            name));
    }
    return scalable_ && std::ldexp(magnitude(there), exponent_) > largest_safe_coordinate;
}

// Both shapes posed as they are in the units of the input, scaled anew, at rest.
Result Session::solve_rescaled(const Query& query, Trace& trace) const {
    const auto at_rest = [](const PreparedShape& prepared, const Pose& pose) {
        Shape shape = prepared.shape();
        points_of(shape) = posed(prepared.original(), pose);
        return shape;
    };
    PreparedPair pair =
        prepare_pair(entry_.info, at_rest(*source_, query.source_pose), at_rest(*target_, query.target_pose));
    Query still = query;
    still.source_pose = still.target_pose = Pose{};
    QuerySet once;
    once.finest_tolerance = query.tolerance.of == Tolerance::Of::absolute ? query.tolerance.value : 0;
    once.symmetric = query.quantity == Quantity::symmetric;
    return Session(entry_, options_, pair.source, pair.target, once, leave_).solve(still, trace);
}

Query Session::scaled(const Query& query) const {
    Query out = query;
    for (double& value : out.source_pose.translation) value = std::ldexp(value, exponent_);
    for (double& value : out.target_pose.translation) value = std::ldexp(value, exponent_);
    if (query.tolerance.of == Tolerance::Of::absolute) {
        out.tolerance.value = scaled_tolerance(query.tolerance.value, exponent_);
    }
    out.floor = std::min(std::ldexp(query.floor, exponent_), std::numeric_limits<double>::max());
    out.cutoff = std::ldexp(query.cutoff, exponent_);
    return out;
}

void Session::scale_back(Result& result, Trace& trace, double wider) const {
    const auto down = [&](double& lower) {
        if (wider > 0) lower = std::max(0.0, next_down(lower - wider));
        if (exponent_ != 0) lower = scaled_back(lower, exponent_, next_down);
    };
    const auto up = [&](double& upper) {
        if (wider > 0) upper = next_up(upper + wider);
        if (exponent_ != 0) upper = scaled_back(upper, exponent_, next_up);
    };
    down(result.bounds.lower);
    up(result.bounds.upper);
    for (TraceSample& sample : trace.samples()) down(sample.lower), up(sample.upper);
    for (std::size_t i = 0; result.fields && i < result.fields->size(); ++i) {
        Field& field = (*result.fields)[i];
        for (double& value : field.values) {
            if (field.meaning == Field::Meaning::lower) down(value);
            if (field.meaning == Field::Meaning::upper) up(value);
        }
    }
    for (double& value : result.witness.source_point) value = std::ldexp(value, -exponent_);
    for (double& value : result.witness.target_point) value = std::ldexp(value, -exponent_);
}

bool Session::copies_target(const Query& query) const {
    if (entry_.info.moving_target) return false;
    const bool both = query.quantity == Quantity::symmetric && !entry_.info.offers(Quantity::symmetric);
    return queries_.target_moves || !query.target_pose.is_identity() ||
           (both && (queries_.moves || !query.source_pose.is_identity()));
}

// One direction, in scaled units; `query` is turned already.
Result Session::directed(const Query& query, bool backward, Chain* chain, Trace& trace) const {
    const Clock clock;
    const Shapes &source = backward ? target_ : source_, &target = backward ? source_ : target_;
    const std::unique_ptr<Part>& kept = backward ? backward_ : forward_;
    Query asked = query;
    std::unique_ptr<Part> made;
    const bool copy = !entry_.info.moving_target && !query.target_pose.is_identity();
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
        once.moves = (backward ? queries_.target_moves : queries_.moves) || !query.source_pose.is_identity();
        once.target_moves = false;
        made = make_part(source, std::make_shared<PreparedShape>(std::move(still)), once);
        asked.time_limit = clock.left(asked.time_limit);
    }
    const Part& part = made ? *made : *kept;
    State* state = nullptr;
    if (chain) {
        auto& own = chain->states[backward ? 1 : 0];
        if (!own) own = part.solver->begin();
        state = own.get();
    }
    Result result = part.solver->solve(asked, state, trace);
    hold_to_its_status(asked, result);
    return result;
}

// One direction of H(A,B), in scaled units; its witness names points of A and of B as that of H does.
Result Session::one_of_both(Query query, bool backward, Chain* chain, Trace& trace) const {
    query.quantity = Quantity::directed;
    if (backward) std::swap(query.source_pose, query.target_pose);
    trace.start();
    Result result = directed(query, backward, chain, trace);
    result.certificate.reset();  // it proves nothing of the other direction
    if (!backward) return result;
    std::swap(result.witness.source_point, result.witness.target_point);
    std::swap(result.witness.source_element, result.witness.target_element);
    result.witness.direction = Witness::Direction::target_to_source;
    result.fields.reset();  // they are of B
    Reported reported;
    for (auto& [name, value] : result.reported) reported[name + " (B to A)"] = value;
    result.reported = std::move(reported);
    return result;
}

// A gap relative to the lower bound is never small enough where that bound is 0, as that of h(A,B) is where A is a part of B. So
// where the tolerance is of that kind, a little work on both directions says which one seems to be the larger: that one comes
// first, and its lower bound is the floor of the other. An answer that takes little work is kept.
Session::Opening Session::open(Query query, const Clock& clock, Trace& trace) const {
    Opening opening;
    const std::uint64_t most = query.budget;
    if (query.tolerance.of != Tolerance::Of::lower || entry_.info.exact) return opening;
    for (query.budget = 64; query.budget<most; query.budget = query.budget> most / 16 ? most : 16 * query.budget) {
        const double limit = query.time_limit;
        Query asked = query;
        asked.time_limit = clock.left(limit);
        opening.begin = clock.elapsed();
        Result forward = one_of_both(asked, false, nullptr, trace);
        if (forward.status != Status::budget) {
            opening.forward = std::move(forward);
            return opening;
        }
        asked.time_limit = clock.left(limit);
        const Result backward = one_of_both(asked, true, nullptr, trace);
        add(opening.spent, forward.counters);
        add(opening.spent, backward.counters);
        opening.backward = backward.status != Status::budget || backward.bounds.lower > forward.bounds.lower;
        if (opening.backward || forward.bounds.lower > 0) return opening;
    }
    return opening;
}

// Adds what is known of the other direction.
void Session::join(Result& whole, const Result& other) {
    if (other.bounds.lower > whole.bounds.lower) {
        whole.bounds.lower = other.bounds.lower;
        whole.witness = other.witness;
    }
    // Where the bounds of H are still apart, it is the direction with the larger upper bound that keeps them apart, and says why.
    // A NaN is no bound at all.
    if (other.bounds.upper > whole.bounds.upper || std::isnan(other.bounds.upper)) {
        whole.bounds.upper = other.bounds.upper;
        whole.status = other.status;
        whole.note = other.note;
    }
    if (!whole.fields) whole.fields = other.fields;
    add(whole.counters, other.counters);
    whole.reported.insert(other.reported.begin(), other.reported.end());
    whole.reported_seconds += other.reported_seconds;
    whole.outside_bytes = std::max(whole.outside_bytes, other.outside_bytes);
}

// H(A,B) = max(h(A,B), h(B,A)), in scaled units.
Result Session::symmetric(const Query& query, Chain* chain, Trace& trace) const {
    const Clock clock;
    Trace one(trace.on() ? Trace::Mode::on : Trace::Mode::off), two = one;
    Query asked = query;
    Opening opening = open(query, clock, one);
    const double before = opening.forward ? opening.begin : clock.elapsed();
    asked.time_limit = clock.left(query.time_limit);
    Result whole = opening.forward ? std::move(*opening.forward) : one_of_both(asked, opening.backward, chain, one);
    add(whole.counters, opening.spent);
    constexpr double infinity = std::numeric_limits<double>::infinity();
    // Until the other direction has a bound, H(A,B) has none from above.
    for (const TraceSample& sample : one.samples())
        trace.samples().push_back({before + sample.seconds, sample.lower, infinity});
    if (whole.bounds.lower > query.cutoff) {
        whole.bounds.upper = infinity;
        whole.status = Status::above_cutoff;
        whole.note.clear();
        return whole;
    }
    const double first = clock.elapsed();
    asked.time_limit = clock.left(query.time_limit);
    asked.floor = std::max(query.floor, whole.bounds.lower);
    // A floor that is the cutoff would ask a question that nobody asked.
    if (query.floor < query.cutoff && asked.floor >= query.cutoff) asked.floor = next_down(query.cutoff);
    const Result other = one_of_both(asked, !opening.backward, chain, two);
    for (const TraceSample& sample : two.samples()) {
        trace.samples().push_back({first + sample.seconds, std::max(whole.bounds.lower, sample.lower),
                                   std::max(whole.bounds.upper, sample.upper)});
    }
    join(whole, other);
    if (const auto answer = query.answer(whole.bounds.lower, whole.bounds.upper)) {
        whole.status = *answer;
        whole.note.clear();
    }
    return whole;
}

Result Session::solve(const Query& query, State* state, Trace& trace) const {
    check(query);
    const bool both = query.quantity == Quantity::symmetric && !entry_.info.offers(Quantity::symmetric);
    if (both) expect_both_directions();
    // Both, so that a pose that is refused is refused whatever the other one is.
    const bool source_far = leaves_range(*source_, query.source_pose, "A");
    const bool target_far = leaves_range(*target_, query.target_pose, "B");
    if (source_far || target_far) return solve_rescaled(query, trace);

    const Query asked = scaled(query);
    auto* chain = static_cast<Chain*>(state);
    trace.start(exponent_);
    Result result = both ? symmetric(asked, chain, trace) : directed(asked, false, chain, trace);
    if (!query.wanted.fields || !entry_.info.fields) result.fields.reset();
    if (!query.wanted.certificate) result.certificate.reset();
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
