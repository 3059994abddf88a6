// Calls the C interface as a careless program might: arrays of any type, shape and stride, and structs with any numbers
// in them. Only pointers are always valid. A function may refuse what it is given, with one line of text and no change of
// its outputs; otherwise its interval must be one.
#include "tests/fuzz/target.h"

#include "library/hausbench.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <vector>

namespace hausbench::fuzz {
namespace {

template <auto release> struct Release {
    template <class Handle> void operator()(Handle* handle) const { release(handle); }
};
using OwnShape = std::unique_ptr<hausbench_shape, Release<hausbench_shape_release>>;
using OwnPair = std::unique_ptr<hausbench_pair, Release<hausbench_pair_release>>;
using OwnChain = std::unique_ptr<hausbench_chain, Release<hausbench_chain_release>>;

constexpr double most_seconds = 0.05;  // time limit of a call

// Checks the result of a function. Returns whether it succeeded.
bool is_well(int code, const hausbench_error& error) {
    if (code == HAUSBENCH_OK) return true;
    const std::string_view text = error.text;
    expect(code == HAUSBENCH_BAD_INPUT, "code " + std::to_string(code) + ": " + std::string(text));
    expect(error.code == code, "the error has another code");
    expect(!text.empty() && text.find('\n') == std::string_view::npos, "the message is not one line");
    return false;
}

// The memory of an array, and the array that refers to it.
struct Table {
    std::vector<unsigned char> memory;
    hausbench_array array{};
};

// Returns an array of up to 20 rows whose numbers lie within its memory. Most have numbers of the right type, with
// small integers as values; the others have any type and any bytes.
Table table(Bytes& in, bool of_faces, std::int64_t vertices) {
    const std::uint32_t kind = in.byte();
    Table made;
    hausbench_array& array = made.array;
    array.type = static_cast<std::int32_t>(of_faces ? 2 + kind % 2 : kind % 2);
    if (kind >= 240) array.type = in.next<std::int32_t>();
    array.reserved = kind == 239 ? 1 : 0;
    const std::int64_t width = array.type == HAUSBENCH_FLOAT64 || array.type == HAUSBENCH_INT64 ? 8 : 4;
    array.rows = static_cast<std::int64_t>(in.byte() % 22) - 1;
    const std::int64_t gap = kind & 4 ? in.byte() % 9 : 0;
    array.column_stride = kind & 8 ? -width : width;
    array.row_stride = (kind & 16 ? -1 : 1) * (3 * width + gap);
    if (kind & 32) array.row_stride = 0;
    const std::int64_t rows = std::max<std::int64_t>(array.rows, 1);
    const std::int64_t last = (rows - 1) * array.row_stride, across = 2 * array.column_stride;
    const std::int64_t least = std::min<std::int64_t>(0, last) + std::min<std::int64_t>(0, across);
    made.memory.resize(static_cast<std::size_t>(std::abs(last) + std::abs(across) + 8));
    array.data = made.memory.data() - least;
    for (std::int64_t i = 0; i < rows; ++i) {
        for (std::int64_t k = 0; k < 3; ++k) {
            unsigned char* at = made.memory.data() - least + i * array.row_stride + k * array.column_stride;
            const auto put = [&](auto value) { std::memcpy(at, &value, sizeof value); };
            if (kind & 64) {
                const auto raw = in.next<std::uint64_t>();
                std::memcpy(at, &raw, static_cast<std::size_t>(width));
            } else if (of_faces) {
                const std::int64_t index = in.byte() % std::max<std::int64_t>(vertices, 1);
                width == 8 ? put(index) : put(static_cast<std::int32_t>(index));
            } else {
                const double value = static_cast<double>(in.byte() % 16) / 4;
                width == 8 ? put(value) : put(static_cast<float>(value));
            }
        }
    }
    return made;
}

OwnShape shape(Bytes& in) {
    const bool mesh = in.byte() % 4 != 0;
    const Table vertices = table(in, false, 0);
    const Table faces = mesh ? table(in, true, vertices.array.rows) : Table();
    hausbench_shape* made = nullptr;
    hausbench_error error = HAUSBENCH_ERROR_INIT;
    if (!is_well(hausbench_shape_of(&vertices.array, mesh ? &faces.array : nullptr, &made, &error), error)) {
        expect(!made, "a refused shape");
        return {};
    }
    hausbench_description description = HAUSBENCH_DESCRIPTION_INIT;
    expect(is_well(hausbench_describe(made, &description, &error), error), "a shape that cannot be described");
    std::vector<double> points(static_cast<std::size_t>(3 * description.vertices));
    std::vector<std::int64_t> rows(static_cast<std::size_t>(3 * description.faces));
    expect(is_well(hausbench_copy_out(made, points.data(), rows.data(), &error), error), "no rows");
    for (const std::int64_t row : rows) expect(0 <= row && row < description.vertices, "a row out of range");
    for (const double x : points) expect(std::isfinite(x), "a coordinate that is not finite");
    return OwnShape(made);
}

int cancel(void* calls) { return --*static_cast<int*>(calls) < 0 ? 1 : 0; }

class Script {
public:
    explicit Script(Bytes& in) : in_(in) {}

