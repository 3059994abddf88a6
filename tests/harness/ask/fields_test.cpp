// Distance fields on A: compared with exact distances, written to files, and refused by the check
// if they are wrong.
#include "harness/ask/fields.h"
#include "algorithms/error.h"
#include "harness/check/verify.h"
#include "harness/check/verify_fields.h"
#include "harness/result/field_file.h"
#include "harness/result/result_file.h"
#include "harness/run/describe.h"
#include "tests/support/exact.h"
#include "tests/support/random.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tree_meshes.h"

#include <CGAL/IO/read_ply_points.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh/IO/PLY.h>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <map>
#include <string_view>

namespace hausbench {
namespace {

TriangleMesh tetrahedron() {
    TriangleMesh mesh{Points(4, 3), Triangles(4, 3)};
    mesh.vertices << 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1;
    mesh.triangles << 0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3;
    return mesh;
}

// The square [-4, 4] x [-4, 4] at z = 0; element 0 is the half with x >= y.
TriangleMesh square() {
    TriangleMesh mesh{Points(4, 3), Triangles(2, 3)};
    mesh.vertices << -4, -4, 0, 4, -4, 0, 4, 4, 0, -4, 4, 0;
    mesh.triangles << 0, 1, 2, 0, 2, 3;
    return mesh;
}

Pose moved(const Vec3& translation) {
    Pose pose;
    pose.translation = translation;
    return pose;
}

Fields fields_of(const Shape& a, const Pose& pose, const Shape& b, const Pose& target_pose, int exponent = 0) {
    Fields fields = as_fields(draw_distance(PreparedShape(a, exponent), pose, PreparedShape(b, exponent), target_pose));
    fields.resize(2);  // the distance and the nearest element, without the vertices and pieces
    return fields;
}

Field bounds(const char* name, Field::Meaning meaning, std::vector<double> values) {
    return {name, Field::Of::elements, meaning, std::move(values)};
}

TEST(DistanceFields, OfASmallPairInTheirPosesAreExact) {
    // The rotation turns A's z axis to the x axis; the translations put A above the square.
    Pose turned = moved({3, 0, 2});
    turned.rotation << 0, 0, 1, 0, 1, 0, -1, 0, 0;
    const Fields fields = fields_of(tetrahedron(), turned, square(), moved({0, -0.5, -1}));
    ASSERT_EQ(fields.size(), 2u);
    EXPECT_EQ(fields[0].name, "distance");
    EXPECT_EQ(fields[1].name, "nearest");
    for (const Field& field : fields) EXPECT_EQ(field.of, Field::Of::vertices);
    EXPECT_EQ(fields[0].values, (std::vector<double>{3, 2, 3, 3}));  // A at z = 2, 1, 2, 2; square at -1
    EXPECT_EQ(fields[1].values, (std::vector<double>{0, 0, 0, 0}));
    EXPECT_EQ(fields_of(tetrahedron(), moved({-3, 0, 0}), square(), {})[1].values, (std::vector<double>{1, 1, 1, 1}));
}

TEST(DistanceFields, APointIsATriangle) {
    PointSet a{Points(2, 3)}, b{Points(3, 3)};
    a.points << 0, 0, 0, 1, 1, 1;
    b.points << 9, 0, 0, 0, 3, 4, 1, 1, 2;
    const Fields of_points = fields_of(a, {}, b, {});
    EXPECT_EQ(of_points[1].values, (std::vector<double>{2, 2}));
    EXPECT_DOUBLE_EQ(of_points[0].values[0], std::sqrt(6));
    EXPECT_EQ(of_points[0].values[1], 1);
    EXPECT_EQ(fields_of(a, {}, square(), {})[0].values, (std::vector<double>{0, 1}));
    EXPECT_EQ(fields_of(tetrahedron(), {}, b, {})[1].values, (std::vector<double>{2, 2, 2, 2}));
}

TEST(DistanceFields, AreInTheUnitOfTheInputAtEveryScale) {
    const Fields unscaled = fields_of(tetrahedron(), {}, square(), moved({0, 0, -7}));
    for (int scale : {-1060, -400, 400, 1018}) {
        TriangleMesh a = tetrahedron(), b = square();
        for (Points* points : {&a.vertices, &b.vertices})
            *points = points->unaryExpr([&](double x) { return std::ldexp(x, scale); });
        const Pose away = moved({0, 0, std::ldexp(-7.0, scale)});
        for (int exponent : {0, -scale - 3}) {
            const Fields fields = fields_of(a, {}, b, away, exponent);
            for (std::size_t i = 0; i < 4; ++i)
                EXPECT_EQ(fields[0].values[i], std::ldexp(unscaled[0].values[i], scale)) << scale << ", " << exponent;
            EXPECT_EQ(fields[1].values, unscaled[1].values);
        }
    }
}

TEST(DistanceFields, AreWithinTheirError) {
    Random random(7);
    Pose pose = moved(random.vector(3));
    for (int i = 0; i < 9; ++i) pose.rotation(i / 3, i % 3) += random.real(-0.25, 0.25);
    for (const auto& [name, mesh] : tree_meshes()) {
        if (mesh.triangles.rows() > 300) continue;
        PointSet a{Points(6, 3)};
        for (Index i = 0; i < 6; ++i) a.points.row(i) = random.vector(2);
        const Fields fields = fields_of(a, pose, mesh, {});
        const Points there = posed(a.points, pose);
        const double error = field_error(std::max(there.cwiseAbs().maxCoeff(), mesh.vertices.cwiseAbs().maxCoeff()));
        for (Index i = 0; i < 6; ++i) {
            std::optional<exact::Rational> least;
            const auto to = [&, &target = mesh](Index t) {
                const auto corner = [&](int k) {
                    return exact::vector(target.vertices.row(target.triangles(t, k)).transpose());
                };
                return exact::squared_distance_to_triangle(exact::vector(there.row(i).transpose()), corner(0),
                                                           corner(1), corner(2));
            };
            for (Index t = 0; t < mesh.triangles.rows(); ++t) {
                const auto d = to(t);
                if (!least || d < *least) least = d;
            }
            const double d = fields[0].values[std::size_t(i)];
            const exact::Rational most = exact::Rational(d) + exact::Rational(error),
                                  at_least = exact::Rational(d) - exact::Rational(error);
            EXPECT_LE(*least, most * most) << name;
            EXPECT_GE(*least, at_least > 0 ? exact::Rational(at_least * at_least) : exact::Rational(0)) << name;
            EXPECT_LE(to(Index(fields[1].values[std::size_t(i)])), most * most) << name;
        }
    }
}

TEST(DistanceFields, AreNoneOfASurfaceOrBeyondTheDoubles) {
    AlgebraicSurface ball{"x^2 + y^2 + z^2 - 1", Points(2, 3)};
    ball.box << -2, -2, -2, 2, 2, 2;
    EXPECT_THROW(fields_of(ball, {}, tetrahedron(), {}), InputError);
    EXPECT_THROW(fields_of(tetrahedron(), {}, ball, {}), InputError);
    Pose huge;
    huge.rotation *= 1e308;
    EXPECT_THROW(fields_of(tetrahedron(), {}, square(), huge), InputError);
}

// One triangle whose corners form B: its farthest point is the middle of its longest edge, sqrt(4.5) away.
TriangleMesh right_angled() {
    TriangleMesh mesh{Points(3, 3), Triangles(1, 3)};
    mesh.vertices << 0, 0, 0, 3, 0, 0, 0, 3, 0;
    mesh.triangles << 0, 1, 2;
    return mesh;
}

DrawnField drawn(const TriangleMesh& a, const Shape& b, const Drawing& drawing, int scale = 0) {
    const auto scaled = [&](Shape shape) {
        points_of(shape) = points_of(shape).unaryExpr([&](double x) { return std::ldexp(x, scale); });
        return PreparedShape(std::move(shape), 0);
    };
    return draw_distance(scaled(a), {}, scaled(b), {}, drawing);
}

double area_of(const DrawnField& field) {
    double sum = 0;
    for (Index i = 0; i < field.pieces.rows(); ++i) {
        const auto corner = [&](int k) { return Vec3(field.vertices.row(field.pieces(i, k)).transpose()); };
        sum += (corner(1) - corner(0)).cross(corner(2) - corner(0)).norm() / 2;
    }
    return sum;
}

TEST(DrawnFields, ShowWhatVerticesDoNot) {
    const PointSet b{right_angled().vertices};
    for (int scale : {0, -1000, 900}) {
        const double unit = std::ldexp(1.0, scale), lower = std::sqrt(4.5) * unit, resolution = 0.05 * lower;
        const DrawnField field = drawn(right_angled(), b, {0.05, lower}, scale);
        EXPECT_TRUE(field.resolved);
        EXPECT_EQ(field.vertices.topRows(3), unit * right_angled().vertices);
        EXPECT_GE(field.largest(), 0.95 * std::sqrt(4.5) * unit);
        EXPECT_LE(field.largest(), (1 + 1e-12) * std::sqrt(4.5) * unit);
        if (scale == 0) {
            EXPECT_NEAR(area_of(field), 4.5, 1e-12);
        }
        // Linear interpolation of the field on each piece stays close to the true distance.
        Random random(9);
        for (Index i = 0; i < field.pieces.rows(); ++i) {
            const double x = random.real(0, 1), y = random.real(0, 1 - x), weights[] = {1 - x - y, x, y};
            Vec3 p = Vec3::Zero();
            double drawn_there = 0;
            for (int k = 0; k < 3; ++k) {
                p += weights[k] * field.vertices.row(field.pieces(i, k)).transpose() / unit;
                drawn_there += weights[k] * field.distances[std::size_t(field.pieces(i, k))];
            }
            const double d = (b.points.rowwise() - p.transpose()).rowwise().norm().minCoeff();
            EXPECT_NEAR(drawn_there, d * unit, 2 * resolution);
        }
    }
    EXPECT_EQ(drawn(right_angled(), b, {}).largest(), 0);  // uncut: A's corners are on B
}

void expect_no_gaps(const DrawnField& field) {
    std::map<std::pair<Index, Index>, int> uses;
    for (Index i = 0; i < field.pieces.rows(); ++i) {
        for (int k = 0; k < 3; ++k)
            ++uses[std::minmax<Index>(Index(field.pieces(i, k)), Index(field.pieces(i, (k + 1) % 3)))];
    }
    for (const auto& [edge, count] : uses) EXPECT_EQ(count, 2);
    EXPECT_GT(field.pieces.rows(), 100);
}

TEST(DrawnFields, HaveNoGapsBetweenPieces) {
    const DrawnField field = drawn(tetrahedron(), PointSet{Points::Constant(1, 3, 0.3)}, {0.02, 1, {0.2, 0.3, 0}, 0});
    expect_no_gaps(field);
    EXPECT_NEAR(area_of(field), 1.5 + std::sqrt(3) / 2, 1e-12);
    TriangleMesh uneven = tetrahedron();  // an edge to cut is seldom the longest of both its pieces
    uneven.vertices << 0, 0, 0, 1, 0, 0, 0.3, 1.2, 0, 0.2, 0.1, 0.7;
    PointSet near_a_face{Points(1, 3)};
    near_a_face.points << 0.4, 0.3, -0.01;
    expect_no_gaps(drawn(uneven, near_a_face, {0.02}));
}

TEST(DrawnFields, NoEdgeIsLong) {
    TriangleMesh far = square();
    far.vertices.col(2).setConstant(5);
    const DrawnField field = drawn(square(), far, {0.02});
    for (Index i = 0; i < field.pieces.rows(); ++i) {
        for (int k = 0; k < 3; ++k)
            EXPECT_LE(
                (field.vertices.row(field.pieces(i, k)) - field.vertices.row(field.pieces(i, (k + 1) % 3))).norm(),
                8 * std::sqrt(2) / 64);
    }
    for (double d : field.distances) EXPECT_EQ(d, 5);
}

// B has the corners and edge midpoints of the small triangle, so only the centroid shows that it must be cut.
TEST(DrawnFields, CentroidsAreCompared) {
    PointSet b{Points(6, 3)};
    b.points << 0, 0, 0, 0.02, 0, 0, 0, 0.02, 0, 0.01, 0, 0, 0, 0.01, 0, 0.01, 0.01, 0;
    TriangleMesh a = right_angled();
    a.vertices /= 150;
    TriangleMesh far = right_angled();  // so that no edge of the small triangle counts as long
    far.vertices.col(2).setConstant(1);
    TriangleMesh both{Points(6, 3), Triangles(2, 3)};
    both.vertices << a.vertices, far.vertices;
    both.triangles << 0, 1, 2, 3, 4, 5;
    const DrawnField field = drawn(both, b, {0.002 / 4.4});  // a fraction of the far triangle's distance
    EXPECT_GT(std::count(field.elements.begin(), field.elements.end(), 0), 3);
}

TEST(DrawnFields, TheWitnessIsAVertex) {
    const Vec3 witness(1, 0.7, 0);
    const auto has = [&](const DrawnField& field) {
        return (field.vertices.rowwise() - witness.transpose()).rowwise().norm().minCoeff() == 0;
    };
    const PointSet b{right_angled().vertices};
    EXPECT_TRUE(has(drawn(right_angled(), b, {1, 1, witness, 0})));
    EXPECT_FALSE(has(drawn(right_angled(), b, {1, 1})));
    EXPECT_FALSE(has(drawn(right_angled(), b, {1, 1, witness, 1})));  // triangle 1 does not exist
    const Vec3 beside(1, 0.7, 1e-3);
    const DrawnField field = drawn(right_angled(), b, {1, 1, beside, 0});  // off the triangle, so not added
    EXPECT_EQ(field.vertices.col(2).cwiseAbs().maxCoeff(), 0);
}

TEST(DrawnFields, TheLargestDifferencesGoFirstWhereThePiecesRunOut) {
    // The second triangle is twice as large, so its points are farther from B and it is cut first.
    TriangleMesh a{Points(6, 3), Triangles(2, 3)};
    a.vertices << 0, 0, 0, 0.01, 0, 0, 0, 0.01, 0, 5, 0, 0, 5.02, 0, 0, 5, 0.02, 0;
    a.triangles << 0, 1, 2, 3, 4, 5;
    const PointSet b{a.vertices};
    Drawing drawing{1e-4, 1};
    drawing.most_pieces = 5;
    const DrawnField field = drawn(a, b, drawing);
    EXPECT_FALSE(field.resolved);
    EXPECT_EQ(field.pieces.rows(), 5);
    EXPECT_EQ(std::count(field.elements.begin(), field.elements.end(), 1), 4);
    drawing.most_pieces = 1;  // fewer than A's triangles: no cuts
    EXPECT_EQ(drawn(a, b, drawing).pieces.rows(), 2);
}

TEST(DrawnFields, OfPointsAreNotCut) {
    const PointSet a{right_angled().vertices}, b{Points::Zero(1, 3)};
    const DrawnField field = draw_distance(PreparedShape(a, 0), {}, PreparedShape(b, 0), {}, {0.1, 1, {1, 0, 0}, 0});
    EXPECT_EQ(field.pieces.rows(), 0);
    EXPECT_EQ(field.distances, (std::vector<double>{0, 3, 3}));
    EXPECT_EQ(as_fields(field).size(), 5u);
}

TEST(DrawnFields, TheResolutionIsAPartOfTheLargerOfBothBounds) {
    // The vertices of A are 1 away from B. This value is used if the lower bound is smaller or NaN.
    TriangleMesh a = right_angled();
    a.vertices.col(2).setConstant(1);
    const PointSet b{right_angled().vertices};
    const auto pieces = [&](double lower) { return drawn(a, b, {0.1, lower}).pieces.rows(); };
    EXPECT_EQ(pieces(1e-9), pieces(0));
    EXPECT_EQ(pieces(std::nan("")), pieces(0));
    EXPECT_LT(pieces(50), pieces(0));
}

TEST(DrawnFields, WhereRoundingLeavesNoMiddleNothingIsCut) {
    TriangleMesh a{Points(3, 3), Triangles(1, 3)};
    a.vertices << 1, 1, 1, 1 + 0x1p-52, 1, 1, 1, 1 + 0x1p-52, 1;
    a.triangles << 0, 1, 2;
    EXPECT_EQ(drawn(a, PointSet{Points::Zero(1, 3)}, {1e-12}).pieces.rows(), 1);
}

TEST(DrawnFields, NeedlesAreNotCutByTheirLength) {
    TriangleMesh a{Points(6, 3), Triangles(2, 3)};
    a.vertices << 0, 0, 0, 4, 0, 0, 4, 1e-9, 0, 0, 0, 1, 0, 0, 1, 4, 0, 1;  // the second triangle has two equal corners
    a.triangles << 0, 1, 2, 3, 4, 5;
    TriangleMesh far = square();
    far.vertices.col(2).setConstant(3);
    EXPECT_LT(drawn(a, far, {0.5}).pieces.rows(), 10);
}

class FieldFile : public testing::Test {
protected:
    TemporaryFolder folder;
    Fields fields = {{"distance", Field::Of::vertices, Field::Meaning::number, {0, 0.1, 1e-300, 3}},
                     {"nearest", Field::Of::vertices, Field::Meaning::number, {3, 0, 1, 2}},
                     bounds("lower", Field::Meaning::lower, {0, 0.5, 1, 0.1}),
                     bounds("upper bound", Field::Meaning::upper, {0.25, 0.5, infinity, 0.2})};
    Fields solver_fields = {fields[2], fields[3]};

