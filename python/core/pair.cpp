#include "python/core/pair.h"

#include "python/core/errors.h"

#include <pybind11/stl.h>

#include <algorithm>
#include <cstdint>
#include <utility>

namespace py = pybind11;

namespace hausbench_python {

std::optional<std::array<double, 16>> matrix_of(const py::object& pose) {
    if (pose.is_none()) return std::nullopt;
    const auto values = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(pose);
    if (!values || values.size() != 16) throw_input_error("a pose must be a 4 x 4 matrix");
    std::array<double, 16> matrix;
    std::copy_n(values.data(), 16, matrix.begin());
    return matrix;
}

namespace {

py::tuple tuple_of(const double (&point)[3]) { return py::make_tuple(point[0], point[1], point[2]); }

py::tuple tuple_of(const hausbench_answer& answer) {
    return py::make_tuple(answer.status, answer.bounds.lower, answer.bounds.upper, answer.to_source != 0,
                          tuple_of(answer.source_point), tuple_of(answer.target_point), answer.source_row,
                          answer.target_row, answer.prepare_seconds, answer.solve_seconds);
}

std::string path_of(const py::bytes& path) {
    std::string name = path;
    if (name.find('\0') != std::string::npos) throw_input_error("the path contains a null character: remove it");
    return name;
}

std::vector<const char*> pointers_to(const std::vector<std::string>& texts) {
    std::vector<const char*> pointers;
    for (const std::string& text : texts) pointers.push_back(text.c_str());
    return pointers;
}

// Asks a question without the GIL: ask(query, answer, error) returns the code of the library.
// `progress` is None or a function of a list of (lower, upper).
template <typename Ask>
py::tuple answer_to(const Query& query, Pair::Chain* chain, const py::object& progress, Ask ask) {
    hausbench_error error = HAUSBENCH_ERROR_INIT;
    hausbench_answer answer = HAUSBENCH_ANSWER_INIT;
    Working working;
    int code;
    {
        const Pair::Chain::Use use(chain);
        hausbench_query spec = query.with(working, use.get());
        if (!progress.is_none()) working.show_progress_to(progress, spec);
        code = working.run([&] { return ask(&spec, &answer, &error); });
    }
    check(code, error);
    return tuple_of(answer);
}

}  // namespace

Query::Query(double tolerance, int relative_to, int threads, double time_limit, const py::object& source_pose,
             const py::object& target_pose, double share_tolerance, bool weigh_by_number)
    : source_pose_(matrix_of(source_pose)), target_pose_(matrix_of(target_pose)) {
    query_.tolerance = tolerance;
    query_.relative_to = relative_to;
    query_.threads = threads;
    query_.time_limit = time_limit;
    query_.share_tolerance = share_tolerance;
    query_.weigh_by_number = weigh_by_number;
}

hausbench_query Query::with(Working& working, hausbench_chain* chain) const {
    hausbench_query query = query_;
    query.source_pose = source_pose_ ? source_pose_->data() : nullptr;
    query.target_pose = target_pose_ ? target_pose_->data() : nullptr;
    query.chain = chain;
    query.cancel = &Working::cancel;
    query.cancel_data = &working;
    return query;
}

Pair::Pair(const Shape& source, const Shape& target, const std::string& solver,
           const std::vector<std::string>& parameters, int threads, int moves) {
    const std::vector<const char*> texts = pointers_to(parameters);
    hausbench_plan plan = HAUSBENCH_PLAN_INIT;
    plan.solver = solver.empty() ? nullptr : solver.c_str();
    plan.parameters = texts.empty() ? nullptr : texts.data();
    plan.parameter_count = texts.size();
    plan.threads = threads;
    plan.first = HAUSBENCH_NOTHING;
    plan.moves = moves;
    hausbench_error error = HAUSBENCH_ERROR_INIT;
    hausbench_pair* pair = nullptr;
    check(hausbench_prepare(source.get(), target.get(), &plan, &pair, &error), error);
    pair_.reset(pair);
}

Pair::Chain::Chain(const Pair& pair) {
    hausbench_error error = HAUSBENCH_ERROR_INIT;
    hausbench_chain* chain = nullptr;
    check(hausbench_chain_begin(pair.pair_.get(), &chain, &error), error);
    chain_.reset(chain);
}

Pair::Chain::Use::Use(Chain* chain) : chain_(chain && !chain->used_.test_and_set() ? chain : nullptr) {}

Pair::Chain::Use::~Use() {
    if (chain_) chain_->used_.clear();
}

py::tuple Pair::directed(const Query& query, Chain* chain, const py::object& progress) const {
    return answer_to(query, chain, progress, [&](auto... rest) { return hausbench_directed(pair_.get(), rest...); });
}

py::tuple Pair::symmetric(const Query& query, Chain* chain, const py::object& progress) const {
    return answer_to(query, chain, progress, [&](auto... rest) { return hausbench_symmetric(pair_.get(), rest...); });
}

py::tuple Pair::within(bool symmetric, double length, const Query& query, Chain* chain,
                       const py::object& progress) const {
    return answer_to(query, chain, progress,
                     [&](auto... rest) { return hausbench_within(pair_.get(), symmetric, length, rest...); });
}

py::tuple Pair::certify(bool symmetric, const Query& query, const py::bytes& path) const {
    const std::string name = path_of(path);
    return answer_to(query, nullptr, py::none(),
                     [&](const hausbench_query* spec, hausbench_answer* answer, hausbench_error* error) {
                         return hausbench_certify(pair_.get(), symmetric, spec, name.c_str(), answer, error);
                     });
}

py::tuple Pair::distribution(const std::vector<std::string>& statistics, const Query& query,
                             const py::object& progress) const {
    const std::vector<const char*> texts = pointers_to(statistics);
    std::vector<hausbench_interval> values(texts.size());
    const py::tuple answer = answer_to(
        query, nullptr, progress, [&](const hausbench_query* spec, hausbench_answer* result, hausbench_error* error) {
            return hausbench_distribution(pair_.get(), texts.data(), texts.size(), spec, values.data(), result, error);
        });
    py::list bounds;
    for (const hausbench_interval& value : values) bounds.append(py::make_tuple(value.lower, value.upper));
    return py::make_tuple(bounds, answer);
}

py::tuple Pair::field(const Query& query, py::ssize_t count) const {
    static_assert(sizeof(hausbench_interval) == 2 * sizeof(double));
    py::array_t<double> bounds({count, py::ssize_t{2}});
    py::array_t<std::int64_t> nearest(count);
    auto* values = reinterpret_cast<hausbench_interval*>(bounds.mutable_data());
    std::int64_t* rows = nearest.mutable_data();
    answer_to(query, nullptr, py::none(), [&](const hausbench_query* spec, hausbench_answer*, hausbench_error* error) {
        return hausbench_field(pair_.get(), spec, values, rows, error);
    });
    return py::make_tuple(bounds, nearest);
}

void define_pair(py::module_& module) {
    py::class_<Query>(module, "Query")
        .def(py::init<double, int, int, double, py::object, py::object, double, bool>(), py::arg("tolerance"),
             py::arg("relative_to"), py::arg("threads"), py::arg("time_limit"), py::arg("source_pose"),
             py::arg("target_pose"), py::arg("share_tolerance"), py::arg("weigh_by_number"));
    py::class_<Pair> pair(module, "Pair");
    py::class_<Pair::Chain>(module, "Chain").def(py::init<const Pair&>(), py::arg("pair"), py::keep_alive<1, 2>());
    pair.def(py::init<const Shape&, const Shape&, const std::string&, const std::vector<std::string>&, int, int>(),
             py::arg("source"), py::arg("target"), py::arg("solver"), py::arg("parameters"), py::arg("threads"),
             py::arg("moves"))
        .def("directed", &Pair::directed, py::arg("query"), py::arg("chain") = nullptr,
             py::arg("progress") = py::none())
        .def("symmetric", &Pair::symmetric, py::arg("query"), py::arg("chain") = nullptr,
             py::arg("progress") = py::none())
        .def("within", &Pair::within, py::arg("symmetric"), py::arg("length"), py::arg("query"),
             py::arg("chain") = nullptr, py::arg("progress") = py::none())
        .def("certify", &Pair::certify, py::arg("symmetric"), py::arg("query"), py::arg("path"))
        .def("distribution", &Pair::distribution, py::arg("statistics"), py::arg("query"),
             py::arg("progress") = py::none())
        .def("field", &Pair::field, py::arg("query"), py::arg("count"));
}

}  // namespace hausbench_python
