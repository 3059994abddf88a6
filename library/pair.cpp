#include "library/pair.h"

#include "algorithms/registry.h"
#include "algorithms/session/moving_target.h"
#include "datasets/units.h"
#include "harness/ask/tolerance.h"
#include "library/errors.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <string_view>
#include <vector>

namespace hausbench::library {
namespace {

// Reads "name=value". A value is true, false, an integer, a number, or a text.
std::pair<std::string, ParameterValue> parameter_of(std::string_view text) {
    const auto equals = text.find('=');
    if (equals == std::string_view::npos)
        throw ArgumentError(3, fmt::format("plan: parameter '{}': write it as name=value", text));
    const std::string_view value = text.substr(equals + 1);
    const auto read = [&](auto& number) {
        const auto [end, code] = std::from_chars(value.data(), value.data() + value.size(), number);
        return code == std::errc() && end == value.data() + value.size();
    };
    ParameterValue parsed = std::string(value);
    std::int64_t integer = 0;
    double real = 0;
    if (value == "true" || value == "false")
        parsed = value == "true";
    else if (read(integer))
        parsed = integer;
    else if (read(real))
        parsed = real;
    return {std::string(text.substr(0, equals)), parsed};
}

ParameterMap parameters_of(const hausbench_plan& plan) {
    ParameterMap parameters;
    if (plan.parameter_count > 0) given(plan.parameters, "plan: parameters", 3);
    for (std::size_t i = 0; i < plan.parameter_count; ++i)
        parameters.insert_or_assign(parameter_of(given(plan.parameters[i], "plan: a parameter", 3)).first,
                                    parameter_of(plan.parameters[i]).second);
    return parameters;
}

const SolverEntry& solver_of(const hausbench_plan& plan, ShapeKind source, ShapeKind target) {
    const bool mesh = source == ShapeKind::mesh || target == ShapeKind::mesh;
    const std::string name = plan.solver ? plan.solver : mesh ? "cover" : "scan";
    std::vector<std::string> names;
    for (const SolverEntry& entry : solvers()) {
        if (!is_for_plans(entry.info)) continue;
        names.push_back(entry.info.name);
        if (entry.info.name != name) continue;
        if (const std::string no = refusal(entry.info, source, target); !no.empty())
            throw ArgumentError(3, fmt::format("plan: {}: name another solver, or NULL", no));
        return entry;
    }
    for (const NotBuilt& absent : solvers_not_built()) {
        if (absent.name == name) throw ArgumentError(3, fmt::format("plan: no solver '{}': {}", name, absent.reason));
    }
    throw ArgumentError(3, fmt::format("plan: unknown solver '{}'{}", one_line(name), nearest_hint(name, names)));
}

void check(const hausbench_plan& plan) {
    const auto fail = [](const std::string& what) { throw ArgumentError(3, "plan: " + what); };
    if (plan.threads < 1) fail(fmt::format("threads is {}: give at least 1", plan.threads));
    if (plan.first < HAUSBENCH_DIRECTED || plan.first > HAUSBENCH_NOTHING)
        fail(fmt::format("first is {}: give DIRECTED, SYMMETRIC, DISTRIBUTION or NOTHING", plan.first));
    if (plan.moves < 0 || plan.moves > 3) fail(fmt::format("moves is {}: give 0, 1, 2 or 3", plan.moves));
    if (plan.reserved != 0) fail("reserved must be 0");
}

// Throws ArgumentError if both shapes state a unit, or both an axis that points up, and these differ.
void expect_same_units(const Model& source, const Model& target) {
    const Origin &a = source.origin(), &b = target.origin();
    const Stated &of_a = a.report.stated, &of_b = b.report.stated;
    constexpr const char* otherwise = "\"none\" to compare the numbers as they stand";
    if (a.unit != 0 && b.unit != 0 ? a.unit != b.unit : units_differ(of_a, of_b))
        throw ArgumentError(
            2, fmt::format("A ({}) is in {} and B ({}) in {}: read both with unit={}{}", a.name, of_a.unit, b.name,
                           of_b.unit, a.unit != 0 && b.unit != 0 ? "\"mm\", or with unit=" : "", otherwise));
    if (of_a.up != 0 && of_b.up != 0 && of_a.up != of_b.up)
        throw ArgumentError(
            2, fmt::format("{} points up in A ({}) and {} in B ({}): read both with up=\"Z\", or with up={}", of_a.up,
                           a.name, of_b.up, b.name, otherwise));
}

// Prepares what the plan wants at once.
void prepare_first(Pair& pair, const hausbench_plan& plan) {
    Query query;
    query.tolerance.value = 1;
    if (plan.first == HAUSBENCH_NOTHING) return;
    if (plan.first == HAUSBENCH_DISTRIBUTION) query.quantity = Quantity::distribution;
    pair.session(pair.kind_for(query, false, pair.planned()), plan.threads);
    if (plan.first == HAUSBENCH_SYMMETRIC) pair.session(pair.kind_for(query, true, pair.planned()), plan.threads);
}

}  // namespace

bool is_for_plans(const SolverInfo& info) {
    const auto measurable = [](const ShapeSet& set) { return set.points || set.mesh; };
    return info.certified && info.offers(Quantity::directed) && measurable(info.source) && measurable(info.target);
}

Pair::Pair(std::shared_ptr<Model> source, std::shared_ptr<Model> target, const hausbench_plan& plan)
    : source_(std::move(source)),
      target_(std::move(target)),
      entry_(solver_of(plan, source_->kind(), target_->kind())),
      parameters_(parameters_of(plan)),
      extent_(diagonal_of_both(points_of(source_->shape()), points_of(target_->shape()))) {
    (void)Options(entry_.info.name, entry_.info.parameters, parameters_);  // refuses wrong parameters at once
    planned_.moves = (plan.moves & 1) != 0;
    planned_.target_moves = (plan.moves & 2) != 0;
}

Pair::Kind Pair::kind_for(const Query& query, bool backward, const Kind& also) const {
    Kind kind;
    kind.distribution = query.quantity == Quantity::distribution;
    kind.backward = backward;
    kind.symmetric = query.quantity == Quantity::symmetric;
    kind.both_ways = std::any_of(query.statistics.begin(), query.statistics.end(), needs_target);
    kind.moves = !query.source_pose.is_identity() || (backward ? also.target_moves : also.moves);
    kind.target_moves = !query.target_pose.is_identity() || (backward ? also.moves : also.target_moves);
    if (!kind.target_moves || kind.distribution) return kind;
    const Model &from = backward ? *target_ : *source_, &to = backward ? *source_ : *target_;
    kind.target_copied = copies_targets(entry_.info, query, {from.kind(), from.largest()}, {to.kind(), to.largest()});
    return kind;
}

std::shared_ptr<const Session> Pair::session(const Kind& kind, int threads) {
    const std::lock_guard lock(mutex_);
    if (const auto at = sessions_.find(kind); at != sessions_.end()) return at->second;
    const SolverEntry& entry = kind.distribution ? find_solver("distribution") : entry_;
    QuerySet queries;
    queries.symmetric = kind.symmetric;
    queries.both_ways = kind.both_ways;
    queries.moves = kind.moves;
    queries.target_moves = kind.target_moves;
    queries.target_copied = kind.target_copied;
    queries.threads = threads;
    const bool scaled = scalable(entry.info, source_->kind(), target_->kind());
    const int exponent = scaled ? scale_exponent(std::max(source_->largest(), target_->largest())) : 0;
    PreparedPair shapes{source_->prepared(exponent), target_->prepared(exponent)};
    if (kind.backward) std::swap(shapes.source, shapes.target);
    const Options options(entry.info.name, entry.info.parameters, kind.distribution ? ParameterMap() : parameters_);
    std::unique_lock one(source_->building(), std::defer_lock), two(target_->building(), std::defer_lock);
    if (source_ == target_)
        one.lock();
    else
        std::lock(one, two);
    auto session = std::make_shared<const Session>(entry, options, shapes, queries);
    return sessions_.emplace(kind, std::move(session)).first->second;
}

}  // namespace hausbench::library

using namespace hausbench::library;

extern "C" {

int hausbench_prepare(const hausbench_shape* source, const hausbench_shape* target, const hausbench_plan* plan,
                      hausbench_pair** pair, hausbench_error* error) {
    return guarded(error, [&] {
        const hausbench_plan ours = taken<hausbench_plan>(plan, HAUSBENCH_PLAN_INIT, "plan", 3);
        given(pair, "pair", 4);
        check(ours);
        auto a = model_of(source, "source", 1), b = model_of(target, "target", 2);
        expect_same_units(*a, *b);
        auto made = std::make_shared<Pair>(std::move(a), std::move(b), ours);
        prepare_first(*made, ours);
        *pair = new hausbench_pair{std::move(made)};
    });
}

void hausbench_pair_release(hausbench_pair* pair) { delete pair; }

int hausbench_chain_begin(const hausbench_pair* pair, hausbench_chain** chain, hausbench_error* error) {
    return guarded(error, [&] {
        given(chain, "chain", 2);
        *chain = new hausbench_chain{{given(pair, "pair", 1)->pair, {}, {}}};
    });
}

void hausbench_chain_release(hausbench_chain* chain) { delete chain; }

}  // extern "C"