    DrawnField drawn(const Points& vertices, const Triangles& pieces) const {
        DrawnField out{vertices, pieces, {}, fields[0].values, {}};
        for (Index t = 0; t < pieces.rows(); ++t) out.elements.push_back(t);
        for (double element : fields[1].values) out.nearest.push_back(static_cast<Index>(element));
        return out;
    }
};

void expect_equal(const Fields& a, const Fields& b) {
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
        EXPECT_EQ(a[i].name, b[i].name);
        EXPECT_EQ(a[i].of, b[i].of);
        EXPECT_EQ(a[i].meaning, b[i].meaning);
        EXPECT_EQ(a[i].values, b[i].values);
    }
}

TEST_F(FieldFile, ComesBackToTheBitAndOnlyItself) {
    const auto file = folder.path() / "x.bin";
    const std::string sha256 = write_fields(file, fields);
    expect_equal(read_fields(file, sha256).value(), fields);
    std::fstream(file, std::ios::in | std::ios::out | std::ios::binary).seekp(-1, std::ios::end).put('!');
    EXPECT_FALSE(read_fields(file, sha256));
    EXPECT_FALSE(read_fields(folder.path() / "none.bin", sha256));
    EXPECT_THROW(write_fields(folder.path() / "none" / "x.bin", fields), InputError);
}

TEST_F(FieldFile, OfAResultIsInItsRow) {
    ResultFile result;
    result.rows.resize(3);
    for (Row& row : result.rows) row.outcome.solver_status = "converged";
    result.rows[0].fields = fields;
    result.rows[2].fields = {fields[1]};
    describe_run(result, Plan{}, "", "");
    const auto file = folder.path() / "r.h5";
    write_result(file, result);
    const ResultFile back = read_result(file);
    expect_equal(back.rows[0].fields, fields);
    EXPECT_TRUE(back.rows[1].fields.empty());
    expect_equal(back.rows[2].fields, {fields[1]});
}

using Mesh = CGAL::Surface_mesh<CGAL::Simple_cartesian<double>::Point_3>;

template <class Key, class Type> bool has_property(const Mesh& mesh, const std::string& name) {
    const auto map = mesh.property_map<Key, Type>(name);
    if constexpr (requires { map.second; }) {
        return map.second;  // CGAL 5: a pair
    } else {
        return map.has_value();  // CGAL 6: an optional
    }
}

template <class Key, class Type> std::vector<double> values_of(Mesh mesh, const std::string& name) {
    EXPECT_TRUE((has_property<Key, Type>(mesh, name))) << name;
    const auto map = mesh.add_property_map<Key, Type>(name).first;  // what is there
    std::vector<double> values;
    if constexpr (std::is_same_v<Key, Mesh::Vertex_index>) {
        for (const auto v : mesh.vertices()) values.push_back(double(map[v]));
    } else {
        for (const auto f : mesh.faces()) values.push_back(double(map[f]));
    }
    return values;
}

TEST_F(FieldFile, AsPlyIsReadByAnotherLibrary) {
    const auto file = folder.path() / "x.ply";
    const Points there = posed(tetrahedron().vertices, moved({0.1, 0, 0}));
    export_fields(file, drawn(there, tetrahedron().triangles), solver_fields);
    std::ifstream in(file, std::ios::binary);
    Mesh mesh;
    std::string comments;
    ASSERT_TRUE(CGAL::IO::read_PLY(in, mesh, comments));
    ASSERT_EQ(mesh.number_of_vertices(), 4u);
    ASSERT_EQ(mesh.number_of_faces(), 4u);
    for (const auto v : mesh.vertices()) {
        for (int k = 0; k < 3; ++k) EXPECT_EQ(mesh.point(v)[k], there(Index(v.idx()), k));
    }
    EXPECT_EQ((values_of<Mesh::Vertex_index, double>(mesh, "v:distance")), fields[0].values);
    EXPECT_EQ((values_of<Mesh::Vertex_index, float>(mesh, "v:quality"))[1], double(0.1f));
    EXPECT_EQ((values_of<Mesh::Vertex_index, int>(mesh, "v:nearest")), fields[1].values);
    EXPECT_FALSE((has_property<Mesh::Face_index, double>(mesh, "f:lower")));
}

TEST_F(FieldFile, OfPointsAsPlyIsReadByAnotherLibrary) {
    using Kernel = CGAL::Simple_cartesian<double>;
    using Read = std::tuple<Kernel::Point_3, double, int, double>;
    const auto file = folder.path() / "x.ply";
    const PointSet points{tetrahedron().vertices};
    export_fields(file, drawn(points.points, Triangles(0, 3)), solver_fields);
    std::ifstream in(file, std::ios::binary);
    std::vector<Read> read;
    ASSERT_TRUE(CGAL::IO::read_PLY_with_properties(
        in, std::back_inserter(read), CGAL::make_ply_point_reader(CGAL::Nth_of_tuple_property_map<0, Read>()),
        std::make_pair(CGAL::Nth_of_tuple_property_map<1, Read>(), CGAL::PLY_property<double>("distance")),
        std::make_pair(CGAL::Nth_of_tuple_property_map<2, Read>(), CGAL::PLY_property<int>("nearest")),
        std::make_pair(CGAL::Nth_of_tuple_property_map<3, Read>(), CGAL::PLY_property<double>("lower"))));
    ASSERT_EQ(read.size(), 4u);
    for (std::size_t i = 0; i < 4; ++i) {
        EXPECT_EQ(std::get<1>(read[i]), fields[0].values[i]);
        EXPECT_EQ(std::get<2>(read[i]), fields[1].values[i]);
        EXPECT_EQ(std::get<3>(read[i]), fields[2].values[i]);
    }
}

TEST_F(FieldFile, AsPlyOrVtkAreRefusedInOneLine) {
    EXPECT_THROW(check_export_place(folder.path() / "x.vtu"), InputError);
    EXPECT_THROW(check_export_place(folder.path() / "none" / "x.ply"), InputError);
    EXPECT_THROW(check_export_place(folder.path() / "none" / "x.vtk"), InputError);
    EXPECT_THROW(check_export_place(folder.path()), InputError);
    EXPECT_NO_THROW(check_export_place(folder.path() / "x.PLY"));
    EXPECT_NO_THROW(check_export_place(folder.path() / "x.Vtk"));
}

// Samples the cases of the error derivation in fields.cpp: triangles from regular to nearly
// degenerate, with points on, near and far above them.
TEST(DistanceFields, AreWithinTheirErrorOfNeedles) {
    Random random(8);
    long double worst = 0;
    for (int sample = 0; sample < 1500; ++sample) {
        TriangleMesh mesh{Points(3, 3), Triangles(1, 3)};
        mesh.triangles << 0, 1, 2;
        const Vec3 a = random.vector(), edge = random.vector(), side = random.vector();
        const double height = std::ldexp(1.0, -(sample % 60)), along = random.real(0, 1);
        mesh.vertices.row(0) = a;
        mesh.vertices.row(1) = a + edge;
        mesh.vertices.row(2) = a + along * edge + height * side;
        PointSet points{Points(6, 3)};
        for (Index i = 0; i < 6; ++i) {
            const double up = i < 2 ? 0 : std::ldexp(1.0, -static_cast<int>(random.below(56)));
            const double x = random.real(0, 1), y = random.real(0, 1 - x);
            points.points.row(i) = a + x * edge + y * (along * edge + height * side) + up * random.vector();
        }
        const Fields fields = fields_of(points, {}, mesh, {});
        const double m = std::max(points.points.cwiseAbs().maxCoeff(), mesh.vertices.cwiseAbs().maxCoeff());
        for (Index i = 0; i < 6; ++i) {
            const auto corner = [&](Index k) { return exact::vector(mesh.vertices.row(k).transpose()); };
            const exact::Rational squared = exact::squared_distance_to_triangle(
                exact::vector(points.points.row(i).transpose()), corner(0), corner(1), corner(2));
            const long double off =
                std::abs(static_cast<long double>(fields[0].values[std::size_t(i)]) - exact::root(squared));
            worst = std::max(worst, off / static_cast<long double>(field_error(m)));
            ASSERT_LE(off, static_cast<long double>(field_error(m))) << "height " << height << ", vertex " << i;
        }
    }
    EXPECT_GE(worst, 0.005L) << "the samples do not show what they are for";
}

class CheckFields : public testing::Test {
protected:
    void expect(Verdict verdict, const char* why = "") {
        std::string reason;
        EXPECT_EQ(check_fields(fields, a, pose, b, target_pose, slack, {}, reason), verdict) << reason;
        EXPECT_NE(reason.find(why), std::string::npos) << reason;
        EXPECT_EQ(reason.empty(), verdict != Verdict::unsound);
    }
    double& distance(std::size_t i) { return fields[0].values[i]; }
    double& nearest(std::size_t i) { return fields[1].values[i]; }

