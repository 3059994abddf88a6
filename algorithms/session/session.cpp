#include "algorithms/session/session.h"

#include "algorithms/error.h"
#include "algorithms/kernel/watched.h"
#include "algorithms/session/moving_target.h"
#include "algorithms/session/symmetric.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

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

void check_statistics(const Query& query, const Shape& source, const Shape& target) {
    if (query.statistics.empty()) throw InputError("query: no statistic is given; name at least one, such as mean");
    if (!(query.share_tolerance > 0))
        throw InputError(
            fmt::format("query: the tolerance of shares is {}; give a positive number", query.share_tolerance));
    if (query.weigh == WeighBy::number) return;
    const CountedBy a = counted_by(source), b = counted_by(target);
    for (const Statistic& statistic : query.statistics) {
        if (statistic.over == Statistic::Over::pooled &&
            WATCHED_ELSE("distribution: lengths and areas are not pooled",
                         a != b && a != CountedBy::nothing && b != CountedBy::nothing,
                         (a == CountedBy::points) != (b == CountedBy::points)))
            throw InputError(fmt::format(
                "query: '{}' would add areas, lengths or numbers of points to each other; count each vertex "
                "once, or take another statistic",
                to_string(statistic)));
    }
}

std::string refusal_of_shapes(const SolverInfo& info, ShapeKind source, ShapeKind target) {
    const auto text = [&](const char* side, ShapeKind kind) {
        return fmt::format("solver '{}' takes no {} as {}", info.name, to_string(kind), side);
    };
    if (!info.source.contains(source)) return text("source", source);
    if (!info.target.contains(target)) return text("target", target);
    return {};
}

// Returns the shapes of the scene, scaled if the solver allows it. Shapes that are not scaled are not copied.
PreparedPair pair_of(const SolverInfo& info, const Scene& scene) {
    if (scalable(info, kind_of(scene.source), kind_of(scene.target)))
        return prepare_pair(info, scene.source, scene.target);
    return {std::make_shared<PreparedShape>(scene.source), std::make_shared<PreparedShape>(scene.target)};
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
    if (quantity == Quantity::distribution)
        return fmt::format("solver '{}' computes no statistics of the distance: solver 'distribution' does", info.name);
    const std::string no = refusal_of_shapes(info, target, source);  // in the second direction, h(B,A)
    return no.empty() ? no : no + ", as H(A,B) asks for";
}

Session::Session(const SolverEntry& entry, const Options& options, const Scene& scene, const QuerySet& queries,
                 Prepare build)
    : Session(entry, options, pair_of(entry.info, scene), queries, build) {}

// The solver for one pair of shapes, before Scaled wraps it, and the cost of preparing both directions.
struct Session::Direct {
    std::unique_ptr<Symmetric> solver;
    const Prepared* prepared;
    Books forward, backward;
};

Session::Session(const SolverEntry& entry, const Options& options, PreparedPair pair, const QuerySet& queries,
                 Prepare build)
    : maker_(std::make_shared<SolverMaker>(entry, options, build)), pair_(std::move(pair)) {
    const std::string no =
        refusal_of_shapes(entry.info, kind_of(pair_.source->shape()), kind_of(pair_.target->shape()));
    if (!no.empty()) throw InputError(no);
    if (WATCHED("session: shapes of different exponents", pair_.source->exponent() != pair_.target->exponent()))
        throw std::logic_error("the shapes of a session are scaled by different exponents");
    if (queries.symmetric) expect(Quantity::symmetric);
    Direct direct = wired(maker_, pair_, queries);
    prepared_ = direct.prepared;
    needs_ = direct.forward.needs;
    keep_books(std::move(direct.forward), "");
    keep_books(std::move(direct.backward), " (B to A)");
    solver_ = std::make_unique<Scaled>(
        entry.info, pair_, std::move(direct.solver),
        [maker = maker_](const PreparedPair& other, const QuerySet& once) { return wired(maker, other, once).solver; });
}

Session::~Session() = default;
Session::Session(Session&&) noexcept = default;

Session::Direct Session::wired(const std::shared_ptr<const SolverMaker>& maker, const PreparedPair& pair,
                               const QuerySet& queries) {
    QuerySet turned = queries;
    if (WATCHED("session: moves of the second direction", true)) std::swap(turned.moves, turned.target_moves);
    auto forward = std::make_unique<MovingTarget>(maker, pair.source, pair.target, queries);
    auto backward = std::make_unique<MovingTarget>(maker, pair.target, pair.source, turned);
    Direct direct;
    direct.forward = forward->keep();
    if (queries.symmetric && !maker->info().offers(Quantity::symmetric)) direct.backward = backward->keep();
    direct.prepared = forward->prepared();
    direct.solver = std::make_unique<Symmetric>(maker->info(), std::move(forward), std::move(backward));
    return direct;
}

void Session::expect(Quantity quantity) const {
    const std::string no =
        refusal(maker_->info(), kind_of(pair_.source->shape()), kind_of(pair_.target->shape()), quantity);
    if (!no.empty()) throw InputError(no);
}

void Session::keep_books(Books books, const std::string& suffix) {
    for (PreparationTime& time : books.times) {
        if (WATCHED("session: a structure of both directions counts once",
                    !suffix.empty() && built_for_the_first_direction(time.name)))
            continue;
        time.name += suffix;
        preparation_.push_back(std::move(time));
    }
}

// Returns whether a structure for h(B,A) was already built for h(A,B). The source of h(B,A) is the target of h(A,B),
// so the "source BVH" of h(B,A) is the "target BVH" of h(A,B).
bool Session::built_for_the_first_direction(const std::string& name) const {
    const bool source = name.starts_with("source "), target = name.starts_with("target ");
    if (!source && !target) return false;
    const std::string other = (source ? "target " : "source ") + name.substr(7);
    return std::any_of(preparation_.begin(), preparation_.end(), [&](const auto& time) {
        return time.name == other || (pair_.source == pair_.target && time.name == name);  // A and B are one shape
    });
}

const Prepared& Session::prepared() const {
    if (!prepared_) throw std::logic_error("a session whose target moves keeps no structure of its target");
    return *prepared_;
}

std::unique_ptr<State> Session::begin() const { return maker_->info().can(Ability::warm) ? solver_->begin() : nullptr; }

Result Session::solve(const Query& query, State* state, Trace& trace) const {
    check(query);
    if (WATCHED("session: the direction that a solver does not take", true)) expect(query.quantity);
    if (query.quantity == Quantity::distribution) check_statistics(query, pair_.source->shape(), pair_.target->shape());
    Query inner = query;
    inner.threads = usable_threads(query.threads);
    // The bounds that a solver without this ability offers need not hold before its answer.
    Trace unwatched;
    const bool shows = maker_->info().can(Ability::traces) || query.quantity == Quantity::distribution;
    Result result = solver_->solve(inner, state, shows || trace.on() ? trace : unwatched);
    if (query.quantity == Quantity::directed) {
        result.witness.direction = Witness::Direction::source_to_target;
        for (Certificate& certificate : result.certificates)
            certificate.direction = Witness::Direction::source_to_target;
    }
    if (WATCHED("session: fields that nobody wants", !query.wanted.fields || !maker_->info().can(Ability::fields)))
        result.fields.reset();
    if (WATCHED("session: certificates that nobody wants",
                !query.wanted.certificate || !maker_->info().can(Ability::certificates)))
        result.certificates.clear();
    if (!query.wanted.certificate || !result.certificates.empty()) result.why_no_certificate.clear();
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
