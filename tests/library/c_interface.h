// Handles of the C interface that release themselves, for tests.
#pragma once

#include "library/hausbench.h"

#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace hausbench {

struct Release {
    void operator()(hausbench_shape* shape) const { hausbench_shape_release(shape); }
    void operator()(hausbench_pair* pair) const { hausbench_pair_release(pair); }
    void operator()(hausbench_chain* chain) const { hausbench_chain_release(chain); }
};
using ShapeHandle = std::unique_ptr<hausbench_shape, Release>;
using PairHandle = std::unique_ptr<hausbench_pair, Release>;
using ChainHandle = std::unique_ptr<hausbench_chain, Release>;

inline hausbench_array array_of(const std::vector<double>& numbers) {
    return {numbers.data(), std::int64_t(numbers.size() / 3), 24, 8, HAUSBENCH_FLOAT64, 0};
}
inline hausbench_array array_of(const std::vector<std::int64_t>& numbers) {
    return {numbers.data(), std::int64_t(numbers.size() / 3), 24, 8, HAUSBENCH_INT64, 0};
}

inline void expect_ok(int code, const hausbench_error& error) {
    if (code != HAUSBENCH_OK) throw std::runtime_error(error.text);
}

// Makes a mesh; without faces, a point set.
inline ShapeHandle shape_of(const std::vector<double>& vertices, const std::vector<std::int64_t>& faces = {}) {
    const hausbench_array v = array_of(vertices), f = array_of(faces);
    hausbench_shape* shape = nullptr;
    hausbench_error error = HAUSBENCH_ERROR_INIT;
    expect_ok(hausbench_shape_of(&v, faces.empty() ? nullptr : &f, &shape, &error), error);
    return ShapeHandle(shape);
}

inline hausbench_description description_of(const ShapeHandle& shape) {
    hausbench_description description = HAUSBENCH_DESCRIPTION_INIT;
    hausbench_error error = HAUSBENCH_ERROR_INIT;
    expect_ok(hausbench_describe(shape.get(), &description, &error), error);
    return description;
}

inline hausbench_read_options initial_options() { return HAUSBENCH_READ_OPTIONS_INIT; }

inline ShapeHandle read_shape(const std::string& path, const hausbench_read_options& options = initial_options()) {
    hausbench_shape* shape = nullptr;
    hausbench_error error = HAUSBENCH_ERROR_INIT;
    expect_ok(hausbench_read_with(path.c_str(), &options, &shape, &error), error);
    return ShapeHandle(shape);
}

inline PairHandle pair_of(const ShapeHandle& a, const ShapeHandle& b, const char* solver = nullptr,
                          int first = HAUSBENCH_DIRECTED) {
    hausbench_plan plan = HAUSBENCH_PLAN_INIT;
    plan.solver = solver;
    plan.first = first;
    hausbench_pair* pair = nullptr;
    hausbench_error error = HAUSBENCH_ERROR_INIT;
    expect_ok(hausbench_prepare(a.get(), b.get(), &plan, &pair, &error), error);
    return PairHandle(pair);
}

inline hausbench_query initial_query() { return HAUSBENCH_QUERY_INIT; }

inline hausbench_answer directed(const PairHandle& pair, const hausbench_query& query = initial_query()) {
    hausbench_answer answer = HAUSBENCH_ANSWER_INIT;
    hausbench_error error = HAUSBENCH_ERROR_INIT;
    expect_ok(hausbench_directed(pair.get(), &query, &answer, &error), error);
    return answer;
}

inline hausbench_answer symmetric(const PairHandle& pair, const hausbench_query& query = initial_query()) {
    hausbench_answer answer = HAUSBENCH_ANSWER_INIT;
    hausbench_error error = HAUSBENCH_ERROR_INIT;
    expect_ok(hausbench_symmetric(pair.get(), &query, &answer, &error), error);
    return answer;
}

}  // namespace hausbench
