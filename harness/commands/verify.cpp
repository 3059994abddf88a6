// `hausbench verify`: checks the rows of a result, or a certificate, independently of the solvers.
#include "harness/commands/verify_result.h"

#include "algorithms/error.h"
#include "harness/check/certificate_file.h"
#include "harness/commands/named_shape.h"
#include "harness/commands/verb.h"
#include "process/progress_line.h"

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
    ProgressLine progress;
    const CertificateVerdict verdict =
        verify_certificate(content, source.shape, target.shape, [&] { progress.draw("checking the proof"); });
    print(describe(content, verdict));
    return verdict.accepted ? 0 : 1;
}

}  // namespace

void add_verify(CLI::App& app, int& code) {
    static std::vector<std::filesystem::path> files;
    static bool certificate = false;
    auto* verb =
        add_verb(app, "verify", "checks a result or a certificate, independently of the solvers",
                 "hausbench verify results/guthe2005_table1.h5",
                 "Exit code 1: a row is unsound, a model is missing, or the certificate is refused. Rows of algebraic "
                 "surfaces are checked with the interval bounds of polynomials that their solvers use, too.");
    verb->add_option("files", files, "a result (.h5), or a certificate, with A and B if they were moved")
        ->type_name("FILE")
        ->required();
    verb->add_flag("--certificate", certificate, "the file is a certificate of `measure --certificate`");
    verb->callback([&code] { code = certificate ? verify_proof(files) : verify_rows_of(files); });
}

}  // namespace hausbench
