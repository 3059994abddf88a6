// Certificates of the C interface.
#include "library/errors.h"
#include "library/question.h"

#ifdef HAUSBENCH_HAS_CHECKER
#include "harness/check/certificate_file.h"
#include "process/whole_file.h"

#include <fmt/format.h>

#include <filesystem>
#include <string>
#include <tuple>
#include <utility>

namespace hausbench::library {
namespace {

// Solves, checks the proof with the checker, and writes it. Throws if there is none, or if the checker refuses it.
Answer certify(Question& question, Quantity quantity, const std::filesystem::path& file) {
    const Pair& pair = question.pair();
    if (!pair.entry().info.can(Ability::certificates))
        throw ArgumentError(1, fmt::format("pair: solver '{}' writes no certificates: prepare the pair with `cover`",
                                           pair.entry().info.name));
    check_place_to_write(file);
    question.query.wanted.certificate = true;
    const Answer answer = question.solve(quantity);
    const Result& result = answer.result;
    if (result.certificates.empty())
        throw InputError(
            fmt::format("{}: is not written: {}", file.string(),
                        result.why_no_certificate.empty() ? "the solver did not say why" : result.why_no_certificate));
    CertificateFile content;
    content.source = {pair.source().name(), "", question.query.source_pose};
    content.target = {pair.target().name(), "", question.query.target_pose};
    content.quantity = quantity;
    content.solver = pair.entry().info.name;
    content.tolerance = question.caller_query().tolerance;
    content.tolerance_of = question.tolerance.of;
    take_answer(content, result, pair.source().shape(), pair.target().shape());
    const CertificateVerdict verdict = verify_certificate(content, pair.source().shape(), pair.target().shape());
    if (!verdict.accepted)
        throw InputError(
            fmt::format("{}: is not written: its check refuses the proof: {}", file.string(), verdict.refusal));
    write_certificate(file, content);
    return answer;
}

void put(const Pose& pose, double* matrix) {
    for (int k = 0; k < 4; ++k)
        for (int j = 0; j < 4; ++j)
            matrix[4 * k + j] = k == 3 ? double(j == 3) : j == 3 ? pose.translation[k] : pose.rotation(k, j);
}

bool are_equal(const Pose& a, const Pose& b) { return a.rotation == b.rotation && a.translation == b.translation; }

// Checks a file for the question whether it proves a bound of A and B at these poses.
hausbench_verdict verdict_of(const CertificateFile& content, const Shape& a, const Shape& b, const Pose& source_pose,
                             const Pose& target_pose) {
    const CertificateVerdict proof = verify_certificate(content, a, b);
    std::string refusal = proof.refusal;
    for (const auto& [name, stated, expected] :
         {std::tuple{"A", &content.source.pose, &source_pose}, std::tuple{"B", &content.target.pose, &target_pose}})
        if (refusal.empty() && !are_equal(*stated, *expected))
            refusal = fmt::format("the file is about {} {}: give the pose that it was certified at", name,
                                  stated->is_identity() ? "at rest" : "at another pose");
    hausbench_verdict verdict = HAUSBENCH_VERDICT_INIT;
    verdict.accepted = refusal.empty() ? 1 : 0;
    if (content.bounds.lower <= content.bounds.upper) verdict.bounds = {content.bounds.lower, content.bounds.upper};
    if (verdict.accepted) verdict.proven = proof.proven;
    put(content.source.pose, verdict.source_pose);
    put(content.target.pose, verdict.target_pose);
    copy_text(verdict.text, sizeof verdict.text,
              one_line(verdict.accepted ? "the upper bound is proven; the lower bound " + proof.lower : refusal));
    return verdict;
}

}  // namespace
}  // namespace hausbench::library
#endif

using namespace hausbench::library;

namespace {

#ifndef HAUSBENCH_HAS_CHECKER
constexpr const char* no_checker = "this library is built without its checker: build it with HAUSBENCH_WITH_CHECKER=ON";
#endif

}  // namespace

extern "C" {

int hausbench_certify(hausbench_pair* pair, int32_t symmetric, const hausbench_query* query, const char* path,
                      hausbench_answer* answer, hausbench_error* error) {
    return guarded(error, [&] {
        given(path, "path", 4);
        expect_size(*given(answer, "answer", 5), "answer", 5);
        expect_flag(symmetric, "symmetric", 2);
        Question question(pair, query, 3);
#ifdef HAUSBENCH_HAS_CHECKER
        question.answer(
            certify(question, symmetric == 1 ? hausbench::Quantity::symmetric : hausbench::Quantity::directed, path),
            *answer);
#else
        throw hausbench::InputError(no_checker);
#endif
    });
}

int hausbench_verify_posed(const char* path, const hausbench_shape* source, const hausbench_shape* target,
                           const double* source_pose, const double* target_pose, hausbench_verdict* verdict,
                           hausbench_error* error) {
    return guarded(error, [&] {
        given(path, "path", 1);
        const auto a = model_of(source, "source", 2), b = model_of(target, "target", 3);
        const hausbench::Pose at = pose_of(source_pose, "source_pose", 4), to = pose_of(target_pose, "target_pose", 5);
        expect_size(*given(verdict, "verdict", 6), "verdict", 6);
#ifdef HAUSBENCH_HAS_CHECKER
        give(*verdict, verdict_of(hausbench::read_certificate(path), a->shape(), b->shape(), at, to));
#else
        throw hausbench::InputError(no_checker);
#endif
    });
}

int hausbench_verify(const char* path, const hausbench_shape* source, const hausbench_shape* target,
                     hausbench_verdict* verdict, hausbench_error* error) {
    return hausbench_verify_posed(path, source, target, nullptr, nullptr, verdict, error);
}

}  // extern "C"
