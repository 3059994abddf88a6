// Attacks on the certificate checker: valid certificates of every solver that writes them are changed in many ways. The
// checker must refuse each claim that exact rational arithmetic (certificate_exact.h) finds false.
//
// HAUSBENCH_ATTACKS: the number of false claims to try, 1000 by default. The seed is fixed.
#include "algorithms/error.h"
#include "algorithms/registry.h"
#include "algorithms/session/session.h"
#include "datasets/shape_file.h"
#include "harness/check/certificate_file.h"
#include "tests/support/certificate_exact.h"
#include "tests/support/quick_options.h"
#include "tests/support/scenes.h"
#include "tests/support/seal.h"
#include "tests/support/small_scenes.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>

namespace hausbench {
namespace {

using namespace certificates;
using Kind = Node::Kind;

constexpr std::uint64_t seed = 20261;

std::vector<const SolverEntry*> writers() {
    std::vector<const SolverEntry*> all;
    for (const SolverEntry& entry : solvers()) {
        if (entry.info.can(Ability::certificates)) all.push_back(&entry);
    }
    return all;
}

// Returns small random meshes with thin, duplicate or degenerate triangles; some lie far from the origin, or are very
// large or small.
Scene any_scene(Random& random, int i) {
    Scene scene = small_scene(random, i);
    Shape a = scene.source, b = scene.target;
    if (i % 7 == 0) points_of(a).row(1) = points_of(a).row(0);
    if (i % 11 == 0) a = PointSet{points_of(a)};
    if (i % 5 == 1) {
        for (Shape* shape : {&a, &b}) transform(*shape, 1, Vec3(1e8, -1e8, 1e8));
    }
    if (i % 5 == 2 || i % 5 == 3) {
        for (Shape* shape : {&a, &b}) transform(*shape, std::ldexp(1.0, i % 5 == 2 ? 500 : -500), Vec3::Zero());
    }
    return {a, b};
}

struct Truth {
    Scene scene;
    std::string solver;
    CertificateFile file;
    Proof proof;

