// Certificate files, each with an answer and its proof: `measure --certificate` writes one, `verify --certificate`
// checks it. A file has one line of JSON, then the bytes of the certificates one after the other, and a last line
// with the SHA-256 of everything before it; docs/certificate.md lists the keys.
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
        std::string file;    // as given
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

// Returns the shape as loaded, before scaling: certificate files refer to these coordinates.
Shape as_loaded(const PreparedShape& prepared);

// Writes the whole file or nothing. Throws InputError if it cannot be written.
void write_certificate(const std::filesystem::path& file, const CertificateFile& content);

// Reads a certificate file. Throws InputError (one line) if the file cannot be read, is not a certificate file, or is
// damaged: any changed byte is detected.
CertificateFile read_certificate(const std::filesystem::path& file);

// Returns whether `proven` exceeds `upper` by at most 1e-12 of `extent`, the diagonal of the box around both shapes in
// their poses.
bool proves_the_bound(double proven, double upper, double extent);

struct CertificateVerdict {
    bool accepted = false;
    double proven = 0;                     // upper bound on the quantity
    std::vector<CertificateCheck> checks;  // one for each certificate
    // Verdict on the lower bound: "holds", "not checked: ...", or why it does not hold.
    std::string lower;
    std::string refusal;  // one line; empty: accepted
};

// Checks each certificate, proves_the_bound() for the upper bound of the answer, and the lower bound by its
// witness. Throws InputError if the shapes are not the shapes that the file was written for.
CertificateVerdict verify_certificate(const CertificateFile& content, const Shape& source, const Shape& target);

// Returns a report for people; ends in a newline.
std::string describe(const CertificateFile& content, const CertificateVerdict& verdict);

}  // namespace hausbench
