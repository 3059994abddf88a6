// Wrong and odd arguments of the C interface: each call reports an error that names the place, or gives a right answer.
#include "tests/library/c_interface.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>
#include <set>

namespace hausbench {
namespace {

const std::vector<double> corners = {0, 0, 0, 1, 0, 0, 0, 1, 0};
const std::vector<std::int64_t> face = {0, 1, 2};

// Expects that the arrays are refused, and returns the error.
hausbench_error refusal_of(const hausbench_array* vertices, const hausbench_array* faces) {
    hausbench_error error = HAUSBENCH_ERROR_INIT;
    auto* const untouched = reinterpret_cast<hausbench_shape*>(std::uintptr_t{8});
    hausbench_shape* shape = untouched;
    EXPECT_EQ(hausbench_shape_of(vertices, faces, &shape, &error), HAUSBENCH_BAD_INPUT);
    EXPECT_EQ(shape, untouched);  // a failed function changes nothing but the error
    EXPECT_EQ(error.code, HAUSBENCH_BAD_INPUT);
    EXPECT_GT(std::strlen(error.text), 10u);
    EXPECT_EQ(std::strchr(error.text, '\n'), nullptr);
    return error;
}

TEST(LibraryHostile, CoordinatesThatAreNotFiniteNameTheirRow) {
    for (const double bad : {double(NAN), double(INFINITY), -double(INFINITY)}) {
        std::vector<double> v = corners;
        v[7] = bad;
        const hausbench_array array = array_of(v);
        const hausbench_error error = refusal_of(&array, nullptr);
        EXPECT_EQ(error.argument, 1);
        EXPECT_EQ(error.row, 2);
        EXPECT_NE(std::string(error.text).find("row 2"), std::string::npos) << error.text;
    }
}

TEST(LibraryHostile, IndicesThatAreOutOfRangeNameTheirRow) {
    constexpr auto most = std::numeric_limits<std::int64_t>::max();
    for (const std::int64_t bad : {std::int64_t{-1}, std::int64_t{3}, most, std::int64_t{1} << 32, -most - 1}) {
        const std::vector<std::int64_t> f = {0, 1, 2, 2, bad, 0};
        const hausbench_array v = array_of(corners), array = array_of(f);
        const hausbench_error error = refusal_of(&v, &array);
        EXPECT_EQ(error.argument, 2);
        EXPECT_EQ(error.row, 1);
    }
}

TEST(LibraryHostile, TablesThatAreNone) {
    const hausbench_array good = array_of(corners), faces = array_of(face);
    const auto bad = [&](auto change) {
        hausbench_array array = good;
        change(array);
        EXPECT_EQ(refusal_of(&array, nullptr).argument, 1);
        array = faces;
        change(array);
        EXPECT_EQ(refusal_of(&good, &array).argument, 2);
    };
    bad([](hausbench_array& a) { a.rows = 0; });
    bad([](hausbench_array& a) { a.rows = -5; });
    bad([](hausbench_array& a) { a.rows = std::numeric_limits<std::int64_t>::max(); });
    bad([](hausbench_array& a) { a.rows = std::int64_t{1} << 31; });
    bad([](hausbench_array& a) { a.data = nullptr; });
    bad([](hausbench_array& a) { a.type = 77; });
    bad([](hausbench_array& a) { a.type = a.type == HAUSBENCH_INT64 ? HAUSBENCH_FLOAT64 : HAUSBENCH_INT64; });
    bad([](hausbench_array& a) { a.reserved = 1; });
    bad([](hausbench_array& a) { a.rows = 1 << 30, a.row_stride = std::numeric_limits<std::int64_t>::min(); });
    bad([](hausbench_array& a) { a.column_stride = std::numeric_limits<std::int64_t>::max(); });
    refusal_of(nullptr, nullptr);
}

std::vector<double> vertices_in(const hausbench_array& array) {
    hausbench_shape* made = nullptr;
    hausbench_error error = HAUSBENCH_ERROR_INIT;
    expect_ok(hausbench_shape_of(&array, nullptr, &made, &error), error);
    const ShapeHandle shape(made);
    std::vector<double> out(std::size_t(3 * array.rows));
    expect_ok(hausbench_copy_out(made, out.data(), nullptr, &error), error);
    return out;
}

TEST(LibraryHostile, AnyStrideTypeAndAlignmentIsRead) {
    const std::vector<double> v = {1, 2, 3, 4, 5, 6};
    const std::vector<double> backwards = {4, 5, 6, 1, 2, 3}, turned = {3, 2, 1, 6, 5, 4}, down = {1, 3, 5, 2, 4, 6};
    EXPECT_EQ(vertices_in({v.data(), 2, 24, 8, HAUSBENCH_FLOAT64, 0}), v);
    EXPECT_EQ(vertices_in({v.data() + 3, 2, -24, 8, HAUSBENCH_FLOAT64, 0}), backwards);
    EXPECT_EQ(vertices_in({v.data() + 2, 2, 24, -8, HAUSBENCH_FLOAT64, 0}), turned);
    EXPECT_EQ(vertices_in({v.data(), 2, 8, 16, HAUSBENCH_FLOAT64, 0}), down);
    EXPECT_EQ(vertices_in({v.data(), 2, 0, 8, HAUSBENCH_FLOAT64, 0}), (std::vector<double>{1, 2, 3, 1, 2, 3}));
    const std::vector<float> single = {1, 2, 3, 4, 5, 6};
    EXPECT_EQ(vertices_in({single.data(), 2, 12, 4, HAUSBENCH_FLOAT32, 0}), v);
    std::vector<char> bytes(6 * sizeof(double) + 1);
    std::memcpy(bytes.data() + 1, v.data(), 6 * sizeof(double));
    EXPECT_EQ(vertices_in({bytes.data() + 1, 2, 24, 8, HAUSBENCH_FLOAT64, 0}), v);
}

TEST(LibraryHostile, FacesMayShareTheirMemoryWithVertices) {
    // All bits 0: row 0 of the vertices is the origin, and the face is (0, 0, 0).
    const std::vector<double> zeros(9, 0.0);
    const hausbench_array v = array_of(zeros);
    const hausbench_array f = {zeros.data(), 3, 24, 8, HAUSBENCH_INT64, 0};
    hausbench_shape* made = nullptr;
    hausbench_error error = HAUSBENCH_ERROR_INIT;
    expect_ok(hausbench_shape_of(&v, &f, &made, &error), error);
    const ShapeHandle shape(made);
    EXPECT_EQ(directed(pair_of(shape, shape)).bounds.upper, 0);
}

TEST(LibraryHostile, RowsAreKeptAsGiven) {
    const std::vector<double> v = {7, 7, 7, 0, 0, 0, 1, 0, 0, 0, 1, 0};
    const std::vector<std::int32_t> f = {1, 2, 3, 3, 2, 1, 2, 2, 2};
    const hausbench_array vertices = array_of(v), faces = {f.data(), 3, 12, 4, HAUSBENCH_INT32, 0};
    hausbench_shape* made = nullptr;
    hausbench_error error = HAUSBENCH_ERROR_INIT;
    expect_ok(hausbench_shape_of(&vertices, &faces, &made, &error), error);
    const ShapeHandle shape(made);
    hausbench_description d = HAUSBENCH_DESCRIPTION_INIT;
    expect_ok(hausbench_describe(made, &d, &error), error);
    EXPECT_EQ(d.is_mesh, 1);
    EXPECT_EQ(d.vertices, 4);
    EXPECT_EQ(d.faces, 3);
    EXPECT_EQ(d.box[5], 0);  // the box of the mesh, which does not contain the unused vertex
    EXPECT_EQ(d.box[3], 1);
    EXPECT_DOUBLE_EQ(d.diagonal, std::sqrt(2.0));
    std::vector<double> v_out(12);
    std::vector<std::int64_t> f_out(9);
    expect_ok(hausbench_copy_out(made, v_out.data(), f_out.data(), &error), error);
    EXPECT_EQ(v_out, v);
    EXPECT_EQ(f_out, std::vector<std::int64_t>(f.begin(), f.end()));
}

TEST(LibraryHostile, QueriesThatMakeNoSense) {
    const ShapeHandle a = shape_of(corners, face);
    const PairHandle pair = pair_of(a, a);
    const auto bad = [&](auto change) {
        hausbench_query query = initial_query();
        change(query);
        hausbench_answer answer = HAUSBENCH_ANSWER_INIT;
        answer.status = 99;
        hausbench_error error = HAUSBENCH_ERROR_INIT;
        EXPECT_EQ(hausbench_directed(pair.get(), &query, &answer, &error), HAUSBENCH_BAD_INPUT);
        EXPECT_EQ(error.argument, 2) << error.text;
        EXPECT_EQ(answer.status, 99);
    };
    for (const double tolerance : {0.0, -1.0, double(NAN), double(INFINITY)})
        bad([&](hausbench_query& q) { q.tolerance = tolerance; });
    for (const int unit : {-1, 3}) bad([&](hausbench_query& q) { q.relative_to = unit; });
    for (const int threads : {0, -4}) bad([&](hausbench_query& q) { q.threads = threads; });
    for (const double limit : {-1.0, double(NAN)}) bad([&](hausbench_query& q) { q.time_limit = limit; });
    bad([](hausbench_query& q) { q.share_tolerance = 0; });
    bad([](hausbench_query& q) { q.weigh_by_number = 2; });
    bad([](hausbench_query& q) { q.reserved = 1; });
    bad([](hausbench_query& q) { q.size = 0; });
    bad([](hausbench_query& q) { q.size = offsetof(hausbench_query, progress) - 8; });
    double pose[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 2};
    bad([&](hausbench_query& q) { q.source_pose = pose; });
    pose[15] = 1;
    pose[3] = NAN;
    bad([&](hausbench_query& q) { q.target_pose = pose; });
}

TEST(LibraryHostile, PlansThatMakeNoSense) {
    const ShapeHandle a = shape_of(corners, face);
    const auto bad = [&](auto change) {
        hausbench_plan plan = HAUSBENCH_PLAN_INIT;
        change(plan);
        hausbench_pair* pair = nullptr;
        hausbench_error error = HAUSBENCH_ERROR_INIT;
        EXPECT_EQ(hausbench_prepare(a.get(), a.get(), &plan, &pair, &error), HAUSBENCH_BAD_INPUT);
        EXPECT_EQ(pair, nullptr);
        return std::string(error.text);
    };
    EXPECT_NE(bad([](hausbench_plan& p) { p.solver = "kover"; }).find("cover"), std::string::npos);
    EXPECT_NE(bad([](hausbench_plan& p) { p.solver = "penetration"; }).find("GPL"), std::string::npos);
    bad([](hausbench_plan& p) { p.solver = "distribution"; });
    bad([](hausbench_plan& p) { p.solver = ""; });
    bad([](hausbench_plan& p) { p.solver = "scan"; });  // takes points alone
    bad([](hausbench_plan& p) { p.threads = 0; });
    bad([](hausbench_plan& p) { p.first = 9; });
    bad([](hausbench_plan& p) { p.moves = 4; });
    bad([](hausbench_plan& p) { p.size = 3; });
    bad([](hausbench_plan& p) { p.parameter_count = 1; });
    for (const char* parameter : {"no_value", "no_such_parameter=1", "=", ""}) {
        const char* const parameters[] = {parameter};
        bad([&](hausbench_plan& p) { p.parameters = parameters, p.parameter_count = 1; });
    }
}

TEST(LibraryHostile, NullPointers) {
    const ShapeHandle a = shape_of(corners, face);
    const PairHandle pair = pair_of(a, a);
    hausbench_error e = HAUSBENCH_ERROR_INIT;
    hausbench_answer answer = HAUSBENCH_ANSWER_INIT;
    hausbench_shape* shape = nullptr;
    hausbench_verdict verdict = HAUSBENCH_VERDICT_INIT;
    hausbench_interval value;
    const char* const names[] = {"mean", nullptr};
    const std::vector<int> codes = {
        hausbench_read(nullptr, &shape, &e),
        hausbench_read("x.off", nullptr, &e),
        hausbench_read_with(nullptr, nullptr, &shape, &e),
        hausbench_read_with("x.off", nullptr, nullptr, &e),
        hausbench_shape_stating(nullptr, nullptr, nullptr, &shape, &e),
        hausbench_describe(nullptr, nullptr, &e),
        hausbench_copy_out(nullptr, nullptr, nullptr, &e),
        hausbench_prepare(a.get(), nullptr, nullptr, nullptr, &e),
        hausbench_chain_begin(nullptr, nullptr, &e),
        hausbench_directed(nullptr, nullptr, &answer, &e),
        hausbench_directed(pair.get(), nullptr, nullptr, &e),
        hausbench_symmetric(nullptr, nullptr, &answer, nullptr),
        hausbench_within(pair.get(), 0, 1, nullptr, nullptr, &e),
        hausbench_distribution(pair.get(), nullptr, 1, nullptr, &value, &answer, &e),
        hausbench_distribution(pair.get(), names, 2, nullptr, &value, &answer, &e),
        hausbench_distribution(pair.get(), names, 1, nullptr, nullptr, &answer, &e),
        hausbench_field(pair.get(), nullptr, nullptr, nullptr, &e),
        hausbench_certify(pair.get(), 0, nullptr, nullptr, &answer, &e),
        hausbench_certify(pair.get(), 2, nullptr, "x", &answer, &e),
        hausbench_verify(nullptr, a.get(), a.get(), &verdict, &e),
        hausbench_verify("x", a.get(), a.get(), nullptr, &e),
        hausbench_verify("/nowhere/x", a.get(), a.get(), &verdict, &e),
    };
    for (std::size_t i = 0; i < codes.size(); ++i) EXPECT_EQ(codes[i], HAUSBENCH_BAD_INPUT) << i;
}

TEST(LibraryHostile, StructsOfLaterVersionsAreLeftAlone) {
    struct Later {
        hausbench_answer answer = HAUSBENCH_ANSWER_INIT;
        double added = 17;
    } later;
    later.answer.size = sizeof later;
    const ShapeHandle a = shape_of(corners, face);
    hausbench_error error = HAUSBENCH_ERROR_INIT;
    expect_ok(hausbench_directed(pair_of(a, a).get(), nullptr, &later.answer, &error), error);
    EXPECT_EQ(later.added, 17);
    EXPECT_EQ(later.answer.size, sizeof later);
    EXPECT_LE(later.answer.bounds.upper, 1e-12);
    error.size = 4;  // an error that was not initialised is not written to
    error.code = 55;
    EXPECT_EQ(hausbench_describe(nullptr, nullptr, &error), HAUSBENCH_BAD_INPUT);
    EXPECT_EQ(error.code, 55);
}

TEST(LibraryHostile, FilesThatCannotBeRead) {
    hausbench_shape* shape = nullptr;
    hausbench_error error = HAUSBENCH_ERROR_INIT;
    for (const char* file : {"/nowhere/a.off", "/", "", "x.surface.toml", "/etc/hostname", "/dev/null"}) {
        error.argument = 0;
        EXPECT_EQ(hausbench_read(file, &shape, &error), HAUSBENCH_BAD_INPUT) << file;
        EXPECT_EQ(error.argument, 1);
    }
    const std::string endless(5000, 'x');
    EXPECT_EQ(hausbench_read(endless.c_str(), &shape, &error), HAUSBENCH_BAD_INPUT);
    EXPECT_LT(std::strlen(error.text), sizeof error.text);
}

TEST(LibraryHostile, OptionsThatMakeNoSense) {
    const auto bad = [](auto change) {
        hausbench_read_options options = HAUSBENCH_READ_OPTIONS_INIT;
        change(options);
        auto* const untouched = reinterpret_cast<hausbench_shape*>(std::uintptr_t{8});
        hausbench_shape* shape = untouched;
        hausbench_error error = HAUSBENCH_ERROR_INIT;
        EXPECT_EQ(hausbench_read_with("/nowhere/a.off", &options, &shape, &error), HAUSBENCH_BAD_INPUT);
        EXPECT_EQ(shape, untouched);
        EXPECT_EQ(error.argument, 2) << error.text;
        EXPECT_EQ(std::strchr(error.text, '\n'), nullptr);
        return std::string(error.text);
    };
    EXPECT_NE(bad([](auto& o) { o.unit = "parsec"; }).find("mm, "), std::string::npos);
    EXPECT_NE(bad([](auto& o) { o.up = "W"; }).find("X, Y, Z"), std::string::npos);
    bad([](auto& o) { o.unit = ""; });
    bad([](auto& o) { o.up = ""; });
    bad([](auto& o) { o.up = "up\nwards"; });
    bad([](auto& o) { o.drop_invalid = 2; });
    bad([](auto& o) { o.reserved = 1; });
    bad([](auto& o) { o.size = 0; });
    bad([](auto& o) { o.size = sizeof o - 8; });
}

TEST(LibraryHostile, DescriptionsThatMakeNoSense) {
    const hausbench_array v = array_of(corners);
    const auto bad = [&](auto change) {
        hausbench_description about = HAUSBENCH_DESCRIPTION_INIT;
        change(about);
        hausbench_shape* shape = nullptr;
        hausbench_error error = HAUSBENCH_ERROR_INIT;
        EXPECT_EQ(hausbench_shape_stating(&v, nullptr, &about, &shape, &error), HAUSBENCH_BAD_INPUT);
        EXPECT_EQ(error.argument, 3) << error.text;
    };
    for (const double unit : {-1.0, double(NAN), double(INFINITY), 1e305})
        bad([&](hausbench_description& d) { d.unit = unit; });
    for (const int up : {1, int('x'), -1, 'X' + 256}) bad([&](hausbench_description& d) { d.up = up; });
    bad([](hausbench_description& d) { d.segments = -1; });
    bad([](hausbench_description& d) { d.dropped_faces = -1; });
    bad([](hausbench_description& d) { d.size = 4; });
}

// A caller of the first version knows the members up to `diagonal`.
TEST(LibraryHostile, ACallerOfTheFirstVersionGetsItsMembersAlone) {
    const ShapeHandle a = shape_of(corners, face);
    hausbench_description description = HAUSBENCH_DESCRIPTION_INIT;
    constexpr std::size_t first_version = 88;
    description.size = first_version;
    description.segments = description.up = 77;
    hausbench_error error = HAUSBENCH_ERROR_INIT;
    expect_ok(hausbench_describe(a.get(), &description, &error), error);
    EXPECT_EQ(description.size, first_version);
    EXPECT_EQ(description.vertices, 3);
    EXPECT_EQ(description.segments, 77);
    EXPECT_EQ(description.up, 77);
    hausbench_query query = HAUSBENCH_QUERY_INIT;  // without `progress`
    query.size = offsetof(hausbench_query, progress);
    query.progress = [](void*, const hausbench_interval*, std::size_t) -> int { throw 7; };
    hausbench_answer answer = HAUSBENCH_ANSWER_INIT;
    expect_ok(hausbench_directed(pair_of(a, a).get(), &query, &answer, &error), error);
    hausbench_shape* made = nullptr;  // `up` of a caller that does not have it is not read
    const hausbench_array v = array_of(corners);
    expect_ok(hausbench_shape_stating(&v, nullptr, &description, &made, &error), error);
    EXPECT_EQ(description_of(ShapeHandle(made)).segments, 0);
}

TEST(LibraryHostile, ListsItsSolvers) {
    std::set<std::string> names;
    std::size_t count = 0;
    while (const char* name = hausbench_solver(count)) {
        names.insert(name);
        ++count;
    }
    EXPECT_EQ(names.size(), count);
    EXPECT_EQ(hausbench_solver(count + 1), nullptr);
    EXPECT_TRUE(names.contains("cover") && names.contains("scan"));
    for (const char* absent : {"penetration", "cgal", "cgal_kdtree", "distribution", "surface_enclosure"})
        EXPECT_FALSE(names.contains(absent)) << absent;
    EXPECT_EQ(hausbench_interface(), HAUSBENCH_INTERFACE);
    EXPECT_STREQ(hausbench_version(), "0.1.0");
}

}  // namespace
}  // namespace hausbench