    const Certificate& certificate() const { return file.certificates[0]; }
};

// Returns nothing if the solver writes no certificate, or one so long that the exact checker would be slow.
std::optional<Truth> true_one(Random& random, int i) {
    static const auto all = writers();
    const SolverEntry& entry = *all[std::size_t(i) % all.size()];
    Truth truth{any_scene(random, int(random.below(1000))), entry.info.name, {}, {}};
    Points both(points_of(truth.scene.source).rows() + points_of(truth.scene.target).rows(), 3);
    both << points_of(truth.scene.source), points_of(truth.scene.target);
    Query query;
    query.tolerance.value = diagonal(both) * std::pow(2.0, -random.real(2, 10));
    query.wanted.certificate = true;
    Trace untraced;
    const Result result = Session(entry, quick_options(entry), truth.scene, {}).solve(query, untraced);
    if (result.certificates.empty() || result.certificates[0].bytes.size() > 1500) return std::nullopt;
    truth.file.source = {"a", content_hash(truth.scene.source), {}};
    truth.file.target = {"b", content_hash(truth.scene.target), {}};
    truth.file.solver = entry.info.name;
    truth.file.tolerance_of = "absolute";
    truth.file.bounds = result.bounds;
    truth.file.witness = result.witness;
    truth.file.certificates = result.certificates;
    state_what_is_proven(truth.file, truth.scene.source, truth.scene.target);
    ExactChecker exact(truth.scene.source, truth.scene.target);
    EXPECT_EQ(exact.claim(truth.certificate().bytes, truth.certificate().proven), Claim::holds) << entry.info.name;
    EXPECT_EQ(written(exact.proof, 0).bytes, truth.certificate().bytes);
    EXPECT_TRUE(check_certificate(truth.scene.source, {}, truth.scene.target, {}, truth.certificate()).accepted);
    truth.proof = exact.proof;
    return truth;
}

// --- changes -----------------------------------------------------------------------------------------------------------

Node* any_node(Proof& proof, Random& random, bool cut) {
    for (int tries = 0; tries < 30; ++tries) {
        Tree& tree = proof[std::size_t(random.below(Index(proof.size())))];
        if (tree.empty()) continue;
        Node& node = tree[std::size_t(random.below(Index(tree.size())))];
        if ((node.kind == Kind::cut) == cut) return &node;
    }
    return nullptr;
}

double any_t(double t, Random& random) {
    const double all[] = {random.unit(),        0,         1,    std::nextafter(t, 0),
                          std::nextafter(t, 1), 0x1p-1074, -0.0, 0x1.0000000000001p0};
    return all[random.below(8)];
}

void change_leaf(Node& leaf, const Truth& truth, Random& random) {
    const Index targets = triangles_of(truth.scene.target).triangles.rows(),
                vertices = points_of(truth.scene.source).rows();
    if (const Index what = random.below(3); what == 0)
        leaf.k = random.below(targets + (random.below(20) == 0));
    else if (what == 1)
        leaf.v = random.below(vertices + (random.below(20) == 0));
    else
        leaf.kind = Kind(1 + random.below(3));
}

void change_cut(Node& cut, Random& random) {
    CutPoint& point = random.below(2) ? cut.p : cut.q;
    const Index what = random.below(5);
    if (what == 0 && point.t >= 0) point.t = any_t(point.t, random);
    if (what == 1) point.place = std::size_t(random.below(6));
    if (what == 2 && point.t >= 0) point.backward = !point.backward;
    if (what == 3)
        point = random.below(2) ? CutPoint::corner(point.place) : CutPoint::along(point.place, random.unit());
    if (what == 4) std::swap(cut.p, cut.q);
}

void change_trees(Proof& proof, Random& random) {
    Tree& tree = proof[std::size_t(random.below(Index(proof.size())))];
    Tree& other = proof[std::size_t(random.below(Index(proof.size())))];
    const auto at = tree.begin() + random.below(Index(tree.size()));
    const Index what = random.below(3);
    if (what == 0) std::swap(tree, other);
    if (what == 1) tree.insert(at, Node(*at));
    if (what == 2 && tree.size() > 1) tree.erase(at);
}

void change_bytes(std::string& bytes, const std::string& other, Random& random) {
    const auto place = [&](const std::string& of) { return std::size_t(random.below(Index(of.size()) + 1)); };
    const Index what = random.below(5);
    if (what == 0) bytes.resize(place(bytes));
    if (what == 1) bytes = bytes.substr(0, place(bytes)) + other.substr(place(other));
    if (what == 2) bytes.insert(place(bytes), 1, char(random.below(256)));
    if (what == 3) {
        for (char& byte : bytes) byte = char(random.below(256));
    }
    if (what == 4 && !bytes.empty()) {
        char& byte = bytes[std::size_t(random.below(Index(bytes.size())))];
        byte = char(byte ^ (1 << random.below(8)));
    }
}

// Changes the bytes of a certificate, and perhaps lowers its claim: slightly, or to just below the bound that the
// changed bytes prove.
Certificate changed(const Truth& truth, const std::string& other, Random& random) {
    Certificate bad = truth.certificate();
    Proof proof = truth.proof;
    const Index what = random.below(5);
    if (what == 0) {
        if (Node* leaf = any_node(proof, random, false)) change_leaf(*leaf, truth, random);
    } else if (what == 1) {
        if (Node* cut = any_node(proof, random, true)) change_cut(*cut, random);
    } else if (what == 2) {
        change_trees(proof, random);
    }
    bad.bytes = written(proof, 0).bytes;
    if (what == 3) change_bytes(bad.bytes, other, random);
    if (random.below(2)) {
        bad.proven = infinity;
        const double bound = check_certificate(truth.scene.source, {}, truth.scene.target, {}, bad).found;
        if (!(bound < infinity)) return bad;
        bad.proven = bound;
        for (Index steps = random.below(40); steps >= 0; --steps) bad.proven = std::nextafter(bad.proven, 0);
    } else if (what == 4) {
        bad.proven *= 1 - std::pow(2.0, -random.real(1, 53));
    }
    return bad;
}

// --- the tests ---------------------------------------------------------------------------------------------------------

int wanted() {
    const char* number = std::getenv("HAUSBENCH_ATTACKS");
    return number ? std::atoi(number) : 1000;
}

struct Count {
    int is_false = 0, no_format = 0, open = 0, holds = 0, true_accepted = 0;
};

std::ostream& operator<<(std::ostream& out, const Count& c) {
    return out << c.is_false << " false, " << c.no_format << " of no format, " << c.holds << " true ("
               << c.true_accepted << " of them accepted), " << c.open << " open";
}

// Returns true if the checker accepts a false or malformed certificate.
bool fools(ExactChecker& exact, const Truth& truth, const Certificate& certificate, Count& count) {
    const Claim claim = exact.claim(certificate.bytes, certificate.proven);
    const bool accepted = check_certificate(truth.scene.source, {}, truth.scene.target, {}, certificate).accepted;
    if (claim == Claim::is_false) ++count.is_false;
    if (claim == Claim::no_format) ++count.no_format;
    if (claim == Claim::is_open) ++count.open;
    if (claim == Claim::holds) ++count.holds, count.true_accepted += accepted;
    return accepted && (claim == Claim::is_false || claim == Claim::no_format);
}

TEST(CertificateAttack, NoFalseClaimIsAccepted) {
    Random random(seed);
    std::map<std::string, Count> counts;
    std::string other = "\1";
    int tried = 0;
    for (int i = 0; tried < wanted(); ++i) {
        const auto truth = true_one(random, i);
        if (!truth) continue;
        ExactChecker exact(truth->scene.source, truth->scene.target);
        Count& count = counts[truth->solver];
        for (int k = 0; k < 20; ++k) {
            const Certificate bad = changed(*truth, other, random);
            const int before = count.is_false;
            ASSERT_FALSE(fools(exact, *truth, bad, count))
                << "seed " << seed << ", certificate " << i << " of " << truth->solver << ", change " << k;
            tried += count.is_false - before;
        }
        other = truth->certificate().bytes;
        if (HasFailure()) return;
    }
    std::cout << "seed " << seed << '\n';
    for (const auto& [name, count] : counts) {
        std::cout << name << ": " << count << '\n';
        EXPECT_GT(count.is_false, tried / 20) << name;
        EXPECT_GT(count.true_accepted, 0) << name;
    }
}

// Changes bytes of the header or the body, then recomputes the seal, which would reveal every change.
TEST(CertificateAttack, NoResealedFileProvesWhatIsFalse) {
    const TemporaryFolder folder;
    const std::filesystem::path file = folder.path() / "proof";
    Random random(seed + 1);
    Count count;
    for (int i = 0, tried = 0; tried < wanted(); ++i) {
        const auto truth = true_one(random, i);
        if (!truth) continue;
        write_certificate(file, truth->file);
        std::ifstream in(file, std::ios::binary);
        std::string whole{std::istreambuf_iterator<char>(in), {}};
        whole.resize(whole.size() - seal_bytes);
        for (int k = 0; k < 20; ++k, ++tried) {
            std::string bad = whole;
            change_bytes(bad, whole, random);
            bad = sealed(bad);
            std::ofstream(file, std::ios::binary).write(bad.data(), std::ptrdiff_t(bad.size()));
            try {
                const CertificateFile read = read_certificate(file);
                const CertificateVerdict verdict = verify_certificate(read, truth->scene.source, truth->scene.target);
                if (!verdict.accepted) continue;
                Shape a = truth->scene.source, b = truth->scene.target;
                points_of(a) = posed(points_of(a), read.source.pose);
                points_of(b) = posed(points_of(b), read.target.pose);
                ExactChecker exact(a, b);
                ASSERT_EQ(read.certificates.size(), 1u);
                const Claim claim = exact.claim(read.certificates[0].bytes, verdict.proven);
                ASSERT_TRUE(claim == Claim::holds || claim == Claim::is_open) << i << ", " << k;
                ++count.true_accepted;
            } catch (const InputError&) {
                ++count.no_format;
            }
        }
    }
    std::cout << "seed " << seed + 1 << ": " << count.no_format << " are no files, " << count.true_accepted
              << " accepted and true\n";
    EXPECT_GT(count.no_format, 0);
    EXPECT_GT(count.true_accepted, 0);
}

TEST(CertificateAttack, ClaimsThatAreNoLengths) {
    const Shape a = soup(rows({{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}));
    const Certificate same = written(Proof{Tree{Node{}}}, 0);
    EXPECT_TRUE(check_certificate(a, {}, a, {}, same).accepted);
    for (const double proven : {-5e-324, -1.0, -infinity, std::nan("")}) {
        Certificate bad = same;
        bad.proven = proven;
        EXPECT_FALSE(check_certificate(a, {}, a, {}, bad).accepted) << proven;
    }
    // The limits of the format, then one beyond each: the corners of a polygon, and the polygons that wait for their
    // leaves.
    for (const int more : {0, 1}) {
        Tree round, deep;
        for (int i = 0; i < 61 + more; ++i) {
            round.push_back(Node{Kind::cut, 0, 0, CutPoint::along(0, 0x1p-1074), CutPoint::along(1, 1)});
            round.push_back(Node{});
        }
        round.push_back(Node{});
        for (int i = 0; i < 4096 + more; ++i)
            deep.push_back(Node{Kind::cut, 0, 0, CutPoint::corner(1), CutPoint::along(2, 0)});
        deep.insert(deep.end(), deep.size() + 1, Node{});
        for (const Tree& tree : {round, deep}) {
            const Certificate certificate = written(Proof{tree}, 9);
            EXPECT_EQ(check_certificate(a, {}, a, {}, certificate).accepted, more == 0) << tree.size();
            EXPECT_EQ(ExactChecker(a, a).claim(certificate.bytes, 9) == Claim::no_format, more == 1) << tree.size();
        }
    }
}

}  // namespace
}  // namespace hausbench