    void run() {
        const OwnShape a = shape(in_), b = in_.byte() % 4 == 0 ? nullptr : shape(in_);
        hausbench_pair* made = nullptr;
        hausbench_error error = HAUSBENCH_ERROR_INIT;
        const std::string solver(in_.text(in_.byte() % 12)), parameter(in_.text(in_.byte() % 20));
        const char* const parameters[] = {parameter.c_str()};
        hausbench_plan plan = HAUSBENCH_PLAN_INIT;
        if (!solver.empty()) plan.solver = solver.c_str();
        if (!parameter.empty()) plan.parameters = parameters, plan.parameter_count = 1;
        plan.first = static_cast<std::int32_t>(in_.byte()) - 1;
        plan.moves = static_cast<std::int32_t>(in_.byte() % 6) - 1;
        const bool planned = in_.byte() % 2 == 0;
        if (!is_well(hausbench_prepare(a.get(), b ? b.get() : a.get(), planned ? &plan : nullptr, &made, &error),
                     error))
            return;
        pair_.reset(made);
        hausbench_chain* chain = nullptr;
        expect(is_well(hausbench_chain_begin(pair_.get(), &chain, &error), error), "no chain");
        chain_.reset(chain);
        hausbench_description description = HAUSBENCH_DESCRIPTION_INIT;
        expect(is_well(hausbench_describe(a.get(), &description, &error), error), "no description");
        vertices_ = static_cast<std::size_t>(description.vertices);
        for (int i = 0; i < 6 && !in_.empty(); ++i) ask();
    }

private:
    double number() {
        const std::uint32_t kind = in_.byte();
        return kind < 16 ? in_.next<double>()
                         : std::ldexp(static_cast<double>(kind % 16), -static_cast<int>(kind / 16));
    }

    hausbench_query query() {
        hausbench_query query = HAUSBENCH_QUERY_INIT;
        const std::uint32_t kind = in_.byte();
        if (kind & 1) query.tolerance = number();
        if (kind & 2) query.relative_to = static_cast<std::int32_t>(in_.byte() % 5) - 1;
        if (kind & 4) query.threads = static_cast<std::int32_t>(in_.byte() % 4);
        query.time_limit = kind & 8 ? number() : most_seconds;
        if (query.time_limit > most_seconds) query.time_limit = most_seconds;
        if (kind & 16) {
            for (double& x : pose_) x = number();
            if (!(kind & 128)) pose_[12] = pose_[13] = pose_[14] = 0, pose_[15] = 1;
            (kind & 64 ? query.source_pose : query.target_pose) = pose_.data();
        }
        if (kind & 32) query.chain = chain_.get();
        if (kind & 64)
            query.share_tolerance = number(), query.weigh_by_number = static_cast<std::int32_t>(in_.byte() % 3);
        calls_ = static_cast<int>(in_.byte() % 8);
        if (kind & 128) query.cancel = cancel, query.cancel_data = &calls_;
        return query;
    }

    void ask() {
        const std::uint32_t which = in_.below(5);
        const double length = which == 2 ? number() : 0;
        const hausbench_query spec = query();
        hausbench_answer answer = HAUSBENCH_ANSWER_INIT;
        hausbench_error error = HAUSBENCH_ERROR_INIT;
        hausbench_pair* const pair = pair_.get();
        if (which == 3) return ask_distribution(spec);
        if (which == 4) return ask_field(spec);
        const int code = which == 0   ? hausbench_directed(pair, &spec, &answer, &error)
                         : which == 1 ? hausbench_symmetric(pair, &spec, &answer, &error)
                                      : hausbench_within(pair, static_cast<std::int32_t>(length > 1), length, &spec,
                                                         &answer, &error);
        const bool well = is_well(code, error);
        expect(well || (answer.bounds.lower == 0 && std::isinf(answer.bounds.upper)), "a refused query has an answer");
        expect_interval(answer.bounds);
        expect(answer.status >= HAUSBENCH_CONVERGED && answer.status <= HAUSBENCH_STALLED, "a status that is none");
        if (answer.status == HAUSBENCH_WITHIN) expect(answer.bounds.upper <= length, "within, but not below");
        if (answer.status == HAUSBENCH_ABOVE) expect(answer.bounds.lower > length, "above, but not proven");
    }

    void ask_distribution(const hausbench_query& spec) {
        const std::string text(in_.text(in_.byte() % 24));
        const char* const statistics[] = {"mean", text.c_str(), "within 0.5"};
        std::array<hausbench_interval, 3> values{};
        hausbench_answer answer = HAUSBENCH_ANSWER_INIT;
        hausbench_error error = HAUSBENCH_ERROR_INIT;
        const bool named = !text.empty();
        const int code =
            hausbench_distribution(pair_.get(), statistics, named ? 3 : 1, &spec, values.data(), &answer, &error);
        if (!is_well(code, error)) return;
        for (std::size_t i = 0; i < (named ? 3 : 1); ++i) expect_interval(values[i]);
    }

    void ask_field(const hausbench_query& spec) {
        std::vector<hausbench_interval> values(vertices_);
        std::vector<std::int64_t> nearest(vertices_);
        hausbench_error error = HAUSBENCH_ERROR_INIT;
        if (!is_well(hausbench_field(pair_.get(), &spec, values.data(), nearest.data(), &error), error)) return;
        for (const hausbench_interval& value : values) expect_interval(value);
    }

    static void expect_interval(const hausbench_interval& value) {
        expect(0 <= value.lower && value.lower <= value.upper && std::isfinite(value.lower),
               "an interval that is none");
    }

    Bytes& in_;
    OwnPair pair_;
    OwnChain chain_;  // released first
    std::array<double, 16> pose_{};
    std::size_t vertices_ = 0;
    int calls_ = 0;
};

void arrays(std::string_view bytes) {
    Bytes in(bytes);
    Script(in).run();
}

}  // namespace
}  // namespace hausbench::fuzz

HAUSBENCH_FUZZ_TARGET(arrays)
