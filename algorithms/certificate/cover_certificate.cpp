#include "algorithms/certificate/cover_certificate.h"

#include <algorithm>
#include <bit>
#include <cstdint>

namespace hausbench {
namespace {

// The kind of a node, which is stored in the two lowest bits of its first number.
enum Node : std::uint64_t { cut_node, one_leaf, centre_leaf, vertex_leaf };

}  // namespace

// Writes an integer with seven bits per byte, the lowest bits first. The highest bit of a byte is 1 if another byte
// follows.
void CertificateTree::number(std::uint64_t value) {
    for (; value >= 0x80; value >>= 7) bytes_.push_back(static_cast<char>(value | 0x80));
    bytes_.push_back(static_cast<char>(value));
}

// Writes the fraction t of a point on an edge as eight bytes, the lowest first on every machine. Writes nothing for a
// corner.
void CertificateTree::parameter(const CutPoint& point) {
    if (point.t < 0) return;
    const auto bits = std::bit_cast<std::uint64_t>(point.t);
    for (int shift = 0; shift < 64; shift += 8) bytes_.push_back(static_cast<char>(bits >> shift));
}

void CertificateTree::cut(const CutPoint& p, const CutPoint& q) {
    const auto point = [](const CutPoint& at) {
        return std::uint64_t{at.t < 0} | std::uint64_t{at.backward} << 1 | std::uint64_t{at.place} << 2;
    };
    number(cut_node | point(p) << 2 | point(q) << 10);
    parameter(p);
    parameter(q);
}

void CertificateTree::one(Index k) { number(one_leaf | static_cast<std::uint64_t>(k) << 2); }

void CertificateTree::centre(Index k) { number(centre_leaf | static_cast<std::uint64_t>(k) << 2); }

void CertificateTree::vertex(Index v, Index k) {
    number(vertex_leaf | static_cast<std::uint64_t>(k) << 2);
    number(static_cast<std::uint64_t>(v));
}

std::optional<Certificate> CertificateBuilder::finish(double proven) const {
    std::size_t size = 0;
    for (const std::string& tree : trees_) {
        if (tree.empty()) return std::nullopt;
        size += tree.size();
    }
    Certificate certificate{std::string(cover_certificate_format), Witness::Direction::source_to_target, proven, {}};
    certificate.bytes.reserve(size);
    for (const std::string& tree : trees_) certificate.bytes += tree;
    return certificate;
}

}  // namespace hausbench
