// All instruction sets that were compiled in and that this machine has must give the same bits; each is forced in turn.
#include "algorithms/kernel/triangle_block.h"
#include "algorithms/structures/bvh.h"
#include "algorithms/structures/octree.h"
#include "algorithms/structures/triangle_blocks.h"
#include "tests/support/tree_meshes.h"
#include "tests/support/triangle_samples.h"

#include <hwy/targets.h>

#include <cstring>
#include <fstream>
#include <functional>
#include <iterator>
#include <set>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

namespace hausbench {
namespace {

void for_each_target(const std::function<void(const std::string&)>& f) {
    int targets = 0;
    for (const auto target : hwy::SupportedAndGeneratedTargets()) {
        hwy::SetSupportedTargetsForTest(target);
        hwy::GetChosenTarget().Update(hwy::SupportedTargets());
        f(hwy::TargetName(target));
        ++targets;
    }
    hwy::SetSupportedTargetsForTest(0);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    EXPECT_GE(targets, 2) << "nothing was compared";
}

// Returns the features that the processor has and Linux allows.
std::set<std::string> processor_flags() {
    std::ifstream in("/proc/cpuinfo");
    for (std::string line; std::getline(in, line);) {
        if (line.rfind("flags", 0) != 0) continue;
        std::istringstream words(line);
        return {std::istream_iterator<std::string>(words), {}};
    }
    return {};
}

TEST(Targets, AreThoseOfTheProcessor) {
    const std::set<std::string> flags = processor_flags();
    if (!flags.contains("sse2")) GTEST_SKIP() << "/proc/cpuinfo does not list an x86 processor's flags";
    bool has = true;
    const auto expect = [&](std::int64_t target, std::initializer_list<const char*> needed) {
        for (const char* const flag : needed) has = has && flags.contains(flag);
        EXPECT_EQ((hwy::SupportedTargets() & target) != 0, has) << hwy::TargetName(target);
    };
    expect(HWY_SSSE3, {"ssse3"});
    expect(HWY_SSE4, {"sse4_1", "sse4_2", "pclmulqdq", "aes"});
    expect(HWY_AVX2, {"avx2", "bmi1", "bmi2", "fma", "f16c"});
    expect(HWY_AVX3, {"avx512f", "avx512vl", "avx512dq", "avx512bw", "avx512cd"});
}

bool same_bits(double a, double b) { return std::memcmp(&a, &b, sizeof a) == 0; }

TEST(Targets, BlocksHaveTheBitsOfTheScalarKernel) {
    Random random(1);
    TriangleMesh mesh;
    std::vector<Vec3> points;
    const auto all = kinds();
    constexpr int rounds = 20;
    const auto count = static_cast<Index>(block_width * rounds * all.size());
    mesh.vertices.resize(3 * count, 3);
    mesh.triangles.resize(count, 3);
    for (Index i = 0; i < count; ++i) {
        const Sample sample = all[static_cast<std::size_t>(i) % all.size()].make(random);
        mesh.vertices.row(3 * i) = sample.triangle.a;
        mesh.vertices.row(3 * i + 1) = sample.triangle.b;
        mesh.vertices.row(3 * i + 2) = sample.triangle.c;
        mesh.triangles.row(i) << 3 * i, 3 * i + 1, 3 * i + 2;
        points.push_back(sample.point);
    }
    for_each_target([&](const std::string& target) {
        std::vector<Index> lanes(block_width);
        for (Index i = 0; i < count; i += block_width) {
            for (int k = 0; k < block_width; ++k) lanes[static_cast<std::size_t>(k)] = i + k;
            TriangleBlock block;
            block.set(mesh, lanes);
            BlockFeet feet;
            for (int k = 0; k < block_width; ++k) {  // each lane with its own point and with seven others
                const Vec3& p = points[static_cast<std::size_t>(i + k)];
                closest_points(p, block, feet);
                for (int lane = 0; lane < block_width; ++lane) {
                    const TrianglePoint expected = closest_point(p, triangle_of(mesh, i + lane));
                    ASSERT_TRUE(same_bits(feet.squared_distance[lane], expected.squared_distance)) << target;
                    for (int c = 0; c < 3; ++c)
                        ASSERT_TRUE(same_bits(feet.point[c][lane], expected.point[c])) << target;
                }
            }
            PointBlock many;
            for (int lane = 0; lane < block_width; ++lane) {
                for (int c = 0; c < 3; ++c) many.coordinate[c][lane] = points[static_cast<std::size_t>(i + lane)][c];
            }
            const Triangle triangle = triangle_of(mesh, i);
            closest_points(many, triangle, feet);
            for (int lane = 0; lane < block_width; ++lane) {
                const TrianglePoint expected = closest_point(points[static_cast<std::size_t>(i + lane)], triangle);
                ASSERT_TRUE(same_bits(feet.squared_distance[lane], expected.squared_distance)) << target;
                for (int c = 0; c < 3; ++c) ASSERT_TRUE(same_bits(feet.point[c][lane], expected.point[c])) << target;
            }
        }
    });
}

struct Answer {
    ClosestPoint closest;
    double certified;
    double certified_by_blocks;
};

TEST(Targets, TreesAnswerAndCountAlike) {
    const auto meshes = tree_meshes();
    std::vector<Answer> first;
    Counters first_counters;
    std::string first_target;
    for_each_target([&](const std::string& target) {
        std::vector<Answer> answers;
        Counters counters;
        Random random(2);
        for (const auto& [name, mesh] : meshes) {
            const TriangleBvh bvh(mesh);
            const TriangleOctree octree(mesh);
            const TriangleBlocks blocks(mesh);
            Index warm = -1;
            for (int i = 0; i < 20; ++i) {
                const Vec3 p = query_near(mesh, random);
                const TriangleTree& tree = i % 2 == 0 ? static_cast<const TriangleTree&>(bvh) : octree;
                ClosestHints hints;
                hints.warm_triangle = i % 3 == 0 ? -1 : warm;
                if (i % 5 == 0) hints.early_out_squared = 0.01;
                Answer answer{tree.closest(p, hints, counters), tree.certified_distance(p, counters),
                              blocks.certified_distance(p, counters)};
                if (i % 4 == 3) answer.closest = blocks.closest(p, hints, counters);
                NearTriangles<float> near;
                near.clear(blocks.leaves().front().units);
                blocks.gather(p, 2 * std::sqrt(answer.closest.squared_distance), near, counters);
                warm = answer.closest.triangle;
                answers.push_back(answer);
            }
        }
        if (first.empty()) {
            first = answers;
            first_counters = counters;
            first_target = target;
            return;
        }
        const std::string where = target + " against " + first_target;
        EXPECT_EQ(counters, first_counters) << where;
        for (std::size_t i = 0; i < answers.size(); ++i) {
            ASSERT_TRUE(same_bits(answers[i].closest.squared_distance, first[i].closest.squared_distance)) << where;
            ASSERT_EQ(answers[i].closest.triangle, first[i].closest.triangle) << where;
            for (int k = 0; k < 3; ++k)
                ASSERT_TRUE(same_bits(answers[i].closest.point[k], first[i].closest.point[k])) << where;
            ASSERT_TRUE(same_bits(answers[i].certified, first[i].certified)) << where;
            ASSERT_TRUE(same_bits(answers[i].certified_by_blocks, first[i].certified_by_blocks)) << where;
        }
    });
}

}  // namespace
}  // namespace hausbench