    Shape a = tetrahedron(), b = square();
    Pose pose = moved({1, -1, 3}), target_pose = moved({0, 0, -4});
    Fields fields = fields_of(a, pose, b, target_pose);
    const double error = field_error(4);
    double slack = 0;
};

TEST_F(CheckFields, TheTruthHolds) {
    expect(Verdict::holds);
    distance(2) += 0.9 * error;
    distance(1) -= 0.9 * error;
    expect(Verdict::holds);
}

TEST_F(CheckFields, ADistanceIsNoLarger) {
    distance(2) += 1.2 * error;
    expect(Verdict::unsound, "vertex 2: distance 7.00");
}

TEST_F(CheckFields, ADistanceIsNoSmaller) {
    distance(3) -= 1.2 * error;
    expect(Verdict::unsound, "vertex 3: distance 7.99");
}

TEST_F(CheckFields, TheElementNamedIsTheNearest) {
    nearest(1) = 1;
    expect(Verdict::unsound, "element 1 of B");
}

TEST_F(CheckFields, WhatIsNoDistanceOrElement) {
    for (double bad : {-1.0, infinity, std::nan("")}) {
        const double good = distance(0);
        distance(0) = bad;
        expect(Verdict::unsound, "no distance");
        distance(0) = good;
    }
    for (double bad : {-1.0, 2.0, 0.5, infinity, std::nan("")}) {
        nearest(0) = bad;
        expect(Verdict::unsound, "not an element of B");
    }
    fields[1].values.pop_back();
    expect(Verdict::unsound, "3 values for 4 vertices");
    fields.resize(1);
    expect(Verdict::unsound, "missing");
}

class CheckDrawnFields : public CheckFields {
protected:
    void SetUp() override {
        fields = as_fields(draw_distance(PreparedShape(a, 0), pose, PreparedShape(b, 0), target_pose, {0.01}));
        expect(Verdict::holds);
    }
    std::vector<double>& of(std::string_view name) {
        return std::find_if(fields.begin(), fields.end(), [&](const Field& f) { return f.name == name; })->values;
    }
    std::size_t last() { return of("distance").size() - 1; }
};

TEST_F(CheckDrawnFields, VerticesThatCutsAddedHaveTheirDistance) {
    ASSERT_GT(last(), 10u);
    of("distance")[last()] += 1.2 * error;
    expect(Verdict::unsound, "but an element");
}

TEST_F(CheckDrawnFields, VerticesOfAComeFirst) {
    of("x")[2] = std::nextafter(of("x")[2], 9.0);
    expect(Verdict::unsound, "vertex 2 is not where A has it");
    of("x")[2] = std::nan("");
    expect(Verdict::unsound, "vertex 2 is not");
}

TEST_F(CheckDrawnFields, VerticesThatCutsAddedAreOnA) {
    for (const double bad : {1e200, -1.7e308, std::nan("")}) {
        SetUp();
        of("x")[last()] = bad;
        expect(Verdict::unsound, "is not on A");
    }
    SetUp();
    std::erase_if(fields, [](const Field& field) { return field.of == Field::Of::pieces; });
    expect(Verdict::unsound, "no pieces");
}

TEST_F(CheckDrawnFields, HoldAtEveryScale) {
    for (const int scale : {-1060, -530, -400, 400, 1000}) {
        TriangleMesh small = tetrahedron(), flat = square();
        for (Points* points : {&small.vertices, &flat.vertices})
            *points = points->unaryExpr([&](double x) { return std::ldexp(x, scale); });
        a = small, b = flat;
        pose = target_pose = {};
        fields = as_fields(draw_distance(PreparedShape(a, 0), pose, PreparedShape(b, 0), target_pose, {0.1}));
        EXPECT_GT(of("element").size(), 50u);
        expect(Verdict::holds);
    }
}

TEST_F(CheckDrawnFields, PiecesAreOfTheirTriangle) {
    of("element").back() = std::fmod(of("element").back() + 1, 4);
    expect(Verdict::unsound, "piece");
    of("element").back() = 4;
    expect(Verdict::unsound, "out of range");
}

TEST_F(CheckDrawnFields, PiecesLieOnTheirTriangle) {
    fields = as_fields(draw_distance(PreparedShape(a, 0), pose, PreparedShape(b, 0), target_pose));
    expect(Verdict::holds);
    std::swap(of("element")[0], of("element")[1]);  // two faces of the same area
    expect(Verdict::unsound, "not on its element");
}

TEST_F(CheckDrawnFields, PiecesCoverTheirTriangle) {
    for (const char* name : {"a", "b", "c", "element"}) of(name).pop_back();
    expect(Verdict::unsound, "its pieces have 0.");
    of("a").pop_back();
    expect(Verdict::unsound, "values for");
}

TEST_F(CheckFields, BothShapesArePosed) {
    target_pose = moved({0, 0, -4.5});
    expect(Verdict::unsound, "is farther");
    target_pose = moved({0, 0, -3.5});
    expect(Verdict::unsound, "is nearer");
    target_pose = moved({0, 0, -4});
    expect(Verdict::holds);
    pose.translation[2] = 2.5;
    expect(Verdict::unsound, "is nearer");
}

TEST_F(CheckFields, BeyondTheDoublesNothingIsChecked) {
    pose.rotation *= 1e308;
    pose.translation *= 1e308;
    expect(Verdict::not_checked);
}

// The farthest points of A's faces are 7, 8, 8 and 8 away from B.
TEST_F(CheckFields, BoundsOfElements) {
    fields.push_back(bounds("lower", Field::Meaning::lower, {7, 8, 8, 8}));
    fields.push_back(bounds("upper", Field::Meaning::upper, {7, 8, 8, 8}));
    expect(Verdict::holds);
    fields[3].values[1] = infinity;
    fields[2].values[1] = 0;
    expect(Verdict::holds);

    const Fields good = fields;
    fields[3].values[0] = std::nextafter(7.0, 0.0), fields[2].values[0] = 0;
    expect(Verdict::unsound, "elements 0: upper 6.99");
    fields = good;
    fields[3].values[1] = 7.5, fields[2].values[1] = 0;  // a corner is 8 away, the centroid less
    expect(Verdict::unsound, "elements 1: upper 7.5");
    fields = good;
    fields[2].values[2] = std::nextafter(8.0, 9.0), fields[3].values[2] = infinity;
    expect(Verdict::unsound, "elements 2: lower 8.00");
    fields = good;
    fields[2].values[3] = infinity, fields[3].values[3] = infinity;
    expect(Verdict::unsound, "elements 3: lower inf");
    fields = good;
    fields[3].values[0] = 6.5;
    expect(Verdict::unsound, "is not at most upper");
    fields = good;
    fields[3].values[0] = std::nan("");
    expect(Verdict::unsound, "is not at most upper");
}

TEST_F(CheckFields, BoundsOfElementsMayBeOffByTheSlack) {
    fields.push_back(bounds("lower", Field::Meaning::lower, {7, 8, 8, 8}));
    fields.push_back(bounds("upper", Field::Meaning::upper, {7, 8, 8, 8}));
    const Fields good = fields;
    for (double off : {0.9, 1.1}) {
        const Verdict verdict = off < 1 ? Verdict::holds : Verdict::unsound;
        slack = 1e-12;
        fields = good;
        fields[3].values[0] -= off * slack, fields[2].values[0] = 0;
        expect(verdict, off < 1 ? "" : "elements 0: upper 6.99");
        fields = good;
        fields[2].values[2] += off * slack, fields[3].values[2] = infinity;
        expect(verdict, off < 1 ? "" : "elements 2: lower 8.00");
        fields = good;
        fields[2].values[0] = 6, fields[3].values[0] = 7, fields[2].values[0] = 7 + off * slack;
        expect(verdict, off < 1 ? "" : "is not at most upper");
    }
}

// The check also measures the centroid: it is sqrt(2) away from B, but all corners are on B.
TEST_F(CheckFields, AnUpperBoundCoversTheCentroid) {
    TriangleMesh triangle{Points(3, 3), Triangles(1, 3)};
    triangle.vertices << 0, 0, 0, 3, 0, 0, 0, 3, 0;
    triangle.triangles << 0, 1, 2;
    a = triangle;
    b = PointSet{triangle.vertices};
    pose = target_pose = {};
    fields = fields_of(a, pose, b, target_pose);
    fields.push_back(bounds("upper", Field::Meaning::upper, {1.4}));  // less than sqrt(2)
    expect(Verdict::unsound, "elements 0: upper 1.3999");
    fields.back().values[0] = 3;
    expect(Verdict::holds);
}

// The triangle is c away. Its centroid, rounded upwards, must not refute an upper bound of c.
TEST_F(CheckFields, TheCentroidMayBeOffTheElement) {
    pose = target_pose = {};
    int above = 0;
    for (int i = 1; i < 40; ++i) {
        const double c = 0.1 * i;
        TriangleMesh triangle{Points(3, 3), Triangles(1, 3)};
        triangle.vertices << 0, 0, c, 1, 0, c, 0, 1, c;
        triangle.triangles << 0, 1, 2;
        a = triangle;
        fields = fields_of(a, pose, b, target_pose);
        fields.push_back(bounds("upper", Field::Meaning::upper, {c}));
        expect(Verdict::holds);
        above += c / 3 + c / 3 + c / 3 > c;
    }
    EXPECT_GT(above, 0);
}

TEST_F(CheckFields, TheLastOfManyIsLookedAt) {
    PointSet many{Points(1001, 3)};
    for (Index i = 0; i < 1001; ++i) many.points.row(i) << 0.001 * i, 0, 0;
    a = many;
    fields = fields_of(a, pose, b, target_pose);
    expect(Verdict::holds);
    for (std::size_t i : {std::size_t(0), std::size_t(1000)}) {
        fields[0].values[i] += 1;
        expect(Verdict::unsound, fmt::format("vertex {}:", i).c_str());
        fields[0].values[i] -= 1;
    }
    int looked_at = 0;
    for (std::size_t i = 0; i < 50; ++i) {
        Fields wrong = fields;
        wrong[1].values[i] = -1;
        std::string why;
        looked_at += check_fields(wrong, a, pose, b, target_pose, slack, {}, why) == Verdict::unsound;
    }
    EXPECT_EQ(looked_at, 5);  // every tenth vertex is checked
    std::string reason;
    EXPECT_EQ(check_fields(
                  fields, a, pose, b, target_pose, slack, [] { return true; }, reason),
              Verdict::not_checked);
}

TEST_F(CheckFields, AnUnsoundFieldMakesItsRowUnsound) {
    Row row;
    row.spec.source = "a";
    row.spec.target = "b";
    row.spec.pose = pose;
    row.spec.target_pose = target_pose;
    row.outcome.status = RowStatus::ok;
    row.outcome.bounds = {0, infinity};
    row.fields = fields;
    Fields rounded = fields;
    rounded.push_back(bounds("upper", Field::Meaning::upper, {std::nextafter(7.0, 0.0), 8, 8, 8}));
    std::vector<Row> rows = {row, row, row, row};
    rows[1].fields[0].values[0] = 6;
    rows[2].fields = rows[3].fields = rounded;
    rows[2].spec.certified = 0;
    rows[3].spec.certified = 1;
    verify_rows(rows, [&](const std::string& name) { return name == "a" ? &a : &b; });
    EXPECT_EQ(rows[0].check.fields, Verdict::holds);
    EXPECT_EQ(rows[0].outcome.status, RowStatus::ok);
    EXPECT_EQ(rows[1].check.fields, Verdict::unsound);
    EXPECT_EQ(rows[1].outcome.status, RowStatus::unsound);
    EXPECT_NE(rows[1].outcome.reason.find("vertex 0"), std::string::npos);
    EXPECT_EQ(rows[2].check.fields, Verdict::holds);  // not certified, so rounding is allowed
    EXPECT_EQ(rows[3].check.fields, Verdict::unsound);
}

}  // namespace
}  // namespace hausbench
