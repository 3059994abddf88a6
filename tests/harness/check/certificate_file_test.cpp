// Certificates in files: reading gives back what was written, and an answer is accepted as a whole or not at all.
#include "harness/check/certificate_file.h"

#include "algorithms/error.h"
#include "datasets/shape_file.h"
#include "tests/support/certificates.h"
#include "tests/support/scenes.h"
#include "tests/support/seal.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

namespace hausbench {
namespace {

using namespace certificates;
using Direction = Witness::Direction;

// A is a triangle at height 0; B is the same triangle, moved to height 1 by its pose; h(A,B) = h(B,A) = 1.
const Shape flat = soup(rows({{0, 0, 0}, {2, 0, 0}, {0, 2, 0}}));

CertificateFile proof_of(Quantity quantity) {
    CertificateFile c;
    c.source = {"a.off", content_hash(flat), {}};
    c.target = {"b \"2\".off", content_hash(flat), {}};
    c.target.pose = turned(1, 0, {0, 0, 1});
    c.target.pose.rotation.setIdentity();
    c.quantity = quantity;
    c.solver = "a solver";
    c.tolerance = 1e-3, c.tolerance_of = "diagonal";
    c.bounds = {1, 1 + 1e-12};
    c.witness = {Vec3(0, 0, 0), Vec3(0, 0, 1), 0, 0, Direction::source_to_target};
    Certificate certificate = written(Proof{{Node{}}}, 1 + 1e-12);
    c.certificates = {certificate};
    certificate.direction = Direction::target_to_source;
    if (quantity == Quantity::symmetric) c.certificates.push_back(certificate);
    return c;
}

std::string refusal(const CertificateFile& c, const Shape& a = flat, const Shape& b = flat) {
    const CertificateVerdict verdict = verify_certificate(c, a, b);
    EXPECT_EQ(verdict.accepted, verdict.refusal.empty());
    EXPECT_NE(describe(c, verdict).find(verdict.accepted ? "\naccepted " : "\nrefused "), std::string::npos);
    return verdict.refusal;
}

TEST(CertificateFile, WhatIsReadIsWhatWasWritten) {
    const TemporaryFolder folder;
    const std::filesystem::path file = folder.path() / "proof";
    for (const Quantity quantity : {Quantity::directed, Quantity::symmetric}) {
        CertificateFile c = proof_of(quantity);
        c.certificates[0].bytes = std::string("\0\n\xff{", 4);
        c.certificates[0].proven = std::nextafter(1.0 / 3, 1);
        c.bounds.upper = std::numeric_limits<double>::infinity();
        c.witness.target_point[1] = std::nan("");
        write_certificate(file, c);
        const CertificateFile read = read_certificate(file);
        EXPECT_EQ(read.target.file, c.target.file);
        EXPECT_EQ(read.target.sha256, c.target.sha256);
        EXPECT_EQ(read.target.pose.rotation, c.target.pose.rotation);
        EXPECT_EQ(read.target.pose.translation, c.target.pose.translation);
        EXPECT_EQ(read.source.file, c.source.file);
        EXPECT_EQ(read.quantity, quantity);
        EXPECT_EQ(read.solver, c.solver);
        EXPECT_EQ(read.bounds.lower, 1);
        EXPECT_EQ(read.bounds.upper, c.bounds.upper);
        EXPECT_EQ(read.witness.source_point, c.witness.source_point);
        EXPECT_FALSE(read.witness.target_point.allFinite());
        ASSERT_EQ(read.certificates.size(), c.certificates.size());
        for (std::size_t i = 0; i < c.certificates.size(); ++i) {
            EXPECT_EQ(read.certificates[i].bytes, c.certificates[i].bytes);
            EXPECT_EQ(read.certificates[i].direction, c.certificates[i].direction);
            EXPECT_EQ(read.certificates[i].format, c.certificates[i].format);
            EXPECT_EQ(read.certificates[i].proven, c.certificates[i].proven);
        }
        std::ofstream(file, std::ios::app) << "x";
        EXPECT_THROW(read_certificate(file), InputError);
        write_certificate(file, c);
        std::filesystem::resize_file(file, std::filesystem::file_size(file) - 1);
        EXPECT_THROW(read_certificate(file), InputError);
    }
}

std::string bytes_of(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

// Returns the error of reading a file with these bytes; an empty string if it is valid.
std::string problem_of(const std::filesystem::path& file, const std::string& bytes) {
    std::ofstream(file, std::ios::binary).write(bytes.data(), std::ptrdiff_t(bytes.size())).flush();
    try {
        (void)read_certificate(file);
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

// The hash in the last line is right, but the content has a byte too many or too few.
TEST(CertificateFile, AWholeFileWithAnotherNumberOfBytes) {
    const TemporaryFolder folder;
    const std::filesystem::path file = folder.path() / "proof";
    write_certificate(file, proof_of(Quantity::directed));
    const std::string good = bytes_of(file), content = good.substr(0, good.size() - seal_bytes);
    EXPECT_EQ(sealed(content), good);
    EXPECT_NE(problem_of(file, sealed(content + "x")).find("it goes on after its last certificate"), std::string::npos);
    EXPECT_NE(problem_of(file, sealed(content.substr(0, content.size() - 1))).find("it ends too early"),
              std::string::npos);
}

// Edits the first line and updates the hash in the last line, so that only the new value can be refused.
TEST(CertificateFile, WhatAKeyMayHold) {
    const TemporaryFolder folder;
    const std::filesystem::path file = folder.path() / "proof";
    write_certificate(file, proof_of(Quantity::directed));
    const std::string good = bytes_of(file), content = good.substr(0, good.size() - seal_bytes);
    const auto after = [&](const std::string& text, const std::string& other) {
        std::string changed = content;
        const std::size_t at = changed.find(text);
        EXPECT_NE(at, std::string::npos) << text;
        changed.replace(at, text.size(), other);
        return problem_of(file, sealed(changed));
    };
    EXPECT_EQ(after("\"tolerance\":0.001", "\"tolerance\":1"), "");
    const char* refused[][2] = {{"\"bytes\":1", "\"bytes\":1.0"},
                                {"\"bytes\":1", "\"bytes\":1e300"},
                                {"\"bytes\":1", "\"bytes\":-1"},
                                {"\"bytes\":1", "\"bytes\":9223372036854775808"},
                                {"_certificate\":2", "_certificate\":2.0"},
                                {"source_element\":0", "source_element\":1e300"},
                                {"target_element\":0", "target_element\":0.5"},
                                {"source_element\":0", "source_element\":-2"},
                                {"source_element\":0", "source_element\":4294967296"},
                                {"\"tolerance\":0.001", "\"tolerance\":\"nan\""},
                                {"\"tolerance\":0.001", "\"tolerance\":null"},
                                {"\"upper\":", "\"upper\":7,\"upper\":"},
                                {"\"pose\":[", "\"pose\":[0,"},
                                {"\"source_point\":[", "\"source_point\":[0,"}};
    for (const auto& [text, other] : refused) EXPECT_NE(after(text, other), "") << other;
    const std::string said = after("\"solver\":\"a", "\"solver\":\"\x1b[31m\xff");
    EXPECT_NE(said, "");
    EXPECT_EQ(said.find_first_of("\x1b\xff\n"), std::string::npos) << said;
}

TEST(CertificateFile, APoseTurnsAndMovesAndIsSaid) {
    CertificateFile c = proof_of(Quantity::directed);
    EXPECT_NE(describe(c, {}).find("\npose of B  [1.0,0.0,0.0,0.0,1.0,"), std::string::npos) << describe(c, {});
    EXPECT_EQ(describe(c, {}).find("\npose of A"), std::string::npos);
    for (CertificateFile::Model* model : {&c.source, &c.target}) {
        const Pose kept = model->pose;
        model->pose.rotation(0, 0) = 1 + 0.4e-9;
        EXPECT_EQ(refusal(c).find("no rotation"), std::string::npos);
        for (const double entry : {1 + 0.6e-9, 0.0, std::nan("")}) {
            model->pose.rotation(0, 0) = entry;
            EXPECT_NE(refusal(c).find("is not a rotation"), std::string::npos) << entry;
        }
        model->pose = kept;
    }
}

// A translation by 1e17 rounds both triangles to one point each, so that any bound would hold of them.
TEST(CertificateFile, APoseThatFlattensAShapeProvesNothing) {
    for (const double far : {1e3, 1e8, 1e10, 1e12, 1e17, 1e300}) {
        CertificateFile c = proof_of(Quantity::directed);
        c.source.pose.translation.setConstant(far);
        c.target.pose.translation = Vec3(far, far, far + 1);
        c.bounds.lower = 0;
        c.certificates[0].proven = c.bounds.upper = 2;
        const bool displaced = refusal(c).find("rounding displaces its points") != std::string::npos;
        EXPECT_EQ(displaced, far > 1e9) << far << ": " << refusal(c);
        EXPECT_EQ(refusal(c).empty(), !displaced) << far << ": " << refusal(c);
    }
}

// A is flattened onto a point of B, which is as large as the translation.
TEST(CertificateFile, APoseThatFlattensAShapeOntoALargeOneProvesNothing) {
    for (const double far : {1e3, 1e17, 1e300}) {
        const Shape large = soup(rows({{0, 0, 0}, {1, 0, 0}, {far, 0, 0}}));
        CertificateFile c = proof_of(Quantity::directed);
        c.source.pose.translation = Vec3(far, 0, 0);
        c.target = {"b.off", content_hash(large), {}};
        c.bounds = {0, 3};
        c.certificates[0].proven = 3;
        EXPECT_EQ(refusal(c, flat, large).find("rounding displaces its points") != std::string::npos, far > 1e9)
            << refusal(c, flat, large);
        EXPECT_EQ(refusal(c, flat, large).empty(), far < 1e9) << refusal(c, flat, large);
    }
}

// Coordinates so large that the diagonal of both shapes is not a double.
TEST(CertificateFile, ShapesOfAnySizeNeedAProofOfTheirBound) {
    const Shape large = soup(rows({{-1.7e308, 0, 0}, {1.7e308, 0, 0}, {0, 1.7e308, 0}}));
    CertificateFile c = proof_of(Quantity::directed);
    c.source = {"a.off", content_hash(large), {}};
    c.target = {"b.off", content_hash(large), {}};
    c.certificates[0].proven = 1.7e308;
    c.bounds = {0, 1.6e308};
    state_what_is_proven(c, large, large);
    EXPECT_EQ(c.bounds.upper, 1.6e308);
    EXPECT_NE(refusal(c, large, large), "");
}

TEST(CertificateFile, NoTextOfAFileMovesTheCursor) {
    CertificateFile c = proof_of(Quantity::directed);
    c.solver =
        "kang\naccepted   \x1b[8m\xc2\x9b"
        "8m\xff";
    const std::string text = describe(c, {});
    EXPECT_EQ(text.find("\naccepted"), std::string::npos);
    EXPECT_EQ(text.find_first_of("\x1b\xff\x9b"), std::string::npos);
    EXPECT_NE(text.find("of kang accepted"), std::string::npos) << text;
}

TEST(CertificateFile, AWitnessNamesAnElementThatIsThere) {
    for (Index Witness::*element : {&Witness::source_element, &Witness::target_element}) {
        CertificateFile c = proof_of(Quantity::directed);
        for (const Index named : {-1, 0, 1}) {
            c.witness.*element = named;
            EXPECT_EQ(refusal(c) == "", named < 1) << refusal(c);
        }
    }
}

// Flips a bit in each byte of a small file and in some of a large one; also cuts off ends and inserts bytes.
TEST(CertificateFile, NoChangedByteIsRead) {
    const TemporaryFolder folder;
    const std::filesystem::path file = folder.path() / "proof";
    CertificateFile large = proof_of(Quantity::symmetric);
    for (int i = 0; i < 300'000; ++i) large.certificates[0].bytes += char(i % 251);
    for (const CertificateFile& c : {proof_of(Quantity::directed), large}) {
        write_certificate(file, c);
        const std::string good = bytes_of(file);
        ASSERT_EQ(problem_of(file, good), "");
        const std::size_t step = good.size() < 5000 ? 1 : 4999, seal = good.size() - seal_bytes;
        for (std::size_t at = 0; at < good.size(); at += step) {
            std::string bad = good;
            bad[at] = char(bad[at] ^ (1 << at / step % 8));
            const std::string problem = problem_of(file, bad);
            ASSERT_NE(problem, "") << at;
            if (at >= seal) continue;
            ASSERT_NE(problem.find("damaged: its SHA-256 does not match"), std::string::npos) << problem;
        }
        for (std::size_t size = 0; size < good.size(); size += 9 * step)
            ASSERT_NE(problem_of(file, good.substr(0, size)), "");
        ASSERT_NE(problem_of(file, good + '\n'), "");
        ASSERT_NE(problem_of(file, good.substr(0, seal) + 'x' + good.substr(seal)), "");
        std::string capitals = good;  // the same hash in capital letters
        for (std::size_t i = seal + 8; i < good.size(); ++i) capitals[i] = char(std::toupper(capitals[i]));
        ASSERT_NE(problem_of(file, capitals), "");
    }
}

TEST(CertificateFile, AnAnswerIsAcceptedAsAWhole) {
    for (const Quantity quantity : {Quantity::directed, Quantity::symmetric}) {
        const CertificateFile good = proof_of(quantity);
        EXPECT_EQ(refusal(good), "");
        const CertificateVerdict verdict = verify_certificate(good, flat, flat);
        EXPECT_EQ(verdict.proven, 1 + 1e-12);
        EXPECT_EQ(verdict.lower, "holds, by its witness");
        for (std::size_t i = 0; i < good.certificates.size(); ++i) {
            CertificateFile bad = good;
            bad.certificates[i].proven = 0.9;
            EXPECT_NE(refusal(bad), "");
            bad = good;
            bad.certificates[i].bytes.clear();
            EXPECT_NE(refusal(bad), "");
            bad = good;
            bad.certificates.erase(bad.certificates.begin() + std::ptrdiff_t(i));
            EXPECT_NE(refusal(bad), "");
            bad = good;
            bad.certificates.push_back(good.certificates[i]);
            EXPECT_NE(refusal(bad), "");
        }
        CertificateFile bad = good;
        bad.bounds.upper = 0.9;  // lower than the proven bound
        EXPECT_NE(refusal(bad), "");
        bad = good;
        bad.bounds.upper = std::nan("");
        EXPECT_NE(refusal(bad), "");
        for (const double lower : {1.1, -1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
            bad = good;
            bad.bounds.lower = lower;
            bad.bounds.upper = std::max(1.0, lower);
            EXPECT_NE(refusal(bad), "") << lower;
        }
        bad = good;
        bad.witness.direction = Direction::target_to_source;
        EXPECT_EQ(refusal(bad) == "", quantity == Quantity::symmetric);
        bad = good;
        bad.witness.source_point = bad.witness.target_point = Vec3::Constant(std::nan(""));
        EXPECT_NE(refusal(bad).find("it has no witness"), std::string::npos) << refusal(bad);
        bad.bounds.lower = 0;
        EXPECT_EQ(refusal(bad), "");
        bad = good;
        bad.bounds.upper = 1;  // the proof shows slightly more
        EXPECT_NE(refusal(bad).find("which is above the upper bound"), std::string::npos) << refusal(bad);
        state_what_is_proven(bad, flat, flat);
        EXPECT_EQ(bad.bounds.upper, 1 + 1e-12);
        EXPECT_EQ(refusal(bad), "");
        bad.bounds.upper = 0.9;
        state_what_is_proven(bad, flat, flat);
        EXPECT_EQ(bad.bounds.upper, 0.9);
        Shape other = flat;
        points_of(other)(0, 0) = 1e-300;
        EXPECT_THROW((void)refusal(good, other, flat), InputError);
        EXPECT_THROW((void)refusal(good, flat, other), InputError);
        bad = good;
        bad.target.pose = {};  // then the distance is 0, and the lower bound is wrong
        EXPECT_NE(refusal(bad), "");
    }
}

}  // namespace
}  // namespace hausbench
