// Every certified mesh solver on pairs of degenerate triangles, and on soups that mix triangles of all sizes,
// against the exact distance in rationals. Uncertified variants are the control: they must be found wrong.
//
//     HAUSBENCH_PAIRS=1000000 HAUSBENCH_SEED=1 HAUSBENCH_SOLVERS=guthe,tang build/release/tests/degenerate_pairs
//     HAUSBENCH_PAIRS=100000 HAUSBENCH_SOLVERS=cover build/release/tests/degenerate_pairs --gtest_filter='MixedSizes.*'
//
// HAUSBENCH_FIRST is the number of the first pair. A pair depends only on the seed and its number.
// results/reference/degenerate_pairs.md has the results of a million pairs.
#include "tests/support/degenerate_pairs.h"
#include "algorithms/registry.h"
#include "algorithms/session/session.h"
#include "tests/support/mixed_sizes.h"
#include "tests/support/quick_options.h"
#include "tests/support/scenes.h"

#include <cstdlib>
#include <optional>

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace hausbench {
namespace {

std::uint64_t setting(const char* name, std::uint64_t otherwise) {
    const char* text = std::getenv(name);
    return text ? std::strtoull(text, nullptr, 10) : otherwise;
}

// Sanitizers make a solve ten times slower.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr std::uint64_t few = 500;
#else
constexpr std::uint64_t few = 3000;
#endif

bool chosen(const std::string& name) {
    const char* text = std::getenv("HAUSBENCH_SOLVERS");
    return !text || fmt::format(",{},", text).find("," + name + ",") != std::string::npos;
}

// A solver and its sets of options; each pair takes the next set.
struct Candidate {
    const SolverEntry* entry;
    std::string label;
    std::vector<Options> options;
    std::uint64_t pairs = 0, wrong = 0, converged = 0, unfinished = 0, thrown = 0;
    std::uint64_t far =
        0;  // wrong by more than 1e-9 of the largest coordinate, a normal double, which rounding cannot explain
    double worst_gap =
        0;  // relative to the largest coordinate, over pairs that converged or reached the precision of normal doubles
};

std::vector<Candidate> certified_solvers() {
    std::vector<Candidate> all;
    for (const SolverEntry& entry : solvers()) {
        if (!entry.info.certified || !entry.info.source.mesh || !entry.info.target.mesh ||
            !entry.info.offers(Quantity::directed))
            continue;
        Candidate candidate{&entry, entry.info.name, {}};
        for (const ParameterMap& given : variants_of(entry)) {
            const Options options = quick_options(entry, given);
            if (entry.make(options)->certified()) candidate.options.push_back(options);
        }
        if (chosen(candidate.label)) all.push_back(std::move(candidate));
    }
    return all;
}

std::vector<Candidate> controls() {
    std::vector<Candidate> all;
    const SolverEntry& guthe = find_solver("guthe");
    for (const auto& [label, given] : std::vector<std::pair<std::string, ParameterMap>>{
             {"guthe kernel=textbook", {{"kernel", std::string("textbook")}}},
             {"guthe textbook, certify=false", {{"kernel", std::string("textbook")}, {"certify", false}}},
             {"guthe certify=false", {{"certify", false}}}})
        all.push_back({&guthe, label, {quick_options(guthe, given)}});
    for (const SolverEntry& entry : solvers())
        if (entry.info.name == "cgal") all.push_back({&entry, "cgal", {quick_options(entry)}});
    std::erase_if(all, [](const Candidate& candidate) { return !chosen(candidate.label); });
    return all;
}

TriangleMesh mesh_of(const std::vector<Triangle>& triangles) {
    Points points(static_cast<Index>(3 * triangles.size()), 3);
    Index row = 0;
    for (const Triangle& t : triangles)
        for (const Vec3* corner : {&t.a, &t.b, &t.c}) points.row(row++) = *corner;
    return soup(points);
}

// A scene, with a lower and an upper bound on its squared distance.
struct Case {
    std::string kind;
    TriangleMesh a, b;
    exact::Rational least, most;

    double extent() const { return std::max(magnitude(a.vertices), magnitude(b.vertices)); }  // largest |coordinate|
};

Case degenerate_pair(std::uint64_t seed, std::uint64_t number) {
    const degenerate::Pair pair = degenerate::pair(seed, number);
    const exact::Rational squared = degenerate::squared_distance(pair);
    return {pair.kind, mesh_of({pair.a}), mesh_of({pair.b}), squared, squared};
}

Case mixed_soups(std::uint64_t seed, std::uint64_t number) {
    const mixed_sizes::Soups soups = mixed_sizes::soups(seed, number);
    const mixed_sizes::Bracket squared = mixed_sizes::squared_distance(soups);
    return {"mixed sizes", mesh_of(soups.a), mesh_of(soups.b), squared.low, squared.high};
}

// Returns by how much the distance lies outside the bounds, as a fraction of the largest coordinate. Approximate, but
// free of overflow and underflow.
double excess(const Bounds& bounds, const Case& scene, double extent) {
    const exact::Rational unit = std::ldexp(1.0, std::ilogb(extent));
    const auto distance = [&](const exact::Rational& squared) {
        return static_cast<double>(exact::root(squared / (unit * unit)));
    };
    const int exponent = -std::ilogb(extent);
    return std::max(std::ldexp(bounds.lower, exponent) - distance(scene.most),
                    distance(scene.least) - std::ldexp(bounds.upper, exponent));
}

// Returns an empty string if the interval contains the exact distance, else a description of the failure.
std::string try_case(Candidate& candidate, const Case& scene, std::uint64_t number) {
    const double extent = scene.extent();
    Query query;
    query.tolerance = {Tolerance::Of::absolute, std::max(1e-6 * extent, 0x1p-1074)};
    query.budget = 2000;
    const Options& options = candidate.options[number % candidate.options.size()];
    ++candidate.pairs;
    Trace trace;
    Result result;
    try {
        result = Session(*candidate.entry, options, {scene.a, scene.b}, {}).solve(query, trace);
    } catch (const std::exception& error) {
        ++candidate.thrown;
        return fmt::format("{}: throws {}", candidate.label, error.what());
    }
    candidate.converged += result.status == Status::converged;
    const bool done = result.status == Status::converged || result.status == Status::precision_floor;
    candidate.unfinished += !done;
    if (done && extent > 0x1p-1000) candidate.worst_gap = std::max(candidate.worst_gap, result.bounds.gap() / extent);
    if (degenerate::contains(result.bounds.lower, result.bounds.upper, scene.least, scene.most)) return "";
    ++candidate.wrong;
    candidate.far += extent > 0x1p-1000 && !(excess(result.bounds, scene, extent) <= 1e-9);
    std::string given;
    for (const auto& [name, value] : options.values()) given += fmt::format(" {}={}", name, to_string(value));
    return fmt::format("{}{}: [{:a}, {:a}], {}", candidate.label, given, result.bounds.lower, result.bounds.upper,
                       to_string(result.status));
}

void print(const std::vector<Candidate>& all) {
    fmt::print("{:30} {:>9} {:>9} {:>9} {:>10} {:>10} {:>7}  {}\n", "solver", "pairs", "wrong", "by > 1e-9",
               "converged", "unfinished", "thrown", "worst gap");
    for (const Candidate& candidate : all)
        fmt::print("{:30} {:9} {:9} {:9} {:10} {:10} {:7}  {:.3g}\n", candidate.label, candidate.pairs, candidate.wrong,
                   candidate.far, candidate.converged, candidate.unfinished, candidate.thrown, candidate.worst_gap);
}

// Runs all solvers on the chosen pairs and prints the first `shown` failures of each.
void run(std::vector<Candidate>& all, Case (*make)(std::uint64_t seed, std::uint64_t number), int shown) {
    const std::uint64_t seed = setting("HAUSBENCH_SEED", 1), first = setting("HAUSBENCH_FIRST", 0),
                        count = setting("HAUSBENCH_PAIRS", few);
    std::vector<int> said(all.size(), 0);
    std::uint64_t exactly_known = 0;  // distances known exactly
    for (std::uint64_t number = first; number < first + count; ++number) {
        const Case scene = make(seed, number);
        exactly_known += scene.least == scene.most;
        for (std::size_t k = 0; k < all.size(); ++k) {
            const std::string problem = try_case(all[k], scene, number);
            if (!problem.empty() && ++said[k] <= shown)
                fmt::print("pair {} of seed {} ({}): {}; h^2 = {:.20g}\n", number, seed, scene.kind, problem,
                           CGAL::to_double(scene.least));
        }
    }
    print(all);
    fmt::print("{} of {} distances are known exactly\n", exactly_known, count);
    EXPECT_GT(exactly_known, count / 2);
}

void expect_none_wrong(Case (*make)(std::uint64_t seed, std::uint64_t number)) {
    std::vector<Candidate> all = certified_solvers();
    run(all, make, 5);
    for (const Candidate& candidate : all) {
        EXPECT_EQ(candidate.wrong, 0) << candidate.label;
        EXPECT_EQ(candidate.thrown, 0) << candidate.label;
    }
}

TEST(DegeneratePairs, CertifiedIntervalsHoldTheExactDistance) { expect_none_wrong(degenerate_pair); }

TEST(MixedSizes, CertifiedIntervalsHoldTheExactDistance) { expect_none_wrong(mixed_soups); }

// The controls must be found wrong, or the pairs are too easy. One is only counted: certification turns most errors of
// the textbook kernel into a valid but too large upper bound.
TEST(DegeneratePairs, WhatIsNotCertifiedIsFoundWrong) {
    std::vector<Candidate> all = controls();
    run(all, degenerate_pair, 0);
    for (const Candidate& candidate : all) {
        if (candidate.label == "guthe kernel=textbook") continue;
        EXPECT_GT(candidate.wrong, 0) << candidate.label;
    }
}

}  // namespace
}  // namespace hausbench
