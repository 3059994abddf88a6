// `hausbench verify`: checks the rows of a result, or a certificate, independently of the solvers.
#include "harness/commands/verify_result.h"

#include "algorithms/error.h"
#include "harness/check/certificate_file.h"
#include "harness/commands/named_shape.h"
#include "harness/commands/verb.h"

#include <fmt/format.h>

#include <fstream>
#include <string_view>

namespace hausbench {

namespace {

int verify_rows_of(const std::vector<std::filesystem::path>& files) {
    if (files.size() != 1) throw InputError("verify: takes one result file; a proof is checked with --certificate");
    constexpr std::string_view proof = "{\"certificates\"";
    std::string head(proof.size(), ' ');
    if (std::filesystem::is_regular_file(files.front()) &&
        std::ifstream(files.front()).read(head.data(), std::streamsize(head.size())) && head == proof)
        throw InputError(fmt::format("{}: is a certificate: add --certificate", files.front().string()));
    ResultFile result = read_result(files.front());
    const auto missing = verify_result(result, catalogue());
    print(describe_checks(result));
    say(missing);
    return any_unsound(result) || !missing.empty() ? 1 : 0;
}

int verify_proof(const std::vector<std::filesystem::path>& files) {
    if (files.size() != 1 && files.size() != 3)
        throw InputError("verify --certificate: name the certificate alone, or the certificate, A and B");
    CertificateFile content = read_certificate(files.front());
    if (files.size() == 3) {
        content.source.file = files[1].string();
        content.target.file = files[2].string();
    }
    for (const std::string& file : {content.source.file, content.target.file}) {
        if (!names_a_file(file) && !std::filesystem::exists(file)) continue;  // a model of the project
        if (!std::filesystem::exists(file))
            throw InputError(fmt::format("{}: its model {} is not there: name A and B after the certificate",
                                         files.front().string(), file));
        if (!std::filesystem::is_regular_file(file))
            throw InputError(fmt::format("{}: its model {} is not a regular file: name A and B after the certificate",
                                         files.front().string(), file));
    }
    const LoadedShape source = load_named(content.source.file);
    const LoadedShape target = load_named(content.target.file);
    const CertificateVerdict verdict = verify_certificate(content, source.shape, target.shape);
    print(describe(content, verdict));
    return verdict.accepted ? 0 : 1;
}

}  // namespace

void add_verify(CLI::App& app, int& code) {
    static std::vector<std::filesystem::path> files;
    static bool certificate = false;
    auto* verb = app.add_subcommand(
        "verify",
        "check every row of a result independently of the solvers (surfaces: with the same interval bounds of "
        "polynomials); exit code 1 if a row is unsound or its model is unavailable. Or, with --certificate, check the "
        "proof that `measure --certificate` wrote: exit code 0 if it is accepted, 1 if it is refused");
    verb->add_option("files", files, "a result (.h5); or a certificate, and A and B if they are not where they were")
        ->required();
    verb->add_flag("--certificate", certificate, "the file is a certificate");
    verb->callback([&code] { code = certificate ? verify_proof(files) : verify_rows_of(files); });
}

}  // namespace hausbench
