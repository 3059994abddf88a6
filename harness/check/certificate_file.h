// An answer and its proof in a file of its own: `measure --certificate` writes it, `verify --certificate` checks it. One line of JSON, then
// the bytes of the certificates one after the other, and a last line with the SHA-256 of all before it; docs/certificate.md lists the keys.
#pragma once

#include "algorithms/prepared.h"
#include "algorithms/solver.h"
#include "harness/check/certificate_check.h"

#include <filesystem>
#include <string>
#include <vector>

namespace hausbench {

struct CertificateFile {
    struct Model {
        std::string file;    // as it was given
        std::string sha256;  // of the shape as loaded: content_hash()
        Pose pose;
    };
    Model source, target;
    Quantity quantity = Quantity::directed;
    std::string solver;
    double tolerance = 0;
    std::string tolerance_of;  // as in `measure`
    Bounds bounds;
    Witness witness;
    std::vector<Certificate> certificates;
};

// Returns the shape as it was loaded, before it was scaled: certificate files are about that.
Shape as_loaded(const PreparedShape& prepared);

// Whole or not at all. Throws InputError where it cannot be written.
void write_certificate(const std::filesystem::path& file, const CertificateFile& content);

// Throws InputError, one line, if the file cannot be read, is not a certificate file, or has any changed byte.
CertificateFile read_certificate(const std::filesystem::path& file);

// Whether the proven bound is above the upper bound by at most 1e-12 of `extent`, the diagonal of the box of both
// shapes in their poses.
bool proves_the_bound(double proven, double upper, double extent);

struct CertificateVerdict {
    bool accepted = false;
    double proven = 0;                     // of the quantity
    std::vector<CertificateCheck> checks;  // of each certificate
    // Verdict on the lower bound: "holds", "not checked: ...", or why it does not hold.
    std::string lower;
    std::string refusal;  // one line; empty: accepted
};

// Checks each certificate; that the bound it proves is above the upper bound of the answer by at most 1e-12 of the
// diagonal of the box of both shapes in their poses; and the lower bound by its witness. Throws InputError if the
// shapes differ from the file's.
CertificateVerdict verify_certificate(const CertificateFile& content, const Shape& source, const Shape& target);

// For a person; ends in a newline.
std::string describe(const CertificateFile& content, const CertificateVerdict& verdict);

}  // namespace hausbench
