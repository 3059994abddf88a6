// A certificate file contains an answer and its proof. `measure --certificate` writes it, `verify --certificate` checks
// it. The file has one line of JSON (docs/certificate.md lists the keys), the bytes of the certificates, and a last
// line with the SHA-256 of everything before it.
#pragma once

#include "algorithms/prepared.h"
#include "algorithms/solver.h"
#include "harness/check/certificate_check.h"

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace hausbench {

struct CertificateFile {
    struct Model {
        std::string file;    // as named for `measure`
        std::string sha256;  // content_hash() of the shape as loaded
        Pose pose;
    };
    Model source, target;
    Quantity quantity = Quantity::directed;
    std::string solver;
    double tolerance = 0;
    std::string tolerance_of;  // the unit, such as "diagonal"
    Bounds bounds;
    Witness witness;
    std::vector<Certificate> certificates;

    bool at_rest() const { return source.pose.is_identity() && target.pose.is_identity(); }
};

// Returns the shape with its coordinates as loaded. Solvers work on scaled coordinates, certificate files on the
// original ones.
Shape as_loaded(const PreparedShape& prepared);

// Writes the whole file, or throws InputError and writes nothing.
void write_certificate(const std::filesystem::path& file, const CertificateFile& content);

// Reads a certificate file. Throws InputError if the file cannot be read, is not a certificate file, or is damaged. Any
// changed byte is detected.
CertificateFile read_certificate(const std::filesystem::path& file);

// Returns whether a certificate proves the bound `upper` but for rounding: its own bound, `proven`, may be larger by up to
// 1e-12 * extent. `extent` is the diagonal of the box around both shapes in their poses.
bool proves_the_bound(double proven, double upper, double extent);

// Raises the upper bound of an answer to the bound that its certificates prove, if they prove it but for rounding. Call it
// before write_certificate(), because verify_certificate() accepts only what is proven.
void state_what_is_proven(CertificateFile& content, const Shape& source, const Shape& target);

// Puts an answer with certificates into a file that names the rest: the shapes, their poses, the quantity, the solver and
// the tolerance. Adds the hashes of the shapes, and states what is proven.
void take_answer(CertificateFile& content, Result answer, const Shape& source, const Shape& target);

struct CertificateVerdict {
    bool accepted = false;
    double proven = 0;                     // upper bound on h(A,B) or H(A,B)
    std::vector<CertificateCheck> checks;  // one for each certificate
    // The result for the lower bound: "holds, ...", or why it is refused.
    std::string lower;
    std::string refusal;  // the reason in one line; empty if accepted
};

// Checks every certificate, that they prove the upper bound of the answer, and that the witness proves its lower bound.
// What it accepts is about the shapes at the poses of the file, which are rotations and translations and do not displace
// the points of a shape by rounding by more than 1e-6 of its diagonal or of the bound, whichever is larger.
// Throws InputError if a shape is not the one for which the file was written.
CertificateVerdict verify_certificate(const CertificateFile& content, const Shape& source, const Shape& target,
                                      const std::function<void()>& looking = {});

std::string describe(const CertificateFile& content, const CertificateVerdict& verdict);

}  // namespace hausbench
