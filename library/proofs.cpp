// Certificates of the C interface.
#include "library/errors.h"
#include "library/question.h"

#ifdef HAUSBENCH_HAS_CHECKER
#include "datasets/hash.h"
#include "harness/check/certificate_file.h"
#include "process/whole_file.h"

#include <fmt/format.h>

#include <filesystem>
#include <utility>

namespace hausbench::library {
namespace {

CertificateFile content_of(const Question& question, Result result, bool symmetric) {
    const Pair& pair = question.pair();
    const auto model = [](const Model& one, const Pose& pose) {
        return CertificateFile::Model{one.name(), content_hash(one.shape()), pose};
    };
    return {model(pair.source(), question.query.source_pose),
            model(pair.target(), question.query.target_pose),
            symmetric ? Quantity::symmetric : Quantity::directed,
            pair.entry().info.name,
            question.asked().tolerance,
            question.tolerance.of,
            result.bounds,
            result.witness,
            std::move(result.certificates)};
}

// Solves, checks the proof with the checker, and writes it. Throws if there is none, or if the checker refuses it.
Result certify(Question& question, bool symmetric, const std::filesystem::path& file) {
    const Pair& pair = question.pair();
    if (!pair.entry().info.can(Ability::certificates))
        throw ArgumentError(1, fmt::format("pair: solver '{}' writes no certificates: prepare the pair with `cover`",
                                           pair.entry().info.name));
    check_place_to_write(file);
    question.query.wanted.certificate = true;
    const Result result = symmetric ? question.solve_symmetric() : question.solve();
    if (result.certificates.empty())
        throw InputError(
            fmt::format("{}: is not written: {}", file.string(),
                        result.why_no_certificate.empty() ? "the solver did not say why" : result.why_no_certificate));
    const CertificateFile content = content_of(question, result, symmetric);
    const CertificateVerdict verdict = verify_certificate(content, pair.source().shape(), pair.target().shape());
    if (!verdict.accepted)
        throw InputError(
            fmt::format("{}: is not written: its check refuses the proof: {}", file.string(), verdict.refusal));
    write_certificate(file, content);
    return result;
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
        question.answer(certify(question, symmetric == 1, path), *answer);
#else
        throw hausbench::InputError(no_checker);
#endif
    });
}

int hausbench_verify(const char* path, const hausbench_shape* source, const hausbench_shape* target,
                     hausbench_verdict* verdict, hausbench_error* error) {
    return guarded(error, [&] {
        given(path, "path", 1);
        const auto a = model_of(source, "source", 2), b = model_of(target, "target", 3);
        expect_size(*given(verdict, "verdict", 4), "verdict", 4);
#ifdef HAUSBENCH_HAS_CHECKER
        const hausbench::CertificateFile content = hausbench::read_certificate(path);
        const hausbench::CertificateVerdict found = hausbench::verify_certificate(content, a->shape(), b->shape());
        hausbench_verdict ours = HAUSBENCH_VERDICT_INIT;
        ours.accepted = found.accepted ? 1 : 0;
        const hausbench::Bounds& stated = content.bounds;
        if (stated.lower <= stated.upper) ours.bounds = {stated.lower, stated.upper};
        if (found.accepted) ours.proven = found.proven;
        const std::string text =
            found.accepted ? "the upper bound is proven; the lower bound " + found.lower : found.refusal;
        copy_text(ours.text, sizeof ours.text, hausbench::one_line(text));
        give(*verdict, ours);
#else
        throw hausbench::InputError(no_checker);
#endif
    });
}

}  // extern "C"
