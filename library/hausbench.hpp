// Certified distances between triangle meshes and point sets, for C++17 and later. This is hausbench.h, which says what
// each call does, with handles that release themselves, containers, and exceptions.
//
//     hausbench::Shape a = hausbench::Shape::read("a.ply"), b = hausbench::Shape::read("b.ply");
//     hausbench::Answer answer = hausbench::Pair(a, b).directed();
//     answer.bounds.lower, answer.bounds.upper                 contain h(A,B)
//
// Structs have the members and initial values of the struct of hausbench.h that they derive from; the functions of
// hausbench.h take the handles from get(). Everything throws hausbench::Error, and std::bad_alloc.
//
// Include it in no plug-in: the headers of plug-ins define other classes with the same names.
#ifndef HAUSBENCH_HPP
#define HAUSBENCH_HPP

#include <hausbench.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <iterator>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace hausbench {
inline namespace wrapper {

// --- errors ----------------------------------------------------------------------------------------------------------

class Error : public std::runtime_error {
public:
    explicit Error(const hausbench_error& error)
        : std::runtime_error(error.text), code_(error.code), argument_(error.argument), row_(error.row) {}

    int code() const noexcept { return code_; }          // HAUSBENCH_BAD_INPUT, ...
    int argument() const noexcept { return argument_; }  // of the C function, from 1; 0: unknown
    std::int64_t row() const noexcept { return row_; }   // of the array that is wrong, from 0; -1: none in particular

private:
    int code_, argument_;
    std::int64_t row_;
};

// Calls a function of hausbench.h, without its last argument, and throws its error.
template <class Function, class... Arguments> void call(Function function, Arguments... arguments) {
    hausbench_error error = HAUSBENCH_ERROR_INIT;
    if (function(arguments..., &error) != HAUSBENCH_OK) throw Error(error);
}

// --- shapes ----------------------------------------------------------------------------------------------------------

// A view of rows of three numbers: coordinates of type double or float, or indices of 32 or 64 bits, signed or not. The
// numbers must stay where they are as long as the view is used.
class Rows {
public:
    // The container is a std::vector, std::array or std::span of std::array<Number, 3>.
    template <class Container, class Row = std::decay_t<decltype(*std::data(std::declval<const Container&>()))>,
              std::enable_if_t<std::is_same_v<Row, std::array<typename Row::value_type, 3>>, int> = 0>
    Rows(const Container& rows) : Rows(std::size(rows) ? std::data(rows)->data() : nullptr, std::size(rows)) {}

    // `numbers` are x, y, z of the first row, x, y, z of the second, and so on.
    template <class Number>
    Rows(const Number* numbers, std::size_t rows)
        : array_{numbers, static_cast<std::int64_t>(rows), 3 * sizeof(Number), sizeof(Number), type_of<Number>(), 0} {}

    // With other strides.
    explicit Rows(const hausbench_array& array) : array_(array) {}

    const hausbench_array* get() const noexcept { return &array_; }

private:
    template <class Number> static constexpr std::int32_t type_of() {
        constexpr bool is_index = std::is_integral_v<Number> && (sizeof(Number) == 4 || sizeof(Number) == 8);
        static_assert(is_index || std::is_same_v<Number, double> || std::is_same_v<Number, float>);
        if (is_index) return sizeof(Number) == 8 ? HAUSBENCH_INT64 : HAUSBENCH_INT32;
        return std::is_same_v<Number, double> ? HAUSBENCH_FLOAT64 : HAUSBENCH_FLOAT32;
    }

    hausbench_array array_;
};

struct ReadOptions : hausbench_read_options {
    ReadOptions() : hausbench_read_options HAUSBENCH_READ_OPTIONS_INIT {}
};

struct Description : hausbench_description {
    Description() : hausbench_description HAUSBENCH_DESCRIPTION_INIT {}
};

template <class Type, void (*release)(Type*)> struct Release {
    void operator()(Type* handle) const noexcept { release(handle); }
};

// A triangle mesh or a point set.
class Shape {
public:
    // A point set. `about` states its unit and axes.
    explicit Shape(const Rows& vertices, const Description& about = {}) : Shape(vertices, nullptr, about) {}
    // A mesh.
    Shape(const Rows& vertices, const Rows& faces, const Description& about = {})
        : Shape(vertices, faces.get(), about) {}

    static Shape read(const std::string& path, const ReadOptions& options = {}) {
        hausbench_shape* shape = nullptr;
        call(hausbench_read_with, path.c_str(), &options, &shape);
        return Shape(shape);
    }

    Description description() const {
        Description description;
        call(hausbench_describe, handle_.get(), &description);
        return description;
    }

    std::vector<std::string> notes() const {
        std::vector<std::string> notes;
        while (const char* note = hausbench_note(handle_.get(), notes.size())) notes.emplace_back(note);
        return notes;
    }

    std::vector<std::array<double, 3>> vertices() const {
        std::vector<std::array<double, 3>> rows(static_cast<std::size_t>(description().vertices));
        call(hausbench_copy_out, handle_.get(), rows.data()->data(), nullptr);
        return rows;
    }

    // Returns no rows for a point set.
    std::vector<std::array<std::int64_t, 3>> faces() const {
        std::vector<std::array<std::int64_t, 3>> rows(static_cast<std::size_t>(description().faces));
        if (!rows.empty()) call(hausbench_copy_out, handle_.get(), nullptr, rows.data()->data());
        return rows;
    }

    hausbench_shape* get() const noexcept { return handle_.get(); }

private:
    explicit Shape(hausbench_shape* handle) : handle_(handle) {}
    Shape(const Rows& vertices, const hausbench_array* faces, const Description& about) {
        hausbench_shape* shape = nullptr;
        call(hausbench_shape_stating, vertices.get(), faces, &about, &shape);
        handle_.reset(shape);
    }

    std::unique_ptr<hausbench_shape, Release<hausbench_shape, hausbench_shape_release>> handle_;
};

// --- questions and answers -------------------------------------------------------------------------------------------

using Interval = hausbench_interval;
using Pose = std::array<double, 16>;  // the rows of a 4 x 4 matrix, as in hausbench_query

struct Plan : hausbench_plan {
    Plan() : hausbench_plan HAUSBENCH_PLAN_INIT {}
    std::vector<std::string> parameters;  // each "name=value"; in place of the pointer and its count
};

// The members below are in place of the pointers with the same names. A function may throw: that ends the call, which
// then throws the same exception.
struct Query : hausbench_query {
    Query() : hausbench_query HAUSBENCH_QUERY_INIT {}
    std::optional<Pose> source_pose, target_pose;
    std::function<bool()> cancel;                                             // true ends the call
    std::function<bool(const Interval* bounds, std::size_t count)> progress;  // likewise
};

struct Answer : hausbench_answer {
    Answer() : hausbench_answer HAUSBENCH_ANSWER_INIT {}
};

struct Distribution {
    std::vector<Interval> values;  // of each statistic
    Answer answer;
};

struct Field {
    std::vector<Interval> values;       // of each vertex of A
    std::vector<std::int64_t> nearest;  // row of B
};

struct Verdict : hausbench_verdict {
    Verdict() : hausbench_verdict HAUSBENCH_VERDICT_INIT {}
};

// A chain of answers for nearby poses of one pair: set query.chain to get().
class Chain {
public:
    explicit Chain(hausbench_chain* handle) : handle_(handle) {}
    hausbench_chain* get() const noexcept { return handle_.get(); }

private:
    std::unique_ptr<hausbench_chain, Release<hausbench_chain, hausbench_chain_release>> handle_;
};

// A query as hausbench.h takes it.
class Question {
public:
    explicit Question(const Query& query) : given_(query), query_(query) {
        if (query.source_pose) given_.source_pose = query.source_pose->data();
        if (query.target_pose) given_.target_pose = query.target_pose->data();
        if (query.cancel) {
            given_.cancel_data = this;
            given_.cancel = [](void* data) noexcept {
                Question& question = *static_cast<Question*>(data);
                return question.kept([&] { return question.query_.cancel(); });
            };
        }
        if (query.progress) {
            given_.progress_data = this;
            given_.progress = [](void* data, const Interval* bounds, std::size_t count) noexcept {
                Question& question = *static_cast<Question*>(data);
                return question.kept([&] { return question.query_.progress(bounds, count); });
            };
        }
    }
    Question(const Question&) = delete;

    // Calls a function of hausbench.h. Throws the exception of a function of the query first, which is why the call ended.
    template <class Function, class... Arguments> void ask(Function function, Arguments... arguments) {
        hausbench_error error = HAUSBENCH_ERROR_INIT;
        const int code = function(arguments..., &error);
        if (thrown_) std::rethrow_exception(thrown_);
        if (code != HAUSBENCH_OK) throw Error(error);
    }

    const hausbench_query* get() const noexcept { return &given_; }

private:
    template <class Body> int kept(const Body& body) noexcept {
        try {
            return body() ? 1 : 0;
        } catch (...) {
            thrown_ = std::current_exception();
            return 1;
        }
    }

    hausbench_query given_;
    const Query& query_;
    std::exception_ptr thrown_;
};

// A source A and a target B. Keeps what it needs of both shapes.
class Pair {
public:
    Pair(const Shape& source, const Shape& target, const Plan& plan = {})
        : source_vertices_(static_cast<std::size_t>(source.description().vertices)) {
        std::vector<const char*> parameters;
        for (const std::string& parameter : plan.parameters) parameters.push_back(parameter.c_str());
        hausbench_plan given = plan;
        given.parameters = parameters.data();
        given.parameter_count = parameters.size();
        hausbench_pair* pair = nullptr;
        call(hausbench_prepare, source.get(), target.get(), &given, &pair);
        handle_.reset(pair);
    }

    // Bounds h(A,B).
    Answer directed(const Query& query = {}) const {
        Answer answer;
        Question question(query);
        question.ask(hausbench_directed, get(), question.get(), &answer);
        return answer;
    }

    // Bounds H(A,B).
    Answer symmetric(const Query& query = {}) const {
        Answer answer;
        Question question(query);
        question.ask(hausbench_symmetric, get(), question.get(), &answer);
        return answer;
    }

    // Asks whether h(A,B) <= length: the status is HAUSBENCH_WITHIN, HAUSBENCH_ABOVE, or says why neither is proven.
    Answer within(double length, const Query& query = {}) const { return within(false, length, query); }
    // Asks whether H(A,B) <= length.
    Answer within_symmetric(double length, const Query& query = {}) const { return within(true, length, query); }

    // Bounds statistics, such as "mean" or "quantile 0.95".
    Distribution distribution(const std::vector<std::string>& statistics, const Query& query = {}) const {
        std::vector<const char*> names;
        for (const std::string& name : statistics) names.push_back(name.c_str());
        Distribution found;
        found.values.resize(names.size());
        Question question(query);
        question.ask(hausbench_distribution, get(), names.data(), names.size(), question.get(), found.values.data(),
                     &found.answer);
        return found;
    }

    // Bounds the distance to B of each vertex of A.
    Field field(const Query& query = {}) const {
        Field field{std::vector<Interval>(source_vertices_), std::vector<std::int64_t>(source_vertices_)};
        Question question(query);
        question.ask(hausbench_field, get(), question.get(), field.values.data(), field.nearest.data());
        return field;
    }

    // Bounds h(A,B), and writes a proof of the upper bound.
    Answer certify(const std::string& path, const Query& query = {}) const { return certify(false, path, query); }
    // Bounds H(A,B), and writes a proof of the upper bound.
    Answer certify_symmetric(const std::string& path, const Query& query = {}) const {
        return certify(true, path, query);
    }

    Chain chain() const {
        hausbench_chain* chain = nullptr;
        call(hausbench_chain_begin, get(), &chain);
        return Chain(chain);
    }

    hausbench_pair* get() const noexcept { return handle_.get(); }

private:
    Answer within(bool symmetric, double length, const Query& query) const {
        Answer answer;
        Question question(query);
        question.ask(hausbench_within, get(), symmetric, length, question.get(), &answer);
        return answer;
    }

    Answer certify(bool symmetric, const std::string& path, const Query& query) const {
        Answer answer;
        Question question(query);
        question.ask(hausbench_certify, get(), symmetric, question.get(), path.c_str(), &answer);
        return answer;
    }

    std::size_t source_vertices_;
    std::unique_ptr<hausbench_pair, Release<hausbench_pair, hausbench_pair_release>> handle_;
};

// Checks a proof about the two shapes at these poses, or at rest. The call also succeeds if the proof is refused.
inline Verdict verify(const std::string& path, const Shape& source, const Shape& target,
                      const std::optional<Pose>& source_pose = {}, const std::optional<Pose>& target_pose = {}) {
    Verdict verdict;
    call(hausbench_verify_posed, path.c_str(), source.get(), target.get(), source_pose ? source_pose->data() : nullptr,
         target_pose ? target_pose->data() : nullptr, &verdict);
    return verdict;
}

// Returns the names of the solvers for plan.solver.
inline std::vector<std::string> solvers() {
    std::vector<std::string> names;
    while (const char* name = hausbench_solver(names.size())) names.emplace_back(name);
    return names;
}

}  // namespace wrapper
}  // namespace hausbench
#endif
